# SPDX-License-Identifier: MIT
"""How the joint moves: pieces of polynomials in time, so that angle, speed and acceleration are exact at any instant.

Angles in degrees, on the output side of the gear; times in seconds.
"""

import numpy as np
from numpy.polynomial import Polynomial

SMOOTH_STEP = Polynomial([0, 0, 0, 10, -15, 6])  # 0 to 1 with speed and acceleration zero at both ends


def value(coefficients, share):
    """Of the polynomial, the constant first: the very steps of numpy's, without what it looks at before each."""
    total = coefficients[-1] + share * 0.0
    for coefficient in coefficients[-2::-1]:
        total = coefficient + total * share
    return total


class Motion:
    """Pieces one after another; before the first and after the last the joint goes on at its speed there."""

    def __init__(self, start_deg):
        self._ends, self._pieces = [0.0], []
        self.angle_deg, self.speed_deg_s = start_deg, 0.0

    @property
    def duration_s(self):
        return self._ends[-1]

    def append(self, duration_s, angle):
        """angle: polynomial in the share of the piece, in degrees."""
        speed = angle.deriv(1)
        self._pieces.append((duration_s, *(curve.coef.tolist() for curve in (angle, speed, speed.deriv(1)))))
        self._ends.append(self._ends[-1] + duration_s)
        self.angle_deg = angle(1.0)
        self.speed_deg_s = speed(1.0) / duration_s
        return self

    def rest(self, duration_s):
        self.speed_deg_s = 0.0
        return self.append(duration_s, Polynomial([self.angle_deg]))

    def speed_to(self, speed_deg_s, duration_s):
        """The speed changes smoothly; the same speed again is a stretch of constant speed."""
        change = (speed_deg_s - self.speed_deg_s) * SMOOTH_STEP
        return self.append(duration_s, self.angle_deg + duration_s * (self.speed_deg_s + change).integ())

    def stay(self, duration_s):
        return self.speed_to(self.speed_deg_s, duration_s)

    def stroke(self, by_deg, duration_s):
        """From rest to rest with least jerk."""
        return self.append(duration_s, self.angle_deg + by_deg * SMOOTH_STEP)

    def at(self, time_s):
        """Angle (deg), speed (deg/s) and acceleration (deg/s2) at each time."""
        piece = np.clip(np.searchsorted(self._ends, time_s, side="right") - 1, 0, len(self._pieces) - 1)
        angle, speed, acceleration = (np.empty_like(time_s) for _ in range(3))
        in_order = np.all(piece[1:] >= piece[:-1])
        bounds = np.searchsorted(piece, np.arange(len(self._pieces) + 1)) if in_order else None
        for k, (duration, *curves) in enumerate(self._pieces):
            here = slice(bounds[k], bounds[k + 1]) if in_order else piece == k
            share = (time_s[here] - self._ends[k]) / duration
            inside = np.clip(share, 0.0, 1.0)
            speed[here] = value(curves[1], inside) / duration
            acceleration[here] = np.where(share == inside, value(curves[2], inside) / duration**2, 0.0)
            angle[here] = value(curves[0], inside) + speed[here] * (share - inside) * duration
        return angle, speed, acceleration


def rich(rng, start_deg, seconds):
    """Five speeds from 25 to 178 deg/s in both directions, rests, then smooth strokes of different duration."""
    motion = Motion(start_deg).rest(rng.uniform(0.4, 0.6))
    speeds = np.array([25.0, 50.0, 90.0, 135.0, 178.0]) * np.append(1.0, rng.uniform(0.85, 1.15, 3).tolist() + [1.0])
    first = rng.choice([-1.0, 1.0])
    for speed in rng.permutation(speeds):
        ramp, stay = 0.25 + 0.4 * speed / 178.0, rng.uniform(1.0, 1.5)
        for direction in (first, -first):
            motion.speed_to(direction * speed, ramp).stay(stay).speed_to(0.0, ramp).rest(rng.uniform(0.25, 0.4))
    direction = -first
    while motion.duration_s < seconds - 3.5:
        motion.stroke(direction * rng.uniform(90.0, 180.0), rng.uniform(1.6, 2.8)).rest(rng.uniform(0.3, 0.4))
        direction = -direction
    return motion.rest(max(0.3, seconds - motion.duration_s))
