# SPDX-License-Identifier: MIT
"""Motions of a joint, as position, velocity and acceleration of the output in degrees and seconds, exact at any instant."""

import math

import numpy as np
from numpy.polynomial import Polynomial

KINDS = ("sine", "trapezoid", "quintic", "seventh", "steady", "random moves")
QUINTIC = Polynomial([0, 0, 0, 10, -15, 6])
SEVENTH = Polynomial([0, 0, 0, 0, 35, -84, 70, -20])
# The highest slope of each profile, which goes from 0 to 1 while its argument does.
STEEPEST = {"quintic": 15.0 / 8.0, "seventh": 35.0 / 16.0, "sine": math.pi / 2.0}


class Move:
    """One move from a position to another, or a dwell where both are the same."""

    def __init__(self, start, end, duration, profile, ramp=0.25):
        self.start, self.end, self.duration, self.profile, self.ramp = start, end, duration, profile, ramp

    def at(self, share):
        """Position, velocity and acceleration at shares 0 to 1 of the duration."""
        if self.profile in ("quintic", "seventh"):
            curve = QUINTIC if self.profile == "quintic" else SEVENTH
            s, v, a = curve(share), curve.deriv(1)(share), curve.deriv(2)(share)
        elif self.profile == "sine":
            angle = math.pi * share
            s, v, a = (1 - np.cos(angle)) / 2, math.pi / 2 * np.sin(angle), math.pi**2 / 2 * np.cos(angle)
        else:
            top, r = 1.0 / (1.0 - self.ramp), self.ramp
            rising, falling = share < r, share > 1 - r
            v = top * np.clip(np.minimum(share, 1 - share) / r, 0, 1)
            a = top / r * (rising.astype(float) - falling)
            s = np.where(rising, top * share**2 / (2 * r),
                         np.where(falling, 1 - top * (1 - share)**2 / (2 * r), top * (share - r / 2)))
        span = self.end - self.start
        return self.start + span * s, span * v / self.duration, span * a / self.duration**2


def time_of(span, peak_speed, profile, ramp):
    return abs(span) * STEEPEST.get(profile, 1.0 / (1.0 - ramp)) / peak_speed


def moves(rng, kind, travel, peak_speed, sweeps):
    """sweeps moves within the travel (steady runs: at most four speeds, to and fro)."""
    made, here = [], -travel / 2
    dwell = rng.choice([0.0, 0.0, rng.uniform(0.05, 1.0)])
    ramp = rng.uniform(0.02, 0.15) if kind == "steady" else rng.uniform(0.05, 0.5)
    speeds = peak_speed * np.exp(-rng.uniform(0.0, 1.5, size=rng.integers(1, 5)))
    speeds[0] = peak_speed
    for k in range(sweeps):
        profile, speed = kind, peak_speed
        there = -here
        if kind == "steady":
            profile, speed = "trapezoid", speeds[k % len(speeds)]
        if kind == "random moves":
            profile = rng.choice(["trapezoid", "quintic", "seventh", "sine"])
            there = rng.uniform(-travel / 2, travel / 2) if k else travel / 2
            if abs(there - here) < travel / 8:
                there = -here if abs(here) > travel / 8 else travel / 2
            speed = peak_speed * rng.uniform(0.3, 1.0)
            dwell = rng.choice([0.0, rng.uniform(0.05, 1.0)])
        made.append(Move(here, there, time_of(there - here, speed, profile, ramp), profile, ramp))
        if dwell:
            made.append(Move(there, there, dwell, "quintic"))
        here = there
    return made, (len(speeds) if kind == "steady" else None)


def along(made, rate):
    """(time, position, velocity, acceleration) of moves one after another at a sample rate."""
    ends = np.cumsum([move.duration for move in made])
    time = np.arange(int(ends[-1] * rate)) / rate
    which = np.minimum(np.searchsorted(ends, time, side="right"), len(made) - 1)
    columns = [np.zeros_like(time) for _ in range(3)]
    for k, move in enumerate(made):
        rows = which == k
        share = np.clip((time[rows] - (ends[k] - move.duration)) / move.duration, 0.0, 1.0)
        for column, values in zip(columns, move.at(share)):
            column[rows] = values
    return time, *columns
