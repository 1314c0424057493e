"""The robot's mechanics and wiring as the twin needs them: what robot.json says the builder built."""

from dataclasses import dataclass

from host import compat


@dataclass(frozen=True)
class Lidar:
    """Where the lidar sits and how it counts.

    rx, motor: GPIO, motor None for a lidar that keeps its own speed. frames: a revolution. offset: bearing of its zero, 0.1 deg clockwise. speed: target, r/s. x, y, near, far: mm.
    """

    rx: int
    motor: int | None
    baud: int
    frames: int
    offset: int
    mirrored: bool
    speed: float
    x: float
    y: float
    near: float
    far: float


@dataclass(frozen=True)
class Panel:
    """The serial screen. kind: its dialect; tx, rx: GPIO of the ESP32, None where not joined; baud."""

    kind: str
    tx: int | None
    rx: int | None
    baud: int


@dataclass(frozen=True)
class Vehicle:
    """Lengths in mm, angles in 0.1 deg, pulses in us. Per-wheel tuples run left, right of each axle from the front.

    axles: y of each axle. pulse_low, pulse_high: pulses of -90 and 90 deg. trims: what the firmware adds to an angle for this wheel.
    scl, sda: GPIO. motor_channels: of IN1, for each axle. full_speed: mm/s. cruise: likewise, on a free way: what the best time is
    measured by. battery_divider: battery volts over volts at the pin. screen: None without one.
    """

    axles: tuple
    track: float
    width: float
    length: float
    servo_chip: int
    servo_oscillator: float
    servo_channels: tuple
    servo_directions: tuple
    trims: tuple
    pulse_low: tuple
    pulse_high: tuple
    left_chip: int
    right_chip: int
    motor_oscillator: float
    motor_channels: tuple
    motor_directions: tuple
    full_speed: float
    cruise: float
    output_enable: int | None
    servo_enable: int | None
    stop_button: int | None
    stop_closed: bool
    battery: int | None
    battery_divider: float
    scl: int
    sda: int
    lidar: Lidar
    screen: Panel | None

    @classmethod
    def from_settings(cls, settings):
        """The vehicle of a robot.json, given as a dict. ValueError names the key that is wrong."""
        compat.install()
        from params.config import Config

        c = Config(settings)
        axles = [float(c.axles_first)]
        for spacing in c.axles_spacings:
            axles.append(axles[-1] - spacing)
        return cls(
            axles=tuple(axles),
            track=c.axles_track,
            width=c.robot_width,
            length=c.robot_length,
            servo_chip=c.servos_address,
            servo_oscillator=c.servos_oscillator,
            servo_channels=tuple(c.servos_channels),
            servo_directions=tuple(c.servos_directions),
            trims=tuple(c.servos_trims),
            pulse_low=tuple(c.servos_pulse_low),
            pulse_high=tuple(c.servos_pulse_high),
            left_chip=c.motors_left,
            right_chip=c.motors_right,
            motor_oscillator=c.motors_oscillator,
            motor_channels=tuple(c.motors_channels),
            motor_directions=tuple(c.motors_directions),
            full_speed=c.motors_full_speed,
            cruise=(c.drive_cruise - 90) * c.motors_full_speed / 90,
            output_enable=c.pins_output_enable,
            servo_enable=c.pins_servo_enable,
            stop_button=c.pins_stop_button,
            stop_closed=c.pins_stop_closed,
            battery=c.pins_battery,
            battery_divider=c.battery_divider1000 / 1000,
            scl=c.i2c_scl,
            sda=c.i2c_sda,
            lidar=Lidar(
                rx=c.lidar_rx,
                motor=c.lidar_motor_pin,
                baud=c.lidar_baud,
                frames=c.lidar_frames,
                offset=c.lidar_offset,
                mirrored=c.lidar_mirrored,
                speed=c.lidar_speed20 / 20,
                x=c.lidar_x,
                y=c.lidar_y,
                near=c.lidar_near,
                far=c.lidar_far,
            ),
            screen=None if c.screen_kind == "none" else Panel(c.screen_kind, c.screen_tx, c.screen_rx, c.screen_baud),
        )
