# SPDX-License-Identifier: MIT
"""The baseline beside the tool: forward selection of groups of columns by BIC, each kept if a second log confirms it.

A group is the columns of one name; shapes (widths, time constants, modes) are on a grid, of which the best counts. The noise is taken as
white. Known terms, or the simulation's torque, are always in the fit.
"""

import numpy as np

from .. import joint
from . import cases

WIDTHS = (0.2, 0.4, 0.7, 1.2)  # deg/s, of a friction's step
SMALLEST_SHARE = 1e-9  # of a column's squares that has to be left beside the columns before


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


class Log:
    """Columns of a log under the names that the shared helpers use."""

    def __init__(self, columns, ratio):
        self.t, self.torque, self.ratio = columns["time_s"], columns["torque_nm"], ratio
        step = self.t[1] - self.t[0]
        half = max(2, round(0.025 / step))
        position = columns.get("position_deg")
        raw = np.gradient(position, step) if position is not None else columns["velocity_deg_s"]
        self.v, self.a = smoothed(raw, half, 0), smoothed(raw, half, 1) / step
        self.q = position if position is not None else np.cumsum(self.v) * step
        self.rad, self.step = np.radians(self.q), step
        self.simulated = columns.get(cases.COLUMN)

    def waves(self, order):
        return waves(order * self.ratio * self.rad)


def ripple_gain(log, hertz, damping, order):
    u = order * log.ratio * log.v / 360 / hertz
    return 1 / (1 - u**2 + 2j * damping * u) - 1


def known_columns(log, case, width=0.2):
    """Columns of what the user states; {key: columns}. width: of the Coulomb friction's step."""
    if case.form != "model":
        return {"simulated": [log.simulated]}
    found = {}
    for entry in case.model()["effects"]:
        name, order = entry["effect"], entry.get("order")
        key = name if order is None else f"{name} {order:g}"
        found[key] = {"inertia": [np.radians(log.a)], "gravity": waves(log.rad), "coulomb-friction": [np.tanh(log.v / width)],
                      "viscous-friction": [log.v]}.get(name) or log.waves(order)
    return found


def best_width(log, case):
    """The width of friction's step with which known terms and friction leave least of the log's torque."""
    def rest(width):
        columns = [column for group in known_columns(log, case, width).values() for column in group]
        columns = columns if case.form == "model" else [*columns, np.tanh(log.v / width), log.v]
        return rms(log.torque - np.column_stack(columns) @ fit(columns, log.torque))
    return min(WIDTHS, key=rest)


def filtered(values, time_constant, step):
    """A low-pass of first order."""
    keep, state, found = np.exp(-step / time_constant), values[0], np.empty_like(values)
    for k, value in enumerate(values.tolist()):
        state = value + keep * (state - value)
        found[k] = state
    return found


def dictionary(log, expected, width):
    """[(key, columns)]; several entries of one key are shapes of the same name. expected: the torque of the known terms."""
    sense, load = np.tanh(log.v / width), np.abs(expected)
    ripple = [wave for order in (1, 2) for wave in log.waves(order)]
    found = [(("offset", None), [np.ones_like(log.t)]), (("inertia", None), [np.radians(log.a)]),
             (("gravity", None), waves(log.rad)), (("coulomb-friction", None), [sense]), (("viscous-friction", None), [log.v]),
             (("quadratic-viscous-friction", None), [log.v * np.abs(log.v)]), (("load-friction", None), [load * sense]),
             (("ripple-load-dependence", None), [load * wave for wave in ripple]),
             (("ripple-direction-dependence", None), [sense * wave for wave in ripple]),
             (("ripple-modulation", 1.0), [w * wave for w in waves(log.rad) for wave in ripple]),
             (("delay", None), [np.gradient(expected, log.step)]), (("tone", None), waves(2 * np.pi * 50 * log.t)),
             (("gear-ratio", None), [log.rad * wave for wave in ripple])]
    found += [(("drift", None), [np.expm1(-log.t / tau)]) for tau in (5.0, 15.0, 40.0)]
    found += [(("stribeck-friction", None), [sense * np.exp(-((log.v / slow) ** 2))]) for slow in (4.0, 8.0, 16.0)]
    found += [(("hysteresis", None), [joint.hysteresis(log, {"torque_nm": 1.0, "width_deg": width})]) for width in (0.7, 1.5, 4.0)]
    found += [(("ripple-speed-dependence", None), [np.abs(log.v) ** n * wave for wave in ripple]) for n in (1, 2)]
    found += [(("ripple", float(order)), log.waves(order)) for order in (1, 2, 3, 4, 6)]
    found += [(("output-ripple", float(order)), waves(order * log.rad)) for order in (2, 3, 4)]
    found += [(("lag", None), [filtered(expected, tau, log.step) - expected]) for tau in (0.003, 0.01)]
    for hertz in (15.0, 25.0, 40.0):
        columns = []
        for order in (1, 2):
            gain, (c, s) = ripple_gain(log, hertz, 0.05, order), log.waves(order)
            columns += [gain.real * c - gain.imag * s, gain.real * s + gain.imag * c]
        found.append((("resonance", None), columns))
    return found


class Frame:
    """An orthonormal frame to which columns are added."""

    def __init__(self, count):
        self.columns = np.empty((0, count))

    def less(self, columns):
        """What the frame leaves of the columns, orthonormal; nearly dependent ones are dropped."""
        found = []
        for column in columns:
            whole = column @ column
            for _ in range(2):
                column = column - self.columns.T @ (self.columns @ column)
                for other in found:
                    column = column - other * (other @ column)
            if column @ column > SMALLEST_SHARE * whole:
                found.append(column / np.sqrt(column @ column))
        return np.array(found).reshape(-1, self.columns.shape[1])

    def add(self, parts):
        self.columns = np.vstack([self.columns, parts])


def chosen(known, entries, values, most=8):
    """Indices of the entries that forward selection adds, in order."""
    count, frame, found = len(values), Frame(len(values)), []
    frame.add(frame.less(known))
    rest = values - frame.columns.T @ (frame.columns @ values)
    score = count * np.log(rest @ rest / count)
    while len(found) < most:
        best = None
        for k, (key, columns) in enumerate(entries):
            if key in [entries[n][0] for n in found]:
                continue
            parts = frame.less(columns)
            gain = np.sum((parts @ rest) ** 2)
            fresh = count * np.log(max(rest @ rest - gain, 1e-12) / count) + (len(parts) + 0.5) * np.log(count)
            if len(parts) and (best is None or fresh < best[0]):
                best = (fresh, k, parts)
        if best is None or best[0] >= score:
            break
        score = best[0] - (len(best[2]) + 0.5) * np.log(count)
        rest = rest - best[2].T @ (best[2] @ rest)
        frame.add(best[2])
        found.append(best[1])
    return found


def fit(columns, values):
    return solve(np.column_stack(columns), values)


def names(case, logs):
    """The names that the baseline finds; some 6000 rows are enough for it."""
    ratio = case.given_ratio()
    prepared, width = {}, best_width(Log(logs["train"], ratio), case)
    for purpose, columns in logs.items():
        log = Log(columns, ratio)
        known = [column for group in known_columns(log, case, width).values() for column in group]
        if case.form == "simulated_scale1":
            expected, values, fixed = log.simulated, log.torque - log.simulated, []
        else:
            expected, values, fixed = np.column_stack(known) @ fit(known, log.torque), log.torque, known
        entries = dictionary(log, expected, width)
        listed = known_columns(log, case) if case.form == "model" else {}
        entries = [(key, group) for key, group in entries if (key[0] if key[1] is None else f"{key[0]} {key[1]:g}") not in listed]
        every = max(1, len(log.t) // 6000)
        prepared[purpose] = ([c[::every] for c in fixed], [(key, [c[::every] for c in group]) for key, group in entries], values[::every])
    fixed, entries, values = prepared["train"]
    order = chosen(fixed, entries, values)
    other_fixed, other_entries, other_values = prepared["validate"]
    kept = []
    for k in order:
        rest = [n for n in order if n != k]
        errors = []
        for group in (order, rest):
            own = fixed + [c for n in group for c in entries[n][1]]
            there = other_fixed + [c for n in group for c in other_entries[n][1]]
            error = other_values - (np.column_stack(there) @ fit(own, values) if own else 0.0)
            errors.append(error @ error)
        if errors[0] < errors[1]:
            kept.append(entries[k][0])
    return kept
