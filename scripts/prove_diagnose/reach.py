# SPDX-License-Identifier: MIT
"""Is what a diagnosis calls unexplained where the hidden effect is?

The hidden torque is known: the log with it less the same log without. What the baseline takes up of it cannot be
seen and is taken off. Counted is the share of its energy in the places that were told: in stretches of time, ranges of
position or speed in one direction, or in the line of a tone or an order.
"""

import numpy as np

from . import measured

ENOUGH = 0.5  # of the energy


def hidden_torque(log, plain):
    """What the hidden effect leaves beside a fitted baseline, and the motion that goes with it. log, plain: cases.Log."""
    motion = measured.Measured(log, 100)
    extra = log.torque_nm - plain.torque_nm
    base = measured.base_columns(motion)
    return motion, extra - base @ measured.solve(base, extra)


def within(values, spans):
    inside = np.zeros(len(values), bool)
    for low, high in spans:
        inside |= (values >= low) & (values <= high)
    return inside


def rows_told(entry, motion):
    """The rows that an entry of `unexplained` tells, by what its kind is about."""
    where = entry["where"]
    values, spans = {"time": (motion.t, where["time_s"]), "position": (motion.q, where["position_deg"]),
                     "speed": (motion.v, where["speed_deg_s"])}.get(entry["kind"], (motion.t, []))
    told = within(values, spans)
    sense = {"positive": motion.v > 0, "negative": motion.v < 0}.get(where["direction"])
    return told if sense is None or entry["kind"] == "time" else told & sense


def share_of_lines(entries, motion, extra):
    """Share of the hidden energy in the tones and orders told, all fitted at once."""
    cycles = [f * motion.t for entry in entries for f in entry["where"]["hz"]]
    cycles += [n * motion.gear_ratio * motion.q / 360.0 for entry in entries for n in entry["where"]["order"]]
    if not cycles:
        return 0.0
    columns = np.column_stack([wave for cycle in cycles[:40] for wave in measured.waves(2 * np.pi * cycle)])
    left = extra - columns @ np.linalg.lstsq(columns, extra, rcond=None)[0]
    return 1.0 - float(np.sum(left**2) / np.sum(extra**2))


def share_told(entries, log, plain):
    """Share of the hidden energy at the places told, 0 to 1."""
    motion, extra = hidden_torque(log, plain)
    told = np.zeros(len(extra), bool)
    for entry in entries:
        told |= rows_told(entry, motion)
    inside = float(np.sum(extra[told] ** 2) / np.sum(extra**2))
    return max(inside, share_of_lines(entries, motion, extra))
