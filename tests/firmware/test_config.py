"""params/: what robot.json may say, and what is answered to what it may not."""

import os

from params import schema
from params.change import change
from params.config import Config
from params.parse import load, read
from params.values import ConfigError

ROBOT_JSON = __file__.rsplit("/", 3)[0] + "/firmware/robot.json"

AXLES = " (8 axles at most: two wheels on each, 16 channels on a chip)"


def _refusal(values):
    try:
        Config(values)
    except ValueError as error:
        return str(error)
    return ""


def _attributes(config):
    return dict(config.__dict__), dict(config.once)


def test_an_empty_file_is_the_robot_of_the_papers():
    config = Config({})
    assert config.axles == 5 and config.axles_spacings == (115, 150, 117, 115) and config.axles_first == 248.5
    assert (config.robot_length, config.robot_width, config.axles_track) == (600, 250, 230)
    assert (config.servos_address, config.motors_left, config.motors_right) == (0x40, 0x41, 0x42)
    assert list(config.servos_channels) == list(range(10)) and list(config.motors_channels) == [0, 2, 4, 6, 8]
    assert config.mode == "AWS" and config.motors_full_speed == 1280 and config.drive_cruise == 108


def test_the_file_on_the_board_says_every_default():
    assert _attributes(Config(load(ROBOT_JSON))) == _attributes(Config())
    with open(ROBOT_JSON) as file:
        text = file.read()
    for row in schema.rows(schema.BOOT, schema.LIVE):
        assert '"%s":' % row[0].split(".")[-1] in text, row[0]


def test_units_become_integers():
    config = Config({"lidar": {"offset": -12.5, "speed": 6.25}, "battery": {"divider": 3.2}, "servos": {"trims": [0.5, -1.2] * 5, "low": -75}})
    assert config.lidar_offset == -125
    assert config.lidar_speed20 == 125
    assert config.battery_divider1000 == 3200
    assert list(config.servos_trims) == [5, -12] * 5
    assert list(config.servos_low) == [-750] * 10


def test_number_of_axles_follows_the_spacings():
    for spacings in ((100,), (100, 100), (80,) * 7):
        config = Config({"axles": {"spacings": list(spacings)}})
        assert config.axles == len(spacings) + 1
        assert len(config.servos_trims) == len(config.motors_directions) == 2 * config.axles
        assert len(config.motors_channels) == config.axles


def test_channels_can_be_wired_in_any_order():
    config = Config({"servos": {"channels": [9, 8, 7, 6, 5, 4, 3, 2, 1, 15]}, "motors": {"channels": [14, 0, 4, 8, 2], "left": "0x44"}})
    assert list(config.servos_channels) == [9, 8, 7, 6, 5, 4, 3, 2, 1, 15] and config.motors_left == 0x44


def test_refusals_name_the_key_its_value_and_what_is_allowed():
    for values, refusal in (
        ({"lidar": {"baud": 12}}, "lidar.baud = 12: a whole number 9600 .. 921600 Bd is needed"),
        ({"robot": {"length": 600.5}}, "robot.length = 600.5: a whole number 100 .. 3000 mm is needed"),
        ({"robot": {"length": "600"}}, 'robot.length = "600": a whole number 100 .. 3000 mm is needed'),
        ({"robot": {"length": True}}, "robot.length = true: a whole number 100 .. 3000 mm is needed"),
        ({"robot": {"length": None}}, "robot.length = null: a whole number 100 .. 3000 mm is needed"),
        ({"mode": "4WS"}, 'mode = "4WS": allowed: AWS, NAWS'),
        ({"lidar": {"speed": 11}}, "lidar.speed = 11: a number 4 .. 10 r/s is needed"),
        ({"lidar": {"mirrored": 1}}, "lidar.mirrored = 1: true or false is needed"),
        ({"lidar": 5}, "lidar = 5: an object is needed, { ... }"),
        ({"wifi": {"ssid": 5}}, "wifi.ssid = 5: a text of at most 32 characters is needed"),
        ({"axles": {"spacings": [70] * 8}}, "axles.spacings = [70, 70, 70, 70, 70, 70, 70, 70]: a list of 1 .. 7 numbers is needed" + AXLES),
        ({"axles": {"spacings": []}}, "axles.spacings = []: a list of 1 .. 7 numbers is needed" + AXLES),
        ({"axles": {"spacings": [300, 301]}}, "axles.spacings = [300, 301]: the sum must not exceed robot.length = 600 mm"),
        ({"axles": {"track": 260}}, "axles.track = 260: it must not exceed robot.width = 250 mm"),
        ({"servos": {"trims": [1, 2]}}, "servos.trims = [1, 2]: 10 values are needed, one for each wheel, not 2"),
        ({"servos": {"trims": [0] * 9 + [21]}}, "servos.trims = 21: a number -20 .. 20 deg is needed"),
        ({"servos": {"directions": [1] * 9 + [0]}}, "servos.directions = 0: 1 or -1 is needed"),
        ({"motors": {"channels": [0, 2, 4]}}, "motors.channels = [0, 2, 4]: 5 values are needed, one for each axle, not 3"),
        ({"motors": {"channels": [0, 1, 4, 6, 8]}}, "motors.channels = [0, 1, 4, 6, 8]: output 1 is used twice"),
        ({"servos": {"channels": [0, 1, 2, 3, 4, 5, 6, 7, 8, 8]}}, "servos.channels = [0, 1, 2, 3, 4, 5, 6, 7, 8, 8]: output 8 is used twice"),
        ({"motors": {"left": "0x40"}}, 'motors.left = "0x40": already the address of servos.address'),
        ({"motors": {"left": 0x70}}, "motors.left = 112: an address 0x40 .. 0x7f but not 0x70 is needed"),
        ({"motors": {"left": "left"}}, 'motors.left = "left": an address 0x40 .. 0x7f but not 0x70 is needed'),
        ({"pins": {"battery": 33}}, "pins.battery = 33: already the pin of pins.output_enable"),
        ({"pins": {"stop_button": 6}}, "pins.stop_button = 6: null or a GPIO 0 .. 39 is needed, not 1, 3 (USB) or 6 .. 11 (flash)"),
        ({"lidar": {"rx": None}}, "lidar.rx = null: a GPIO is needed"),
        ({"pins": {"output_enable": 34}}, "pins.output_enable = 34: null or a GPIO 0 .. 33 is needed, not 1, 3 (USB) or 6 .. 11 (flash)"),
        ({"screen": {"kind": "nextion", "uart": 2}}, "screen.uart = 2: already the UART of the lidar"),
        ({"lidar": {"near": 1000, "far": 1000}}, "lidar.near = 1000: it must be less than lidar.far = 1000 mm, or nothing is seen"),
        (
            {"lidar": {"near": 525}, "robot": {"length": 300}, "axles": {"spacings": [50]}},
            "lidar.near = 525: it must be less than 1.75 robot.length = 525 mm, or nothing is seen",
        ),
        ({"windows": {"red": 100}}, "windows.red = 100: it must not exceed windows.blue = 45"),
        ({"lidar": {"bauds": 1}}, "unknown key lidar.bauds: lidar has uart, rx, baud,"),
        ({"lidars": {"baud": 1}}, "unknown key lidars: robot.json has mode, robot, axles,"),
        ({"wifi": {"password": "short"}}, 'wifi.password = "*****": 8 to 63 characters, or none for an open network'),
        ([], "robot.json must hold one object, { ... }"),
    ):
        answer = _refusal(values)
        assert answer == refusal or (refusal.endswith(",") and answer.startswith(refusal)), (values, answer)


def test_text_that_is_no_json_is_refused_with_its_line():
    for text, line in (('{\n "mode": "AWS",\n "robot": {"length" 600 -}\n}', 3), ("", 1), ('{\n"lidar": {', 2), ('{"lidar": {\n\n"baud": x}}', 3)):
        try:
            read(text)
        except ValueError as error:
            assert "line %d " % line in str(error), (text, error)
        else:
            assert False, text


def test_a_file_far_too_large_is_refused_unread():
    path = "too_large.json"
    with open(path, "w") as file:
        file.write(" " * 20000)
    try:
        load(path)
        assert False
    except ConfigError as error:
        assert "larger than" in str(error)
    finally:
        os.remove(path)


def test_sectors_to_leave_out():
    assert Config({"lidar": {"left_out": [[-20, 10], [350, 360]]}}).lidar_left_out == (-20, 10, 350, 360)
    assert Config().lidar_left_out == ()
    for value in (5, [5], [[5]], [[10, 5]], [[-181, 0]], [[0, 361]], [[0, 1.5]], [["0", 1]], [[0, 1]] * 9):
        try:
            Config({"lidar": {"left_out": value}})
        except ValueError as error:
            assert "lidar.left_out" in str(error) and "is needed" in str(error), error
        else:
            assert False, value


def test_tuning_is_checked_and_counted():
    config = Config()
    change(config, "avoid.margin", 20)
    assert config.avoid_margin == 20 and config.changes == 1
    for key, value, part in (
        ("avoid.margin", 101, "avoid.margin = 101: a whole number 0 .. 100 is needed"),
        ("avoid.margin", 1.5, "a whole number"),
        ("avoid.margin", "20", "a whole number"),
        ("avoid.margin", 41, "avoid.margin = 41: avoid.margin <= avoid.soft_margin must hold"),
        ("windows.blue", 10, "windows.blue = 10: windows.red <= windows.blue must hold"),
        ("lidar.baud", 9600, "lidar.baud = 9600: it cannot change while the robot runs: edit robot.json and restart"),
        ("nothing", 1, "nothing = 1: it cannot change"),
    ):
        try:
            change(config, key, value)
        except ValueError as error:
            assert part in str(error), error
        else:
            assert False, key
    assert config.avoid_margin == 20 and config.windows_blue == 45 and config.changes == 1


def test_trims_can_be_tuned_one_by_one():
    config = Config()
    change(config, "servos.trims.3", -2.5)
    assert list(config.servos_trims) == [0, 0, 0, -25, 0, 0, 0, 0, 0, 0] and config.changes == 1
    for key, value, part in (
        ("servos.trims.10", 0, "servos.trims.0 .. servos.trims.9"),
        ("servos.trims.0", 21, "-20 .. 20"),
        ("servos.trims.x", 0, "wheels"),
    ):
        try:
            change(config, key, value)
        except ValueError as error:
            assert part in str(error), error
        else:
            assert False, key


def test_after_the_start_only_the_loops_parameters_are_left():
    config = Config()
    config.once = None
    assert config.motors_full_speed == 1280 and config.windows_blue == 45 and config.axles == 5
    try:
        config.lidar_baud
    except AttributeError:
        return
    assert False


def test_every_row_is_complete_and_every_default_allowed():
    keys = [row[0] for row in schema.rows(schema.BOOT, schema.LIVE)]
    assert len(set(keys)) == len(keys)
    for row in schema.rows(schema.BOOT, schema.LIVE):
        assert len(row) == 7 and row[6] and row[6] == row[6].strip(), row
    for row in schema.rows(schema.LIVE):
        default = getattr(Config(), row[0].replace(".", "_")) if row[2] is None else row[2]
        assert row[1] == "int" and type(default) is int and row[3] <= default <= row[4], row


def test_the_planning_window_goes_with_the_body():
    assert Config().windows_look_ahead == 900
    assert Config({"robot": {"length": 1200}, "windows": {"look_ahead": None}}).windows_look_ahead == 1800
    assert Config({"robot": {"length": 1200}, "windows": {"look_ahead": 700}}).windows_look_ahead == 700


def test_the_margins_go_with_the_body():
    for length, margin, soft in ((400, 9, 30), (600, 9, 30), (1200, 18, 60)):
        config = Config({"robot": {"length": length}, "axles": {"spacings": [100, 100]}})
        assert (config.avoid_margin, config.avoid_soft_margin) == (margin, soft), length


def test_a_screen_has_a_line_of_its_own():
    assert Config({"screen": {"kind": "nextion"}}).screen_kind == "nextion"
    assert _refusal({"screen": {"kind": "nextion", "tx": 27}}) == "screen.tx = 27: already the pin of lidar.motor_pin"


def test_a_file_that_is_no_text_is_refused_as_such():
    with open("not-text.json", "wb") as file:
        file.write(b'{"mode": "\x80"}')
    try:
        load("not-text.json")
        assert False, "taken"
    except ConfigError as error:
        assert "UTF-8" in str(error)
    finally:
        os.remove("not-text.json")


def test_what_no_robot_json_may_be():
    from params.parse import read

    for text, word in (("null", "object"), ("{}", "object"), ("[]", "object"), ("5", "object"),
                       ('{"lidar": {"near": 200, "near" : 300}}', '"near" twice'), ('{"robot": {}, "lidar": {"x": 1}, "robot": {}}', '"robot" twice')):  # fmt: skip
        try:
            read(text)
            assert False, text
        except ValueError as error:
            assert word in str(error), error
    assert (
        read('{"robot": {"length": 600}, "lidar": {"near": 200, "x": 1}, "axles": {"spacings": [100]}, "wifi": {"ssid": "a\\"{:"}}')["wifi"]["ssid"] == 'a"{:'
    )


def test_a_group_where_a_choice_is_needed():
    try:
        Config({"mode": {}})
        assert False
    except ValueError as error:
        assert "mode" in str(error)


def test_a_password_that_no_network_takes_is_refused_and_not_shown():
    for password in ("12345", "qq7"):
        try:
            Config({"wifi": {"password": password}})
        except ValueError as error:
            assert "8 to 63" in str(error) and password not in str(error)
        else:
            assert False, password
    for password in ("", "12345678"):
        Config({"wifi": {"password": password}})
