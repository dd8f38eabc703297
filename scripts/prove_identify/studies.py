# SPDX-License-Identifier: MIT
"""What one simulated log says about false lines and the gear ratio: one row of a table each."""

import numpy as np

from . import answer, logs


def about(log):
    """What tables are grouped by."""
    truth = log.truth
    return {key: truth[key] for key in ("seed", "motion", "rate_hz", "travel_deg", "ratio", "colour", "position", "sweeps", "rows", "folded", "ripple")}


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


def is_gear(value, ratio):
    """Within 1 % of either comb: of N, or of N + 1 where the other spline is held."""
    return any(abs(value / comb - 1.0) <= 0.01 for comb in (ratio, ratio + 1))


def false_lines(log, found):
    """How many reported lines lie at none of the log's; None where lines fold at half the sample rate."""
    def true(seen):
        return any(abs(seen["order_output"] - line["order"]) <= resolution(log, line["order"]) for line in log.truth["lines"])
    return None if log.truth["folded"] else sum(
        seen["order_output"] is not None and not (is_known_tone(seen, log) or is_gravity(seen, log) or true(seen)) for seen in found.lines)


def ratio(seed, options):
    log = logs.draw(seed, ripple="two combs" if seed % 2 else "one comb")
    row, truth, text = about(log), log.truth, log.csv()
    try:
        found = answer.identify(options.program, text)
    except answer.Failed as failure:
        return {**row, "outcome": "failed", "why": str(failure)}, log, [text]
    # What least squares sees ten times over, in 4 cycles per sweep or more and below half the sample rate, should be found.
    errors = logs.standard_errors(log, [line["order"] for line in truth["lines"]])
    visible = sum(line["nm"] > 10 * error and line["order"] * truth["travel_deg"] >= 4 * 360.0 for line, error in zip(truth["lines"], errors))
    row |= {"verdict": found.verdict, "seconds": found.seconds, "conclusive": found.conclusive, "value": found.ratio,
            "interval": found.interval, "false_lines": false_lines(log, found), "visible": visible}
    if found.rivals:
        row |= {"probability": found.rivals[0][0], "probable": is_gear(found.rivals[0][1], truth["ratio"])}
    if found.ratio is None:
        row["outcome"] = "missed" if found.says_nothing() else "cannot tell"
        return row, log, [text] if row["outcome"] == "missed" and visible and not truth["folded"] else []
    right = is_gear(found.ratio, truth["ratio"])
    row |= {"outcome": ("right" if right else "wrong") if found.conclusive else "cannot tell", "right": right}
    if found.interval:
        low, high = found.interval
        row["covers"] = low <= truth["ratio"] <= high or (row["ripple"] == "two combs" and low <= truth["ratio"] + 1 <= high)
    wrong = row["outcome"] == "wrong" or right and not row.get("covers")
    return row, log, [text] if wrong or row["false_lines"] else []
