# SPDX-License-Identifier: MIT
"""The yardstick: change points by E-divisive (Matteson and James, 2014) with a t-test in the place of permutations, each
descriptor by itself and without covariates, as continuous-benchmark tools do it."""

import math

import numpy as np

LEVEL = 0.001  # of each test
FEWEST = 3     # logs on each side


def best_split(values):
    """The split with the largest energy distance between its sides, weighted by their sizes."""
    n = len(values)
    apart = np.abs(values[:, None] - values[None, :])
    rows = np.cumsum(np.cumsum(apart, axis=0), axis=1)
    best, at = 0.0, None
    for k in range(FEWEST, n - FEWEST + 1):
        m = n - k
        within_left, whole = rows[k - 1, k - 1], rows[n - 1, n - 1]
        across = rows[k - 1, n - 1] - within_left
        within_right = whole - within_left - 2 * across
        energy = 2 * across / (k * m) - within_left / max(k * (k - 1), 1) - within_right / max(m * (m - 1), 1)
        score = energy * k * m / n
        if score > best:
            best, at = score, k
    return at


def normal_tail(z):
    return math.erfc(abs(z) / math.sqrt(2))


def t_tail(t, freedom):
    """Two-sided tail of Student's t by Hill's normal approximation."""
    z2 = freedom * math.log1p(t * t / freedom)
    a = freedom - 0.5
    z = math.sqrt(z2 * (1 - 1.5 / (4 * a)) * a / freedom) if a > 0 else 0.0
    return normal_tail(z)


def significant(left, right):
    n, m = len(left), len(right)
    pooled = ((n - 1) * left.var(ddof=1) + (m - 1) * right.var(ddof=1)) / (n + m - 2)
    if pooled <= 0:
        return left.mean() != right.mean()
    return t_tail((left.mean() - right.mean()) / math.sqrt(pooled * (1 / n + 1 / m)), n + m - 2) < LEVEL


def split(values, first, found):
    if len(values) < 2 * FEWEST:
        return
    at = best_split(values)
    if at is None or not significant(values[:at], values[at:]):
        return
    found.append(first + at)
    split(values[:at], first, found)
    split(values[at:], first + at, found)


def changes(lines):
    """{"date", "descriptor"} of each change point of each descriptor."""
    names = [name for name in lines[0] if "_ci95" not in name and isinstance(lines[-1].get(name, ""), (int, float, type(None)))
             and (name == "gear_ratio" or name in lines[0]) and name.split("_")[0] in
             ("gear", "ripple", "coulomb", "viscous", "load", "lost", "inertia", "gravity", "sensor", "noise")
             and name != "load_rms_nm"]
    all_found = []
    for name in names:
        told = [line for line in lines if line[name] is not None]
        found = []
        split(np.array([line[name] for line in told], dtype=float), 0, found)
        all_found += [{"date": told[at]["date"], "descriptor": name} for at in found]
    return all_found
