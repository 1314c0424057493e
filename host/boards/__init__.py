"""What several tools need to know of a board.

build      firmware/ -> the files of the board
places     where the laptop keeps a board's key and the copies of its robot.json
usb        serial ports that look like a board's
errors     the error of this folder and of host/flash
"""
