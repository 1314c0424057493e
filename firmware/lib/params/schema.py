"""Every parameter of the robot, once: checking of robot.json, live tuning and the reference page all read this table.

A row is a JSON list: key, kind, default, low, high, unit, meaning. Rows of BOOT count from the next start, rows of LIVE at once unless they say
otherwise; the latter are whole numbers, computed with as they stand in the file. (Text, because on the board the words of a text are gone with
it, while those of Python's own lists stay in the table of names for ever.)

kind        value in robot.json
int         whole number (or any number, where a row of BOOT has one of the units of SCALES), low .. high
number      any number, low .. high
flag        true or false
choice      one of the texts in `low`
text        text of at most `high` characters
pin         GPIO number, or null for none; low .. high, but never a pin of USB_PINS or FLASH_PINS
address     I2C address, as a number or as a text like "0x40"
spacings    list of whole numbers, one fewer than there are axles; it says how many axles the robot has
wheels      list, one value for each wheel: axle 1 left, axle 1 right, axle 2 left, ...; a single value serves all
signs       likewise, each 1 or -1
pairs       list, one value for each axle
sectors     list of up to 8 pairs of whole numbers, low .. high

A default of null: for a pin none, for axles.first half the sum of the spacings, for channels 0, 1, 2, ... (wheels) or 0, 2, 4, ... (pairs),
for the planning window and the margins a share of the body's length (parse.py).
The attribute of `Config` is the key with a dot turned into an underscore: lidar.baud is config.lidar_baud.
"""

import json

# Unit of a row of BOOT -> (factor to the integer the firmware computes with, what is added to the name of the attribute)
SCALES = {
    "deg": (10, ""),  # 0.1 deg
    "r/s": (20, "20"),  # 1/20 r/s
    "times": (1000, "1000"),  # 1/1000
}

MAX_AXLES = 8  # two wheels on each, sixteen channels on a chip
USB_PINS = (1, 3)
FLASH_PINS = (6, 7, 8, 9, 10, 11)


def rows(*tables):
    """The rows of BOOT or LIVE or both, one after the other: lists of seven."""
    for table in tables:
        start = 1  # the first line is empty
        while start < len(table):
            end = table.index("\n", start)
            yield json.loads(table[start:end])  # not all lines at once: the heap is to stay small
            start = end + 1


BOOT = """
["mode", "choice", "AWS", ["AWS", "NAWS"], null, "", "AWS: all axles steer; NAWS: the last axle stays straight"]
["robot.length", "int", 600, 100, 3000, "mm", "length of the body"]
["robot.width", "int", 250, 50, 2000, "mm", "width of the body, wheels included"]
["axles.spacings", "spacings", [115, 150, 117, 115], 20, 1000, "mm", "from each axle to the next, front to rear"]
["axles.track", "int", 230, 20, 2000, "mm", "from the left to the right wheels"]
["axles.first", "number", null, 0, 1500, "mm", "how far the first axle lies ahead of the body's centre"]
["lidar.uart", "int", 2, 1, 2, "", "UART of the lidar"]
["lidar.rx", "pin", 16, 0, 39, "", "lidar data in"]
["lidar.baud", "int", 230400, 9600, 921600, "Bd", "speed of the lidar's line"]
["lidar.rxbuf", "int", 4096, 512, 16384, "bytes", "receive buffer"]
["lidar.frames", "int", 16, 8, 32, "", "frames in a revolution: 16, or 15 for the Delta-2G"]
["lidar.offset", "int", 0, -180, 360, "deg", "bearing of the lidar's zero, clockwise from forward"]
["lidar.mirrored", "flag", false, null, null, "", "true where the lidar's angles grow counter-clockwise seen from above"]
["lidar.x", "int", 0, -1500, 1500, "mm", "lidar right of the body's centre"]
["lidar.y", "int", 0, -1500, 1500, "mm", "lidar ahead of the body's centre"]
["lidar.near", "int", 200, 50, 1000, "mm", "no nearer reading is used: the lidar does not see so near"]
["lidar.far", "int", 8000, 1000, 16000, "mm", "no farther reading is used"]
["lidar.returns", "int", 20, 0, 100, "%", "least share of the beams that come back in a revolution; 0, for open halls: what does not come back is free"]
["lidar.left_out", "sectors", [], -180, 360, "", "sectors in which the robot sees its own mast or cables, each [from, to] in degrees clockwise from forward; what is nearer than 2 m does not count there"]
["lidar.speed", "int", 6.6, 4, 10, "r/s", "revolutions held by the motor control"]
["lidar.motor_pin", "pin", 27, 0, 33, "", "PWM of the lidar's motor, none where it keeps its own speed"]
["lidar.motor_frequency", "int", 20000, 100, 40000, "Hz", "PWM frequency of the lidar's motor"]
["i2c.bus", "int", 0, 0, 1, "", "I2C bus of the PWM chips"]
["i2c.scl", "pin", 22, 0, 33, "", "I2C clock"]
["i2c.sda", "pin", 21, 0, 33, "", "I2C data"]
["i2c.frequency", "int", 400000, 50000, 1000000, "Hz", "I2C clock frequency"]
["servos.address", "address", "0x40", "0x40", "0x7f", "", "PWM chip of the servos"]
["servos.frequency", "int", 50, 40, 100, "Hz", "pulses a second"]
["servos.oscillator", "int", 25000000, 22000000, 28000000, "Hz", "the chip's own clock; correct it until a 1500 us pulse measures 1500 us"]
["servos.channels", "wheels", null, 0, 15, "", "output of each wheel's servo"]
["servos.directions", "signs", 1, null, null, "", "1, or -1 for a servo that turns the other way"]
["servos.trims", "wheels", 0, -20, 20, "deg", "added to the wheel's angle so that 0 is straight ahead"]
["servos.low", "wheels", -90, -90, 0, "deg", "farthest the wheel turns left"]
["servos.high", "wheels", 90, 0, 90, "deg", "farthest the wheel turns right"]
["servos.pulse_low", "wheels", 500, 300, 1400, "us", "pulse of -90 deg"]
["servos.pulse_high", "wheels", 2500, 1600, 2700, "us", "pulse of 90 deg"]
["motors.left", "address", "0x41", "0x40", "0x7f", "", "PWM chip of the left motors"]
["motors.right", "address", "0x42", "0x40", "0x7f", "", "PWM chip of the right motors"]
["motors.frequency", "int", 1000, 24, 1526, "Hz", "PWM frequency"]
["motors.oscillator", "int", 25000000, 22000000, 28000000, "Hz", "clock of the motors' chips"]
["motors.channels", "pairs", null, 0, 14, "", "output of IN1 of each axle's motors; IN2 is the next one"]
["motors.directions", "signs", 1, null, null, "", "1, or -1 for a motor that runs the other way"]
["motors.full_speed", "int", 1280, 100, 5000, "mm/s", "speed of the wheels at V = 180"]
["pins.output_enable", "pin", 33, 0, 33, "", "output enable of the PWM chips, active low"]
["pins.servo_enable", "pin", null, 0, 33, "", "output enable of the servos' chip alone, active low, for a robot with an arm; pins.output_enable is that of the motors' chips then"]
["pins.stop_button", "pin", 32, 0, 39, "", "stop button, closed to ground = stop"]
["pins.stop_closed", "flag", false, null, null, "", "true for a stop button that opens when pressed: a broken wire stops, too; it does not start the robot"]
["pins.battery", "pin", 35, 32, 39, "", "battery voltage through a divider"]
["battery.divider", "int", 3.0, 1, 20, "times", "battery voltage over the voltage at the pin"]
["goal.method", "choice", "gap", ["gap", "field", "behaviour"], null, "", "how a goal is made for, where there is a map: by gap seeking, paper C's potential field, or its behaviours"]
["drive.autostart", "flag", false, null, null, "", "true: drives off by itself when power is switched on; false: waits until it is started"]
["screen.kind", "choice", "none", ["none", "usart-gpu", "uart-lcd", "nextion"], null, "", "serial touch screen"]
["screen.uart", "int", 1, 1, 2, "", "UART of the screen"]
["screen.tx", "pin", 25, 0, 33, "", "data to the screen"]
["screen.rx", "pin", 26, 0, 39, "", "data from the screen"]
["screen.baud", "int", 115200, 9600, 921600, "Bd", "speed of the screen's line"]
["wifi.ssid", "text", "", null, 32, "", "network to join; empty: no radio"]
["wifi.password", "text", "", null, 63, "", "its password"]
["wifi.access_point", "flag", false, null, null, "", "true: be the network instead of joining it"]
["wifi.port", "int", 9750, 1024, 65535, "", "UDP port of the telemetry"]
"""

LIVE = """
["drive.cruise", "int", 108, 91, 180, "on the V scale", "speed on a free way; 90 stands, 180 is full speed"]
["drive.acceleration", "int", 2000, 100, 20000, "mm/s2", "fastest change of speed; a stop is immediate"]
["servos.rate", "int", 300, 20, 1000, "deg/s", "how fast the servos are asked to turn"]
["servos.latency", "int", 20, 0, 200, "ms", "from a new pulse width to the wheel's motion"]
["servos.swing", "int", 20, 1, 180, "deg", "the robot stands still while a wheel has to turn farther than this"]
["motors.time_constant", "int", 80, 0, 1000, "ms", "of the wheels' speed after a new command"]
["motors.dead_band", "int", 0, 0, 50, "%", "duty at which the wheels just do not turn"]
["windows.red", "int", 20, 0, 200, "mm", "emergency margin round the body"]
["windows.blue", "int", 45, 1, 400, "mm", "caution margin round the body"]
["windows.look_ahead", "int", null, 100, 4500, "mm", "length of the planning window, null for 1.5 body lengths; counts from the next start"]
["windows.side", "int", 300, 0, 1500, "mm", "width of the planning window beside the body"]
["avoid.margin", "int", null, 0, 100, "mm", "clearance kept to every point, null for 1.5 % of the body's length but 9 mm at least; counts from the next start"]
["avoid.soft_margin", "int", null, 0, 200, "mm", "clearance preferred, null for 5 % of the length but 30 mm at least; counts from the next start"]
["avoid.accept", "int", 150, 20, 1000, "mm", "shortest free way worth driving"]
["avoid.steering_weight", "int", 15, 0, 100, "%", "what full steering costs, of a free look-ahead"]
["avoid.change_weight", "int", 5, 0, 100, "%", "what a full change of steering costs, of a free look-ahead"]
["battery.low", "int", 6600, 3000, 30000, "mV", "warn below this"]
["battery.empty", "int", 6200, 3000, 30000, "mV", "stop below this"]
"""
