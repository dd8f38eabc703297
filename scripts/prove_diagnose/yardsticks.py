# SPDX-License-Identifier: MIT
"""Two methods off the shelf, on the same logs: forward orthogonal regression with BIC, thresholded least squares.

Both choose from a library of columns that holds the catalogue's additive effects and the linear forms of its changes
of the ripple, with shapes (widths, time constants) on a grid. As usual for them they take noise as white. They have no
column for delay, lag, gear ratio, resonance or faults of the converter: that is what such a library cannot say.
"""

import numpy as np

from . import joint, measured, strengths


def friction(m):
    return np.tanh(m.v / 0.2)


def on_ripple(m, factor):
    return [factor * wave for n in (1, 2) for wave in measured.waves(n * m.gear_ratio * m.rad)]


def library(m, inertia_kgm2):
    """[((name, order or None), [columns])]"""
    sense, load = friction(m), np.abs(inertia_kgm2 * np.radians(m.a))
    found = [(("offset", None), [np.ones_like(m.t)]), (("gravity", None), measured.waves(m.rad)),
             (("drift", None), [m.t] + [-np.expm1(-m.t / constant) for constant in (20.0, 60.0)]),
             (("coulomb-friction", None), [sense]), (("viscous-friction", None), [m.v]),
             (("quadratic-viscous-friction", None), [m.v * np.abs(m.v)]), (("load-friction", None), [load * sense]),
             (("stribeck-friction", None), [sense * np.exp(-((m.v / slow) ** 2)) for slow in (5.0, 10.0, 20.0)]),
             (("hysteresis", None), [joint.hysteresis(m, {"torque_nm": 1.0, "width_deg": w}) for w in (1.0, 3.0, 8.0)]),
             (("ripple-speed-dependence", None), on_ripple(m, np.abs(m.v) / 100)),
             (("ripple-load-dependence", None), on_ripple(m, load)),
             (("ripple-direction-dependence", None), on_ripple(m, sense))]
    found += [(("ripple", order), measured.waves(order * m.gear_ratio * m.rad)) for order in (0.5, 3, 4, 5, 6)]
    found += [(("output-ripple", order), measured.waves(order * m.rad)) for order in (2, 3)]
    found += [(("ripple-modulation", k), [column for w in measured.waves(k * m.rad) for column in on_ripple(m, w)])
              for k in (1, 2, 3)]
    return found + [(("tone", None), [w for hertz in (50, 60, 100) for w in measured.waves(2 * np.pi * hertz * m.t)])]


def flat(m, inertia_kgm2):
    entries = library(m, inertia_kgm2)
    owners = [key for key, columns in entries for _ in columns]
    return owners, np.column_stack([column for _, columns in entries for column in columns])


def forward_regression(base, columns, values):
    """FROLS: each step takes the column that explains most once made orthogonal; BIC says when to stop."""
    count = len(values)
    frame = np.linalg.qr(base)[0]
    rest, free = values - frame @ (frame.T @ values), columns - frame @ (frame.T @ columns)
    whole, chosen = np.sum(columns**2, axis=0), []
    best = count * np.log(rest @ rest / count) + base.shape[1] * np.log(count)
    for _ in range(columns.shape[1]):
        energy = np.sum(free**2, axis=0)
        usable = energy > 1e-6 * whole
        gain = np.where(usable, (free.T @ rest) ** 2 / np.where(usable, energy, 1.0), -1.0)
        k = int(np.argmax(gain))
        left = rest @ rest - gain[k]
        score = count * np.log(left / count) + (base.shape[1] + len(chosen) + 1) * np.log(count)
        if gain[k] < 0 or score >= best:
            break
        best = score
        chosen.append(k)
        unit = free[:, k] / np.sqrt(energy[k])
        rest = rest - unit * (unit @ rest)
        free = free - np.outer(unit, unit @ free)
    return chosen


def thresholded(base, columns, values, threshold_nm):
    """STLSQ: least squares again and again without the columns whose contribution is below the threshold in rms."""
    everything = np.column_stack([base, columns])
    everything = everything / np.sqrt(np.mean(everything**2, axis=0))
    square, right = everything.T @ everything, everything.T @ values
    always = np.arange(everything.shape[1]) < base.shape[1]
    active = np.ones(everything.shape[1], bool)
    for _ in range(30):
        part = np.ix_(active, active)
        weights = np.zeros(len(active))
        weights[active] = np.linalg.solve(square[part] + 0.05 * np.eye(active.sum()), right[active])
        again = always | (active & (np.abs(weights) > threshold_nm))
        if np.array_equal(again, active):
            break
        active = again
    return np.flatnonzero(active[base.shape[1]:]).tolist()


METHODS = {
    "FROLS": lambda base, columns, values: forward_regression(base, columns, values),
    "STLSQ": lambda base, columns, values: thresholded(base, columns, values, 0.1 * strengths.TORQUE_NOISE_NM),
    "STLSQ 1σ": lambda base, columns, values: thresholded(base, columns, values, strengths.TORQUE_NOISE_NM),
}


def judge(train, validate):
    """{method: (names found, residual on the validation log in Nm)}"""
    base, base_validate = measured.base_columns(train), measured.base_columns(validate)
    inertia = measured.solve(base, train.torque)[0]
    (owners, columns), (_, columns_validate) = flat(train, inertia), flat(validate, inertia)
    found = {}
    for method, choose in METHODS.items():
        chosen = choose(base, columns, train.torque)
        weights = measured.solve(np.column_stack([base, columns[:, chosen]]), train.torque)
        rest = validate.torque - np.column_stack([base_validate, columns_validate[:, chosen]]) @ weights
        found[method] = ({owners[k] for k in chosen}, measured.rms(rest))
    return found
