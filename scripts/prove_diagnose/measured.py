# SPDX-License-Identifier: MIT
"""Angle, speed and acceleration as a log shows them: smoothed by a cubic over a window, for yardsticks and checks."""

import numpy as np


def cubic_weights(half, derivative):
    """Weights of the least-squares cubic through 2 half + 1 samples: its value (0) or slope (1) in the middle."""
    k = np.arange(-half, half + 1.0)
    return np.linalg.pinv(np.vander(k, 4, increasing=True))[derivative]


def smoothed(values, half, derivative):
    ends = np.concatenate([np.full(half, values[0]), values, np.full(half, values[-1])])
    return np.convolve(ends, cubic_weights(half, derivative)[::-1], "valid")


class Measured:
    """Shares its names with joint.Instants: t (s), q (deg), rad, v (deg/s), a (deg/s2)."""

    def __init__(self, log, gear_ratio, window_s=0.05):
        step = log.time_s[1] - log.time_s[0]
        half = round(window_s / step / 2)
        self.t, self.gear_ratio = log.time_s, gear_ratio
        self.v = smoothed(log.velocity_deg_s, half, 0)
        self.a = smoothed(log.velocity_deg_s, half, 1) / step
        steps = (log.velocity_deg_s[1:] + log.velocity_deg_s[:-1]) * step / 2
        self.q = log.position_deg if log.position_deg is not None else np.append(0.0, np.cumsum(steps))
        self.rad = np.radians(self.q)
        self.torque = log.torque_nm


def waves(angle):
    return [np.cos(angle), np.sin(angle)]


def base_columns(m):
    """What the baseline model can say: inertia and two orders of ripple."""
    return np.column_stack([np.radians(m.a), *waves(m.gear_ratio * m.rad), *waves(2 * m.gear_ratio * m.rad)])


def solve(columns, values):
    size = np.sqrt(np.mean(columns**2, axis=0))
    return np.linalg.lstsq(columns / size, values, rcond=None)[0] / size


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def baseline_gap_nm(train, validate):
    """Residual on the validation log of the baseline fitted to the training log, without the tool."""
    return rms(validate.torque - base_columns(validate) @ solve(base_columns(train), train.torque))
