"""The robot in a browser, or in a terminal: see it, drive it, tune it, record it.

cli        arguments, and which robot is meant when none is named
station    one link, what it last told, recording
server     the page and its WebSocket
text       the same in a terminal
page/      the page: plain HTML, CSS and JavaScript modules, nothing fetched from elsewhere
"""
