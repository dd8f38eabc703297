# SPDX-License-Identifier: MIT
"""What loggers and drives of less care do to a log, and gears that are soft: `prove-diagnose --physics --rough`.

Every log gets the velocity filter of its drive, half of them stamps that jitter, half lost rows, and half of the joints a soft gear.
Nothing of it is an effect that has to be named.
"""

import math

import numpy as np

from . import plant as plants

FILTER_HZ = (80.0, 300.0)  # of the velocity, log-uniform
JITTER = (0.02, 0.3)  # deviation of a stamp, of the period
LOST = 0.01  # of the rows, in runs of one to five
SOFT_MODE_HZ = (18.0, 40.0)  # of the link on its flexspline


def softened(rng, plant):
    """Whether the joint got a soft gear, and a loop that does not excite it; half of them do."""
    if rng.random() < 0.5:
        return False
    mode = rng.uniform(*SOFT_MODE_HZ)
    plant.parameters |= plants.spring(plant.parameters, mode) | plants.controller(plant.parameters, mode / 4)
    return True


def recorded(rng, columns, rate_hz):
    """Columns of a log as a careless logger leaves them."""
    corner = math.exp(rng.uniform(*np.log(FILTER_HZ)))
    keep, raw = math.exp(-2 * math.pi * corner / rate_hz), columns["velocity_deg_s"]
    filtered, state = np.empty_like(raw), raw[0]
    for k, value in enumerate(raw.tolist()):
        state = value + keep * (state - value)
        filtered[k] = state
    columns = columns | {"velocity_deg_s": filtered}
    if rng.random() < 0.5:
        jitter = rng.uniform(*JITTER) / rate_hz * rng.standard_normal(len(raw))
        columns["time_s"] = np.maximum.accumulate(columns["time_s"] + jitter) + 1e-9 * np.arange(len(raw))
    if rng.random() < 0.5:
        kept = np.ones(len(raw), bool)
        for at in rng.choice(len(raw) - 6, round(LOST * len(raw) / 3), replace=False) + 1:
            kept[at : at + rng.integers(1, 6)] = False
        columns = {name: values[kept] for name, values in columns.items()}
    return columns
