# SPDX-License-Identifier: MIT
"""What no effect of the catalogue is: each draws a torque over a log and says where in time it lies."""

import numpy as np


def contact(rng, time_s):
    """Something is touched once: half a sine of 0.25 to 0.5 s."""
    length = rng.uniform(0.25, 0.5)
    start = rng.uniform(2.0, time_s[-1] - 2.0)
    share = (time_s - start) / length
    bump = np.where((share > 0) & (share < 1), np.sin(np.pi * np.clip(share, 0, 1)), 0.0)
    return rng.choice([-1.0, 1.0]) * rng.uniform(0.8, 2.0) * bump, (start, start + length)


def burst(rng, time_s):
    """One to two seconds of louder noise."""
    length = rng.uniform(1.0, 2.0)
    start = rng.uniform(2.0, time_s[-1] - 3.0)
    inside = (time_s >= start) & (time_s < start + length)
    return np.where(inside, rng.uniform(0.3, 0.5) * rng.standard_normal(len(time_s)), 0.0), (start, start + length)


def wander(rng, time_s):
    """The zero strolls at random: two poles of half a second to two, 0.15 to 0.3 Nm rms, all over the log."""
    rate = np.exp(-(time_s[1] - time_s[0]) / rng.uniform(0.5, 2.0))
    once = twice = 0.0
    walk = np.empty(len(time_s))
    for k, fresh in enumerate(rng.standard_normal(len(time_s)).tolist()):
        once = rate * once + fresh
        twice = rate * twice + once
        walk[k] = twice
    walk -= walk.mean()
    return rng.uniform(0.15, 0.3) * walk / walk.std(), (time_s[0], time_s[-1])


DISTURBANCES = {"contact pulse": contact, "noise burst": burst, "random wander": wander}
