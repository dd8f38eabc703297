# SPDX-License-Identifier: MIT
"""Motions of a joint, as position, velocity and acceleration of the output in degrees and seconds, exact at any instant."""

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from prove_diagnose.motion import SMOOTH_STEP, Motion

KINDS = ("sine", "trapezoid", "quintic", "seventh", "steady", "random moves")
SINE = Chebyshev.interpolate(lambda share: (1 - np.cos(np.pi * share)) / 2, 15, domain=[0, 1]).convert(domain=[-1, 1], kind=Polynomial)
# From 0 to 1 while the argument goes there, and the highest slope.
PROFILES = {"quintic": (SMOOTH_STEP, 15 / 8), "seventh": (Polynomial([0, 0, 0, 0, 35, -84, 70, -20]), 35 / 16), "sine": (SINE, np.pi / 2)}


def go(motion, there, peak_speed, profile, ramp):
    """A move from rest to rest; ramp: share of the duration that a trapezoid takes to its speed."""
    span = there - motion.angle_deg
    if profile in PROFILES:
        curve, steepest = PROFILES[profile]
        return motion.append(abs(span) * steepest / peak_speed, motion.angle_deg + span * curve)
    duration, speed = abs(span) / peak_speed / (1 - ramp), np.sign(span) * peak_speed
    for seconds, before, after in ((ramp * duration, 0, speed), ((1 - 2 * ramp) * duration, speed, speed), (ramp * duration, speed, 0)):
        motion.append(seconds, motion.angle_deg + seconds * Polynomial([before, after - before]).integ())
    return motion


def moves(rng, kind, travel, peak_speed, sweeps):
    """The motion of sweeps within the travel (steady runs: at most four speeds, to and fro), and how many speeds."""
    motion = Motion(-travel / 2)
    dwell = rng.choice([0.0, 0.0, rng.uniform(0.05, 1.0)])
    ramp = rng.uniform(0.02, 0.15) if kind == "steady" else rng.uniform(0.05, 0.5)
    speeds = peak_speed * np.exp(-rng.uniform(0.0, 1.5, size=rng.integers(1, 5)))
    speeds[0] = peak_speed
    for k in range(sweeps):
        profile, speed, here = kind, peak_speed, motion.angle_deg
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
        go(motion, there, speed, profile, ramp)
        if dwell:
            motion.rest(dwell)
    return motion, (len(speeds) if kind == "steady" else None)
