# SPDX-License-Identifier: MIT
"""What the baseline computes with: smoothing by a cubic over a window, waves, least squares."""

import numpy as np


def cubic_weights(half, derivative):
    """Weights of the least-squares cubic through 2 half + 1 samples: its value (0) or slope (1) in the middle."""
    k = np.arange(-half, half + 1.0)
    return np.linalg.pinv(np.vander(k, 4, increasing=True))[derivative]


def smoothed(values, half, derivative):
    ends = np.concatenate([np.full(half, values[0]), values, np.full(half, values[-1])])
    return np.convolve(ends, cubic_weights(half, derivative)[::-1], "valid")


def waves(angle):
    return [np.cos(angle), np.sin(angle)]


def solve(columns, values):
    size = np.sqrt(np.mean(columns**2, axis=0))
    return np.linalg.lstsq(columns / size, values, rcond=None)[0] / size


def rms(values):
    return float(np.sqrt(np.mean(values**2)))
