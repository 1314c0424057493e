"""Wheel angles and speeds -> the three PWM chips, and what happens when one of them is lost.

Servos: angle + trim, direction and pulse range of each wheel -> pulse width. Motors (L298N, enable jumpered): IN1 carries the PWM forward, IN2
backward, both low brake. The output enable line keeps everything off until the registers of all chips are valid.
"""

import micropython
from micropython import const

_FULL_SPEED = const(23040)  # (180 - 90) * 256
_FULL = const(0x10)  # of ON_H and OFF_H: always on, always off


# Both write straight into the images of the chips (see pca9685.py): in between there would be a call for each chip, dearer than all its outputs.


@micropython.viper
def _servo_registers(angles: ptr16, lines: ptr32, image: ptr8) -> int:
    """count = centre + slope * angle, angle in 0.1 deg, for every wheel; return 1 if a register has changed.

    lines: number of wheels, then of each the centre in 2**-15 counts, and (slope in the same + 2**15) * 64 + place of OFF_L in the image.
    """
    changed = 0
    last = 2 * lines[0]
    k = 0
    at = 0
    while at < last:
        angle = (angles[k] ^ 0x8000) - 0x8000
        place = lines[at + 2]
        count = (lines[at + 1] + angle * ((place >> 6) - 0x8000) + 0x4000) >> 15
        place &= 63
        high = count >> 8
        count &= 0xFF
        if image[place] != count or image[place + 1] != high:
            image[place] = count
            image[place + 1] = high
            changed = 1
        k += 1
        at += 2
    return changed


@micropython.viper
def _motor_registers(shares: ptr16, wires: ptr8, v256: int, dead: int, left: ptr8, right: ptr8) -> int:
    """Duty of IN1 (forward) and IN2 (backward) of every motor; return 2 if a register of the left chip has changed, plus 4 for the right one.

    wires: number of wheels, then of each the places of ON_H of IN1 and of IN2 in the image, exchanged where the motor runs the other way.
    dead: counts at which a motor just does not turn.
    """
    changed = 0
    wheels = wires[0]
    k = 0
    while k < wheels:
        speed = (v256 * ((shares[k] ^ 0x8000) - 0x8000)) >> 14
        on = wires[k + k + 1]
        off = wires[k + k + 2]
        if speed < 0:
            speed = 0 - speed
            off = on
            on = wires[k + k + 2]
        full = 0
        low = 0
        high = _FULL
        if speed:
            speed = dead + speed * (4096 - dead) // _FULL_SPEED
            low = speed & 0xFF
            high = speed >> 8
            if high == 16:
                full = _FULL
                high = 0
        image = left
        if k & 1:
            image = right
        if image[on + 1] != low or image[on + 2] != high or image[on] != full or image[off + 2] != _FULL:
            image[on] = full
            image[on + 1] = low
            image[on + 2] = high
            image[off] = 0
            image[off + 1] = 0
            image[off + 2] = _FULL
            changed |= 2 << (k & 1)
        k += 1
    return changed


class Outputs:
    """The servo chip and the chips of the left and the right motors (pca9685.PCA9685 each).

    output_enable: Pin whose high level switches every output off, or None. config: Config.

    Everything is off after construction; begin() or the first write() tries to set the chips up. A chip that does not answer takes all outputs
    down, and is tried again once a second.

    ok          all chips have answered
    fault       text of the last fault, "" at first
    restarts    how often the chips have been set up: the wheels may stand anywhere after each
    """

    def __init__(self, servo_chip, motor_left, motor_right, output_enable, config):
        from actuation.wiring import outputs

        outputs(self, (servo_chip, motor_left, motor_right), output_enable, config)
        self._set_enabled(False)
        self.derive()

    def derive(self):
        """Take in live parameters that have changed."""
        config = self._config
        self._dead = config.motors_dead_band * 4096 // 100
        lines = self._lines
        for k in range(lines[0]):
            more = config.servos_trims[k] - self._trims[k]
            lines[1 + 2 * k] += ((lines[2 + 2 * k] >> 6) - 0x8000) * more
            self._trims[k] += more

    def begin(self):
        """Set all chips up, every output still off. True if all answered."""
        self._set_enabled(False)
        try:
            for chip in self._chips:
                chip.start()
        except OSError as error:
            self._fail(error)
            return False
        self._unsent = 7
        self.ok = True
        self.restarts += 1
        return True

    def write(self, angles, shares, v256):
        """Called once a servo period: send what changed. array('h') of Steering, and the fastest wheel's V - 90 in 1/256. True if all is well."""
        tick = self._tick + 1
        if tick >= self._ticks_a_second:
            tick = 0
            self._unseen = 7
        self._tick = tick
        if not self.ok:
            if tick or not self.begin():
                return False
        servos, left, right = self._chips
        changed = self._unsent
        try:
            changed |= _servo_registers(angles, self._lines, servos.image)
            if v256:
                changed |= _motor_registers(shares, self._wires, v256, self._dead, left.image, right.image)
                self._rolling = True
            elif self._rolling:
                self._rolling = False
                left.clear()
                right.clear()
            # One chip a period: once a second the whole of it, else, while it drives, whether it was reset.
            k = tick % 3
            # A period in which all three chips are written is full without the whole of one: waits, if it can, for another.
            if self._unseen & 1 << k and (changed | 1 << k != 7 or tick + 3 >= self._ticks_a_second):
                self._unseen ^= 1 << k
                changed |= self._check(k)
            elif v256 and not self._chips[k].awake():
                changed |= self._check(k)
            if changed & 1:
                servos.write()
            if changed & 2:
                left.write()
            if changed & 4:
                right.write()
        except OSError as error:
            self._fail(error)
            return False
        self._unsent = 0
        if not self._enabled:
            self._set_enabled(True)
        return True

    def motors_off(self):
        """Stop the motors now, without waiting for the next period; the servos hold."""
        if self.ok:
            try:
                self._chips[1].clear()
                self._chips[2].clear()
            except OSError as error:
                self._fail(error)
            self._rolling = False

    def off(self):
        """Everything off, for good: the servos let go. The pin first, which does not depend on a bus; then each chip by itself. Raises nothing."""
        self.ok = False
        self._enabled = False
        try:
            if self._enable is not None:
                self._enable.value(1)
        except Exception:  # whatever it is, the chips are left
            pass
        for chip in self._chips:
            try:
                chip.deinit()
            except Exception:
                pass

    def _check(self, k):
        """Look at all of chip k: its bit, to have its registers sent again. One that was reset is off until the next period."""
        chip = self._chips[k]
        if not chip.check():
            self.fault = "PCA9685 at 0x%02x was reset: look for dips of its supply" % chip.address
            self.restarts += 1
        return 1 << k

    def _fail(self, error):
        self.ok = False
        self.fault = error.args[0]
        self._tick = 0
        self._set_enabled(False)
        # Where output enable is not wired, the chips that still answer can at least be told.
        for k in range(1, 3):
            try:
                self._chips[k].clear()
            except OSError:
                pass

    def _set_enabled(self, enabled):
        if enabled != self._enabled:
            self._enabled = enabled
            if self._enable is not None:
                self._enable.value(0 if enabled else 1)
