# SPDX-License-Identifier: MIT
"""What is logged: noise of three kinds, and the faults of a converter."""

import numpy as np

NOISES = ("white", "ar0.5", "t4")


def noise(rng, kind, count, rms):
    """white: normal; ar0.5: each value remembers half of the one before; t4: heavy tails (Student, 4 degrees)."""
    if kind == "t4":
        return rms * rng.standard_t(4, count) / np.sqrt(2.0)
    fresh = rng.standard_normal(count + 100)
    if kind == "ar0.5":
        weights = 0.5 ** np.arange(60)
        fresh = np.convolve(fresh, weights)[: len(fresh)] * np.sqrt(1 - 0.25)
    return rms * fresh[100:]


def saturation(values, e, rng):
    return np.clip(values, -e["limit_nm"], e["limit_nm"])


def quantization(values, e, rng):
    return e["step_nm"] * np.floor(values / e["step_nm"] + 0.5)


def spikes(values, e, rng):
    hit = rng.random(len(values)) < e["rate_percent"] / 100
    return values + np.where(hit, e["size_nm"] * rng.choice([-1.0, 1.0], len(values)), 0.0)


def dropout(values, e, rng):
    """held: number of stretches; each has a length of its own between the two of milliseconds."""
    values = values.copy()
    for start in rng.choice(len(values) - 400, e["held"], replace=False):
        length = int(rng.uniform(*e["milliseconds"]))
        values[start : start + length] = values[start]
    return values


CONVERTER = {"saturation": saturation, "quantization": quantization, "spikes": spikes, "dropout": dropout}


def convert(values, truth, rng):
    for e in truth:
        if e["effect"] in CONVERTER:
            values = CONVERTER[e["effect"]](values, e, rng)
    return values
