# SPDX-License-Identifier: MIT
"""Reference motions of the simulated joint: trapezoids, sines, Fourier series and jogging.

Each is an array of angle, speed and acceleration at the controller's rate, in rad, from rest to rest within a travel of half_deg to
both sides of zero. Speeds come from a list of pieces whose edges are rounded, so that the jerk stays finite.
"""

import numpy as np

from .integrator import CONTROLLER_RATE_HZ as RATE_HZ


SHORTEST_RAMP_S = 0.2


def _integrated(speed, start_deg):
    """Angle, speed and acceleration (rad) of a speed in deg/s."""
    speed = np.radians(speed)
    angle = np.radians(start_deg) + np.append(0.0, np.cumsum((speed[1:] + speed[:-1]) / (2 * RATE_HZ)))
    return np.column_stack([angle, speed, np.gradient(speed) * RATE_HZ])


def _ramp(start, end, acceleration):
    """A change of speed along half a cosine, of the given largest acceleration or, if that is shorter, of the shortest ramp."""
    count = round(max(SHORTEST_RAMP_S, np.pi / 2 * abs(end - start) / acceleration) * RATE_HZ)
    return start + (end - start) * (1 - np.cos(np.pi * np.arange(count) / count)) / 2


class _Pieces:
    def __init__(self, start_deg):
        self.parts, self.angle, self.speed, self.seconds = [], start_deg, 0.0, 0.0

    def add(self, values):
        values = np.asarray(values, float)
        if len(values):
            self.parts.append(values)
            self.angle += values.sum() / RATE_HZ
            self.speed, self.seconds = values[-1], self.seconds + len(values) / RATE_HZ

    def hold(self, seconds):
        self.add(np.full(round(seconds * RATE_HZ), self.speed))

    def rest(self, seconds):
        self.speed = 0.0
        self.hold(seconds)

    def to_speed(self, speed, acceleration):
        self.add(_ramp(self.speed, speed, acceleration))

    def stroke(self, distance, speed, acceleration):
        """From rest to rest, at most at that speed."""
        ramp = max(SHORTEST_RAMP_S, np.pi / 2 * speed / acceleration)
        if speed * ramp > abs(distance):
            speed = np.sqrt(2 / np.pi * abs(distance) * acceleration)
            ramp = max(SHORTEST_RAMP_S, np.pi / 2 * speed / acceleration)
        sign = np.sign(distance)
        self.to_speed(sign * speed, acceleration)
        self.hold(max(0.0, abs(distance) / speed - ramp))
        self.to_speed(0.0, acceleration)

    def all(self, seconds):
        speed = np.concatenate(self.parts)[: round(seconds * RATE_HZ)]
        missing = round(seconds * RATE_HZ) - len(speed)
        return np.append(speed, np.full(missing, 0.0)) if missing > 0 else speed


def trapezoid(rng, seconds, half_deg, fastest, acceleration):
    """Strokes of various lengths and speeds, each with a dwell after it."""
    start = rng.uniform(-0.5, 0.5) * half_deg
    moves, side = _Pieces(start), rng.choice([-1.0, 1.0])
    moves.rest(0.6)
    while moves.seconds < seconds - 0.6:
        target = side * half_deg * rng.uniform(0.3, 1.0)
        distance = target - moves.angle
        speed = fastest * rng.choice([0.12, 0.25, 0.5, 0.75, 1.0])
        speed = max(speed, abs(distance) / max(1.0, seconds / 5))
        if moves.seconds + abs(distance) / speed + 2 > seconds:
            break
        moves.stroke(distance, min(speed, fastest), acceleration * rng.uniform(0.6, 1.0))
        moves.rest(rng.uniform(0.35, 0.7))
        side = -side
    return _integrated(moves.all(seconds), start)


def sine(rng, seconds, half_deg, fastest, acceleration):
    """Two or three sines one after another, of different frequency, each faded in and out over a period."""
    count = int(rng.integers(2, 4))
    time = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    angle = np.zeros_like(time)
    length = (seconds - 1.0) / count
    for k, share in enumerate(rng.permutation([1.0, 0.55, 0.3])[:count]):
        peak = fastest * share
        size = half_deg * rng.uniform(0.6, 1.0)
        omega = min(peak / size, np.sqrt(np.radians(acceleration) / np.radians(size)))
        if omega * length < 3 * np.pi:  # at least one and a half periods
            omega = 3 * np.pi / length
            size = min(size, peak / omega)
        s = time - 0.5 - k * length
        fade = min(2.0, length / 3)
        edge = np.clip(np.minimum(s, length - s) / fade, 0.0, 1.0)
        envelope = edge**3 * (10 - 15 * edge + 6 * edge**2)
        angle += size * envelope * np.sin(omega * s) * ((s >= 0) & (s < length))
    return _integrated(np.gradient(angle) * RATE_HZ, angle[0])


def fourier(rng, seconds, half_deg, fastest, acceleration):
    """A sum of five harmonics over the log, faded in and out."""
    time = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    first = rng.uniform(0.03, 0.06)
    angle = sum(rng.normal() / (k + 1) ** 0.5 * np.sin(2 * np.pi * first * (k + 1) * time + rng.uniform(0, 2 * np.pi))
                for k in range(6))
    edge = np.clip(np.minimum(time - 0.4, seconds - 0.4 - time) / 2.0, 0.0, 1.0)
    angle = angle * edge**3 * (10 - 15 * edge + 6 * edge**2)
    speed = np.gradient(angle) * RATE_HZ
    rise = np.gradient(speed) * RATE_HZ
    scale = min(half_deg / np.abs(angle).max(), fastest / np.abs(speed).max(), acceleration / np.abs(rise).max())
    return _integrated(speed * scale, angle[0] * scale)


def jog(rng, seconds, half_deg, fastest, acceleration):
    """A hand on the jog keys: constant speeds for a while, changed, reversed, a short stop now and then."""
    start = rng.uniform(-0.5, 0.5) * half_deg
    moves, sign = _Pieces(start), rng.choice([-1.0, 1.0])
    moves.rest(0.5)
    while moves.seconds < seconds - 2.5:
        speed = fastest * rng.choice([0.1, 0.2, 0.4, 0.6, 0.8, 1.0])
        ramp = np.pi / 2 * fastest / acceleration
        room = half_deg - sign * moves.angle - speed * ramp
        if room < speed * 0.3:
            sign = -sign
            if rng.random() < 0.5 and moves.speed != 0:
                moves.to_speed(0.0, acceleration)
                moves.rest(rng.uniform(0.2, 0.5))
            continue
        moves.to_speed(sign * speed, acceleration * rng.uniform(0.6, 1.0))
        moves.hold(min(rng.uniform(0.5, 2.0), room / speed, max(0.0, seconds - 2.0 - moves.seconds)))
        if rng.random() < 0.35:
            sign = -sign
    moves.to_speed(0.0, acceleration)
    return _integrated(moves.all(seconds), start)


KINDS = {"trapezoid": trapezoid, "sine": sine, "fourier": fourier, "jog": jog}
