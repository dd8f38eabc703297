# SPDX-License-Identifier: MIT
"""What is logged: noise of many kinds, and the faults of a converter."""

import numpy as np

MEMORIES = {"ar0.5": 0.5, "ar0.9": 0.9, "ar0.98": 0.98}  # share of a value that the next sample remembers
NOISES = ("white", *MEMORIES, "pink", "t4", "mixture")


def pink(rng, count):
    """Power in inverse proportion to frequency; cut from a stretch four times as long, so that its ends do not meet."""
    length = 1 << (4 * count - 1).bit_length()
    spectrum = np.fft.rfft(rng.standard_normal(length))
    spectrum[0] = 0.0
    spectrum[1:] /= np.sqrt(np.arange(1, len(spectrum)))
    whole = np.fft.irfft(spectrum, length)
    first = rng.integers(0, length - count)
    return (whole / whole.std())[first : first + count]


def mixture(rng, count):
    """White, remembering, pink and heavy-tailed noise at once, in shares of the power that are drawn."""
    shares = rng.dirichlet(np.ones(4))
    parts = [noise(rng, kind, count, 1.0) for kind in ("white", "ar0.9", "pink", "t4")]
    return sum(np.sqrt(share) * part for share, part in zip(shares, parts))


def remembering(fresh, memory):
    weights = memory ** np.arange(round(30 / (1 - memory)))
    return np.convolve(fresh, weights)[: len(fresh)] * np.sqrt(1 - memory**2)


def noise(rng, kind, count, rms):
    """white: normal; ar0.5: each value remembers half of the one before; t4: heavy tails (Student, 4 degrees)."""
    if kind == "t4":
        return rms * rng.standard_t(4, count) / np.sqrt(2.0)
    if kind in ("pink", "mixture"):
        return rms * (pink if kind == "pink" else mixture)(rng, count)
    memory = MEMORIES.get(kind, 0.0)
    settled = max(100, round(30 / (1 - memory))) if memory else 100
    fresh = rng.standard_normal(count + settled)
    return rms * (remembering(fresh, memory) if memory else fresh)[settled:]


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
