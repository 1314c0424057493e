"""What the robot is wired to, by robot.json. First thing in the start, and let go before the parts are made."""

import machine

_CLOCK = 240_000_000  # Hz; the board wakes up at 160 MHz, and all computing times hold for this


def clock():
    """Set the processor's clock."""
    if machine.freq() != _CLOCK:
        machine.freq(_CLOCK)
        if machine.freq() != _CLOCK:
            print("gapseeker: the processor runs at %d MHz instead of 240: decisions take longer" % (machine.freq() // 1_000_000))


def radio(config):
    """(WLAN that joins by itself, None); (None, what went wrong); (None, None) without a radio."""
    if not config.once["wifi_ssid"]:
        return None, None
    from link.wifi import connect

    return connect(config)


def uarts(once):
    """The UARTs of lidar and screen (or None). once: Config.once."""
    # timeout_char=1 spares an interrupt per byte
    lidar = machine.UART(once["lidar_uart"], once["lidar_baud"], rx=once["lidar_rx"], rxbuf=once["lidar_rxbuf"], timeout=0, timeout_char=1)
    screen = None
    if once["screen_kind"] != "none":
        screen = machine.UART(once["screen_uart"], once["screen_baud"], tx=once["screen_tx"], rx=once["screen_rx"], txbuf=256, timeout=0)
    return lidar, screen


def chips(once):
    """(PCA9685 of the servos, of the left and of the right motors, output enable pin or None). The bus is not touched."""
    from actuation.bus import Bus
    from pca9685 import PCA9685  # it holds machine code, and the radio wants its memory before that

    pin = machine.Pin
    enable = None
    if once["pins_output_enable"] is not None:
        enable = pin(once["pins_output_enable"], pin.OUT, value=1)
    i2c = Bus(machine, once["i2c_bus"], once["i2c_scl"], once["i2c_sda"], once["i2c_frequency"])
    made = [PCA9685(i2c, once["servos_address"], once["servos_frequency"], once["servos_oscillator"], max(once["servos_channels"]) + 1)]
    for address in (once["motors_left"], once["motors_right"]):
        made.append(PCA9685(i2c, address, once["motors_frequency"], once["motors_oscillator"], max(once["motors_channels"]) + 2))
    return made[0], made[1], made[2], enable


def servo_enable(once):
    """Output enable of the servos' chip, where it has a pin of its own, so that an arm does not fall when the motors are switched off; or None."""
    pin = machine.Pin
    return None if once["pins_servo_enable"] is None else pin(once["pins_servo_enable"], pin.OUT, value=1)


def inputs(once):
    """(PWM of the lidar's motor, Pin of the stop button, ADC of the battery's divider), None for each that is not there, and what is to be said."""
    pin = machine.Pin
    motor = button = adc = remark = None
    if once["lidar_motor_pin"] is not None:
        motor = machine.PWM(pin(once["lidar_motor_pin"]), freq=once["lidar_motor_frequency"], duty_u16=0)
    if once["pins_stop_button"] is not None:
        button = pin(once["pins_stop_button"], pin.IN, pin.PULL_UP)
    if once["pins_battery"] is not None:
        adc = machine.ADC(pin(once["pins_battery"]), atten=machine.ADC.ATTN_11DB)  # the default's range ends at 1 V
        try:
            adc.read_uv()
        except OSError:
            remark = "the chip's ADC is not calibrated: the battery's voltage may be 10 % off, set battery.divider by a voltmeter"
    return motor, button, adc, remark
