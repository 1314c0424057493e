"""The arm's servos: pulses in, angles out. Rate, latency and torque are limited; without pulses it falls to its rest pose.

Nothing here knows what the firmware meant; arm.json says how the builder built it.
"""

import json
from pathlib import Path

import numpy as np

GRAVITY = 9.81
SHORTEST_US, LONGEST_US = 250.0, 2750.0  # a servo ignores other pulses
_RATE = 1.25  # a servo turns so much faster than the limit that its joint is given
_FALLS = 120.0  # deg/s, limp or overloaded
_STEP_S = 0.005


class Arm:
    """settings: what arm.json holds. ValueError if the twin cannot make an arm of it.

    angles: of joints and extra joints, deg, where they are now. overloaded: joints that needed more than their torque at some time.
    """

    def __init__(self, settings: dict):
        try:
            joints, servos = settings["joints"], settings["servos"]
            rows = [*joints, *settings.get("extra", [])]
            count = len(rows)
            self.channels = tuple(servos["channels"])
            self._zeros = np.array(servos.get("zeros_deg", [0] * count), float)
            self._ways = np.array(servos.get("directions", [1] * count), float)
            low, high = float(servos.get("pulse_low_us", 500)), float(servos.get("pulse_high_us", 2500))
            self._middle, self._per_us = (low + high) / 2, float(servos.get("range_deg", 180)) / (high - low)
            self._rest = np.array(servos["rest_deg"], float)
            self._rates = _RATE * np.array([row["speed_deg_s"] for row in rows], float)
            self._lengths = np.array([joint["length_mm"] for joint in joints], float) / 1000
            self._beyond = np.cumsum(np.array([joint["mass_kg"] for joint in joints], float)[::-1])[::-1]  # kg from each link's end on
            self._torques = np.array([joint["torque_nm"] for joint in joints], float)
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"arm.json: {error!r}: see docs/arm.md") from None
        if not len(self.channels) == len(self._zeros) == len(self._rest) == len(rows):
            raise ValueError("arm.json: servos: one value for each joint is needed")
        self.angles = self._rest.copy()
        self._targets = self._rest.copy()
        self._driven = np.zeros(len(rows), bool)
        self.overloaded: set[int] = set()
        self._now = 0.0

    def take_pulses(self, time_us: float, widths, enabled: bool) -> None:
        """The servos see pulses of these widths (us, 0: none) from now on."""
        self.advance(time_us)
        widths = np.asarray(widths, float)
        self._driven = enabled & (widths >= SHORTEST_US) & (widths <= LONGEST_US)
        wanted = self._zeros + self._ways * (widths - self._middle) * self._per_us
        self._targets = np.where(self._driven, wanted, self._rest)

    def advance(self, time_us: float) -> None:
        """Let the joints go on to the time."""
        while self._now < time_us - 1e-6:
            step = min(_STEP_S, (time_us - self._now) / 1e6)
            self._now += step * 1e6
            if not np.array_equal(self.angles, self._targets):
                self._move(step)

    def _move(self, step: float) -> None:
        rates = np.where(self._driven, self._rates, _FALLS)
        targets = self._targets.copy()
        holding = self.holding()
        for k, (torque, limit) in enumerate(zip(holding, self._torques)):
            up = (targets[k] - self.angles[k]) * torque > 0
            if self._driven[k] and abs(torque) > limit and up:  # it cannot lift that: it gives way
                self.overloaded.add(k)
                targets[k] = self.angles[k] - np.sign(torque) * _FALLS
                rates[k] = _FALLS
        self.angles += np.clip(targets - self.angles, -rates * step, rates * step)

    def holding(self):
        """Torque that holds each joint of the plane against gravity, N m."""
        a = np.radians(np.cumsum(self.angles[: len(self._lengths)]))
        return np.cumsum((self._beyond * GRAVITY * self._lengths * np.cos(a))[::-1])[::-1]


def read(arm) -> dict | None:
    """What an arm.json holds: arm is None (no arm), a dict, or the path of a file. ValueError where it cannot be read."""
    if arm is None or isinstance(arm, dict):
        return arm
    try:
        values = json.loads(Path(arm).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{arm} cannot be read: {getattr(error, 'strerror', None) or error}") from None
    except ValueError as error:
        raise ValueError(f"{arm} is not JSON: {error}") from None
    if not isinstance(values, dict):
        raise ValueError(f"{arm} must hold a JSON object")
    return values
