# SPDX-License-Identifier: MIT
"""What counts as right: a diagnosis against the truth of its case.

A finding is a name and, where the name is that of a line, its order: ripple of order 3 is not ripple of order 4.
"""

import math

from . import joint

ORDER = {"ripple": "order", "output-ripple": "order", "ripple-modulation": "output_order",
         "position-dependent-friction": "order", "encoder-eccentricity": "order"}
# Shapes that a log of motion hardly tells, and what says which line is meant, are not counted as parameters.
UNCOUNTED = ("effect", "width_deg_s", "order", "output_order", "held", "milliseconds", "initial_state", "ramp_s")


def value_of(parameter):
    return parameter["value"] if isinstance(parameter, dict) else parameter


def key(effect, parameters):
    order = parameters.get(ORDER.get(effect))
    return (effect, None if order is None else round(value_of(order), 2))


def words(keys):
    """Findings as people write them: 'ripple 3'."""
    return sorted(effect if order is None else f"{effect} {order:g}" for effect, order in keys)


def truth_keys(hidden):
    return {key(e["effect"], e) for e in hidden}


def named_keys(found):
    """The confirmed findings, each with its order. `named` says which; rounds and faults say of what order."""
    entries = [entry for entry in found["rounds"] if entry["status"] == "confirmed"] + found.get("faults", [])
    keys = {key(entry["effect"], entry["parameters"]): entry for entry in entries}
    if {effect for effect, _ in keys} != set(found["named"]):
        raise ValueError(f"named {found['named']} and the confirmed rounds {words(keys)} disagree")
    return keys


def undecided_names(found):
    names = {name for entry in found["ambiguous"] for name in entry["effects"]}
    return names | {entry["effect"] for entry in found["rounds"] if entry["status"] in ("ambiguous",)}


def names(hidden, found):
    """exact, in_set, false names."""
    named, undecided = set(named_keys(found)), undecided_names(found)
    truth = truth_keys(hidden)
    false = named - truth
    in_set = not false and all(k in named or k[0] in undecided for k in truth)
    return {"exact": named == truth, "in_set": in_set, "false": words(false), "named": words(named)}


def true_parameters(effect, seconds):
    if effect["effect"] == "dropout":
        low, high = effect["milliseconds"]
        return {"rate_hz": effect["held"] / seconds, "duration_s": (low + high) / 2000}
    found = {name: value for name, value in effect.items() if name not in UNCOUNTED}
    if effect.get("time_constant_s", 0.0) >= 1e5:  # a straight line: any longer constant is as right
        del found["time_constant_s"]
    return found


def beyond(interval, value, error):
    """The error in units of the interval's half on its side: up to 1 it holds the truth. None without interval."""
    if not interval or None in interval:
        return None
    half = value - interval[0] if error > 0 else interval[1] - value
    return abs(error) / half if half > 0 else math.inf


def parameters(hidden, found, seconds):
    """For each parameter of each effect that was named rightly: relative error, and whether its interval holds it."""
    rows, named = [], named_keys(found)
    for effect in hidden:
        entry = named.get(key(effect["effect"], effect))
        given = entry["parameters"] if entry else {}
        given = {name: v if isinstance(v, dict) else {"value": v} for name, v in given.items()}
        for name, true in true_parameters(effect, seconds).items():
            if name not in given:
                continue
            error = given[name]["value"] - true
            if name == "phase_deg":
                error = (error + 180.0) % 360.0 - 180.0
            rows.append({"parameter": f"{effect['effect']}.{name}",
                         "beyond": beyond(given[name].get("ci95"), given[name]["value"], error),
                         "relative": None if name == "phase_deg" else abs(error / true)})
    return rows


def place(case, span, found):
    """Is something remaining reported where the disturbance is? A place far wider than the disturbance is none."""
    left = found["remaining"]
    if not left:
        return False
    if span[1] - span[0] > case.seconds / 2:
        return True
    widest = max(2.0, 4.0 * (span[1] - span[0]))
    low, high = left["where"]
    return left["kind"] == "time" and low < span[1] + 0.25 and high > span[0] - 0.25 and high - low <= widest


def share_closed(before_nm, after_nm, floor_nm):
    """Share of the explainable gap that is gone; None where nothing, or next to nothing, can be explained."""
    explainable = before_nm**2 - floor_nm**2
    return (before_nm**2 - after_nm**2) / explainable if explainable > 0.1 * floor_nm**2 else None


def explainable(hidden):
    return not any(e["effect"] in ("quantization", *joint.CHANCE) for e in hidden)
