# SPDX-License-Identifier: MIT
"""Lines put into windows of real and into simulated logs where nothing is, and real windows whose lines were taken off."""

import math

import numpy as np

from . import answer, logs, own_spectrum, real

STRENGTHS = (3, 5, 7, 10, 14, 20)  # standard errors
ALARM = 0.01


def drawn(seed, options, simulated=False):
    """(random generator, a window, what a row says of it); whole logs, both lengths, and simulated logs take turns."""
    rng = np.random.default_rng([seed, 65])
    lengths = (*real.WINDOWS_S, "simulated") if simulated else real.WINDOWS_S
    length = lengths[seed % len(lengths)]
    if length == "simulated":
        window = real.of(logs.draw(seed))
    else:
        chosen = [window for window in real.windows(options.logs) if window.length == length]
        window = chosen[rng.integers(len(chosen))]
    name = "whole" if length is None else f"{length:g} s" if isinstance(length, float) else length
    return rng, window, {"seed": seed, "log": window.log, "window": window.name(), "length": name}


def empty_orders(spectrum, evidence, ratio):
    """Orders without anything of their own within 2.5 cells, away from the multiples that a gear of this ratio would have."""
    near = max(1, int(2.5 / spectrum.span / spectrum.step))
    loudest = np.lib.stride_tricks.sliding_window_view(np.pad(evidence, near, mode="edge"), 2 * near + 1).max(axis=1)
    free = spectrum.searched & (loudest < 5.0) & (spectrum.orders < min(2000.0, 0.95 * spectrum.highest))
    for n in range(1, 13) if ratio else ():
        for comb in (ratio, ratio + 1):
            free &= np.abs(spectrum.orders - n * comb) > 3.0 / spectrum.span
    return np.flatnonzero(free)


def power(seed, options):
    """Which of lines of several standard errors, and of the bound that the window alone states, are found at an order of it."""
    rng, window, row = drawn(seed, options, simulated=True)
    spectrum = own_spectrum.Spectrum(window.torque, window.turns, own_spectrum.runs(window.time, window.turns))
    if not spectrum.usable():
        return {**row, "outcome": "no sweep"}, window, []
    evidence, errors = spectrum.looked_at()
    free = empty_orders(spectrum, evidence, window.ratio)
    if not len(free):
        return {**row, "outcome": "no empty order"}, window, []
    weights = 1.0 / spectrum.orders[free]
    k = rng.choice(free, p=weights / weights.sum())
    order, error = float(spectrum.orders[k]), float(errors[k])
    width = max(1.5 / spectrum.span, 0.01 * order)
    wave = np.cos(2 * math.pi * order * window.turns + rng.uniform(0, 2 * math.pi))
    try:
        before = answer.identify(options.program, window.csv())
        bound = before.bound_at(order)
        # Least squares with a known noise sees it at this rate of false alarms: above the threshold in 95 of 100.
        least = math.sqrt(2 * math.log(spectrum.cells() / ALARM)) + 1.645
        row |= {"outcome": "line before" if before.near(order, width) else "tried", "order": order, "standard_error_nm": error,
                "bound_in_errors": bound / error if bound else math.inf, "bound_in_least": bound / error / least if bound else math.inf}
        missed = []
        sizes = {str(times): times * error for times in STRENGTHS} | ({"X": bound} if bound else {})
        for name, size in sizes.items() if row["outcome"] == "tried" else ():
            text = window.csv(window.torque + size * wave)
            line = answer.identify(options.program, text).near(order, width)
            row[f"found_{name}"] = bool(line)
            if name == "20" and line:
                row["amplitude"] = line["amplitude_nm"] / size
            if name in ("14", "20", "X") and not row[f"found_{name}"]:
                missed.append(text)
    except answer.Failed as failure:
        return {**row, "outcome": "failed", "why": str(failure)}, window, []
    return row, window, missed


def stretched(seed, options):
    """What is found in a window without its lines, after each sweep's motion was stretched by a factor of its own."""
    rng, window, row = drawn(seed, options)
    rows = own_spectrum.runs(window.time, window.turns)
    if not rows:
        return {**row, "outcome": "no sweep"}, window, []
    borders = [0, *((rows[k][1] + rows[k + 1][0]) // 2 for k in range(len(rows) - 1)), len(window.time)]
    stretch = np.repeat(np.exp(rng.uniform(-0.2, 0.2, len(rows))), np.diff(borders))
    torque = own_spectrum.without_lines(window.time, window.torque, window.turns)
    if torque is None:
        return {**row, "outcome": "motion left"}, window, []
    text = window.csv(torque, stretch)
    try:
        found = answer.identify(options.program, text)
    except answer.Failed as failure:
        return {**row, "outcome": "failed", "why": str(failure)}, window, [text]
    row |= {"outcome": "false line" if found.lines else "false tone" if found.tones else "nothing" if found.says_nothing() else "cannot tell",
            "sweeps": len(rows), "verdict": found.verdict}
    return row, window, [text] if found.lines else []
