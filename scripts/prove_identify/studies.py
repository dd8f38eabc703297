# SPDX-License-Identifier: MIT
"""What one log says about false lines, the bound of "no line above X", and the gear ratio: one row of a table each."""

import math

import numpy as np

from . import answer, logs


def about(log):
    """What tables are grouped by."""
    truth = log.truth
    return {key: truth[key] for key in ("seed", "motion", "rate_hz", "travel_deg", "ratio", "colour", "position", "sweeps",
                                        "speeds", "rows", "folded", "ripple")}


def is_known_tone(line, log):
    """Whether a line lies at one of the log's tones, within 1 % or three resolutions of the log."""
    hz = line.get("hz")
    width = 3.0 / log.truth["duration_s"]
    return hz is not None and any(abs(hz - tone["hz"]) <= max(width, 0.01 * tone["hz"]) for tone in log.truth["tones"])


def is_gravity(line, log):
    """Gravity is a line of order 1 where the joint turns several times."""
    return line["order_output"] is not None and abs(line["order_output"] - 1.0) <= resolution(log, 1.0) and log.truth["travel_deg"] > 720


def outcome_of_noise(log, found):
    turning = [line for line in found.lines if not is_known_tone(line, log)]
    if turning:
        return "gravity" if all(is_gravity(line, log) for line in turning) else "false line"
    if found.lines:
        return "tone as unknown"
    if any(not is_known_tone(line, log) for line in found.tones):
        return "false tone"
    return "nothing" if found.says_nothing() else "cannot tell"


def noise(seed, options):
    log = logs.draw(seed)
    row = about(log)
    try:
        found = answer.identify(options.program, log.csv())
    except answer.Failed as failure:
        return {**row, "outcome": "failed", "why": str(failure)}, log, []
    row |= {"outcome": outcome_of_noise(log, found), "verdict": found.verdict, "seconds": found.seconds}
    return row, log, [] if row["outcome"] not in ("false line", "false tone") else [log.csv()]


def resolution(log, order):
    """Half the width in which a line counts as that order: 1.5 cycles per sweep, or 1 %."""
    return max(1.5 * 360.0 / log.truth["travel_deg"], 0.01 * order)


def injection(seed, options):
    log = logs.draw(seed)
    row = about(log)
    try:
        before = answer.identify(options.program, log.csv())
    except answer.Failed as failure:
        return {**row, "outcome": "failed", "why": str(failure)}, log, []
    bound = before.bound_nm()
    row |= {"verdict": before.verdict, "seconds": before.seconds, "bound_nm": bound}
    if not before.says_nothing() or bound is None:
        return {**row, "outcome": outcome_of_noise(log, before) if not before.says_nothing() else "no bound"}, log, []
    low, high = before.searched() or logs.expected_range(log)
    low, high = options.lowest_order or low, options.highest_order or high
    row |= {"lowest": low, "highest": high}
    if not low < high:
        return {**row, "outcome": "no range"}, log, []
    rng = np.random.default_rng([seed, 484])
    order = logs.log_uniform(rng, low, high)
    wave = np.cos(np.radians(order * log.angle) + rng.uniform(0, 2 * math.pi))
    # One bound is stated for all orders: it cannot be below what the worst of them allows.
    error, *others = logs.standard_errors(log, [order, *np.geomspace(low, high, 8)])
    kept = []
    row |= {"outcome": "tried", "order": order, "cycles_per_sweep": order * log.truth["travel_deg"] / 360.0,
            "share_of_nyquist": order * log.truth["peak_deg_s"] / 180.0 / log.truth["rate_hz"],
            "angle_error_cycles": order * logs.walk_deg(log) / 360.0, "standard_error_nm": error, "bound_in_errors": bound / error,
            "bound_in_largest": bound / max(error, *others)}
    for times in (2, 1):
        text = log.csv(times * bound * wave)
        try:
            after = answer.identify(options.program, text)
        except answer.Failed as failure:
            return {**row, "outcome": "failed", "why": str(failure)}, log, [text]
        row[f"found_{times}x"] = after.has_order(order, resolution(log, order))
        row[f"nothing_{times}x"] = after.says_nothing()
        row[f"bound_{times}x"], row[f"verdict_{times}x"] = after.bound_nm(), after.verdict
        if times == 2 and not row["found_2x"]:
            kept = [text]
    return row, log, kept


def multiple_of(value, ratio):
    """"right", "multiple" for k times or a k-th of the truth, "other"."""
    if abs(value / ratio - 1.0) <= 0.01:
        return "right"
    for high in range(1, 13):
        for low in range(1, 13):
            if abs(value / (ratio * high / low) - 1.0) <= 0.01 / max(high, low) and (low <= 2 or high <= 2):
                return "multiple"
    return "other"


def lines_of(log, found):
    """One row for each true line, and how many reported ones lie at none (None where lines fold at half the sample rate)."""
    truth, made = log.truth, []
    errors = logs.standard_errors(log, [line["order"] for line in truth["lines"]])
    for line, error in zip(truth["lines"], errors):
        order, width = line["order"], resolution(log, line["order"])
        near = [seen for seen in found.lines if seen["order_output"] and abs(seen["order_output"] - order) <= width]
        apart = min([abs(other["order"] - order) for other in truth["lines"] if other is not line], default=math.inf)
        made.append({"strength": line["nm"] / error, "found": found.has_order(order, width),
                     "cycles_per_sweep": order * truth["travel_deg"] / 360.0, "second": line["comb"] == "second",
                     "alone": apart > 3 * 360.0 / truth["travel_deg"] and not line["slope"],
                     "size": near[0]["amplitude_nm"] / line["nm"] if len(near) == 1 and near[0]["amplitude_nm"] else None})
    if truth["folded"]:
        return made, None
    return made, sum(not is_known_tone(seen, log) and not is_gravity(seen, log) and seen["order_output"] is not None and
                     not any(abs(seen["order_output"] - line["order"]) <= resolution(log, line["order"]) for line in truth["lines"])
                     for seen in found.lines)


def ratio(seed, options):
    log = logs.draw(seed, ripple="two combs" if seed % 2 else "one comb")
    row, truth, text = about(log), log.truth, log.csv()
    orders = [line["n"] for line in truth["lines"] if line["comb"] == "first"]
    try:
        found = answer.identify(options.program, text)
    except answer.Failed as failure:
        return {**row, "outcome": "failed", "why": str(failure)}, log, [text]
    true_lines, false_lines = lines_of(log, found)
    # What least squares sees ten times over, in 4 cycles per sweep or more and below half the sample rate, should be found.
    visible = [line for line in true_lines if line["strength"] > 10 and line["cycles_per_sweep"] >= 4]
    row |= {"verdict": found.verdict, "seconds": found.seconds, "conclusive": found.conclusive, "value": found.ratio,
            "interval": found.interval, "lines": true_lines, "false_lines": false_lines, "visible": len(visible),
            "strength": max(line["strength"] for line in true_lines),
            "identifiable": math.gcd(*orders) == 1 and len(orders) > 1 and len(visible) == len(true_lines)}
    if found.ratio is None:
        row["outcome"] = "missed" if found.says_nothing() else "cannot tell"
        return row, log, [text] if row["outcome"] == "missed" and visible and not truth["folded"] else []
    match = multiple_of(found.ratio, truth["ratio"])
    nearer = abs(found.ratio - truth["ratio"] - 1) < abs(found.ratio - truth["ratio"])
    if row["ripple"] == "two combs" and nearer and multiple_of(found.ratio, truth["ratio"] + 1) == "right":
        match = "other comb"
    row |= {"outcome": match if found.conclusive else "cannot tell", "match": match}
    if found.interval:
        low, high = found.interval
        row["covers"] = low <= truth["ratio"] <= high
        row["covers_either"] = row["covers"] or (row["ripple"] == "two combs" and low <= truth["ratio"] + 1 <= high)
    wrong = found.conclusive and match != "right" or match == "right" and not row.get("covers")
    return row, log, [text] if wrong or false_lines else []
