# SPDX-License-Identifier: MIT
"""Tables of the studies, in Markdown: one row for all logs, and one for each class of them."""

import bisect
import math
import statistics

import page_tables


def share(count, total):
    return f"{100.0 * count / total:.1f} %" if total else "-"


def banded(edges, unit):
    def name(value):
        k = bisect.bisect_right(edges, value)
        if k == 0:
            return f"below {edges[0]}{unit}"
        return f"{edges[k - 1]}{unit} and more" if k == len(edges) else f"{edges[k - 1]} to {edges[k]}{unit}"
    return name


def rank(edges):
    return lambda value: bisect.bisect_right(edges, value)


TRAVEL, RATIO, RATE, CYCLES, STRENGTH = (40, 90, 180, 360), (3, 10, 30, 100), (100, 500), (4, 6, 10, 30, 100), (3, 6, 10, 30)
# Name of the class and the order in which classes are listed, from a row; None leaves the row out.
CLASSES = {
    "travel": lambda row: (rank(TRAVEL)(row["travel_deg"]), banded(TRAVEL, " deg")(row["travel_deg"])),
    "ratio": lambda row: (rank(RATIO)(row["ratio"]), banded(RATIO, "")(row["ratio"])),
    "sample rate": lambda row: (rank(RATE)(row["rate_hz"]), banded(RATE, " Hz")(row["rate_hz"])),
    "motion": lambda row: (0, motion_name(row)),
    "noise": lambda row: (0, row["colour"]),
    "position": lambda row: (0, "with position" if row["position"] else "velocity only"),
    "cycles per sweep": lambda row: "cycles_per_sweep" in row and (rank(CYCLES)(row["cycles_per_sweep"]),
                                                                  banded(CYCLES, " cycles")(row["cycles_per_sweep"])),
    "half the sample rate": lambda row: "share_of_nyquist" in row and (
        row["share_of_nyquist"] > 1, "above half the rate at the fastest" if row["share_of_nyquist"] > 1 else "below half the rate"),
    "ripple": lambda row: (0, row["ripple"] + (", folded" if row["folded"] else "")),
    "strength": lambda row: "strength" in row and (rank(STRENGTH)(row["strength"]),
                                                   banded(STRENGTH, " standard errors")(row["strength"])),
    "multiples": lambda row: "identifiable" in row and (0, "n without common divisor, all visible" if row["identifiable"]
                                                        else "n all even, one n, or lines too weak"),
    "visible lines": lambda row: "visible" in row and (row["visible"] > 0, f"{min(2, row['visible'])}{' or more' if row['visible'] > 1 else ''}"),
    "angle": lambda row: "angle_error_cycles" in row and (0, "known" if row["angle_error_cycles"] < 0.1 else "hidden by the noise of the velocity"),
}


def motion_name(row):
    return row["motion"] if row["motion"] != "steady" else f"steady, {'1 speed' if row['speeds'] == 1 else '2 to 4 speeds'}"


def grouped(rows, classes):
    yield "all", rows
    for name in classes:
        found = {}
        for row in rows:
            key = CLASSES[name](row)
            if key:
                found.setdefault(key, []).append(row)
        for key in sorted(found):
            yield f"{name}: {key[1]}", found[key]


def markdown(heads, body):
    return "\n".join(["| " + " | ".join(heads) + " |", "| " + " | ".join(["---"] + ["---:"] * (len(heads) - 1)) + " |"] +
                     ["| " + " | ".join(row) + " |" for row in body]) + "\n"


def shown(name, caption, heads, body, classes=(), left_out=()):
    """For the page: the line of all logs and those of `classes`, without the columns `left_out`; everything in a file.
    A line alone is a sentence."""
    kept = [k for k, head in enumerate(heads) if head not in left_out]
    lines = [[line[k] for k in kept] for line in body if line[0].partition(": ")[0] in ("all", *classes)]
    short = page_tables.units_in_head(markdown([heads[k] for k in kept], lines)) + "\n"
    if len(lines) == 1:
        short = f"{lines[0][1]} {heads[0]}: {', '.join(f'{heads[k]} {cell}' for k, cell in list(zip(kept, lines[0]))[2:])}.\n"
    return f"{short}\n{page_tables.detail(name, caption, markdown(heads, body))}\n"


def outcomes(rows, names, classes):
    body = []
    for name, of in grouped(rows, classes):
        counts = [sum(row["outcome"] == outcome for row in of) for outcome in names]
        body.append([name, str(len(of))] + [f"{share(count, len(of))}" for count in counts])
    return body


def measured(asked, count, total):
    return f"Required: {asked}. Measured: {share(count, total)} ({count} of {total}).\n\n"


def noise(rows):
    names = ("false line", "false tone", "tone as unknown", "gravity", "nothing", "cannot tell", "failed")
    asked = measured("lines of an order in at most 1 % of logs", sum(row["outcome"] == "false line" for row in rows), len(rows))
    return asked + shown("identify-noise", "By travel, ratio, sample rate, motion, noise and position", ["logs without ripple", "logs", *("undecided" if name == "cannot tell" else name for name in names)],
                         outcomes(rows, names, ("travel", "ratio", "sample rate", "motion", "noise", "position")), (), ("failed",))


def median(values):
    values = [value for value in values if value is not None and math.isfinite(value)]
    return f"{statistics.median(values):.3g}" if values else "-"


def tenth(values):
    values = sorted(values)
    return f"{values[len(values) // 10]:.2g} to {values[(9 * len(values)) // 10]:.2g}" if values else "-"


def injection(rows):
    tried = [row for row in rows if row["outcome"] == "tried"]
    body = []
    for name, of in grouped(tried, ("travel", "cycles per sweep", "half the sample rate", "sample rate", "motion", "noise", "position", "angle")):
        body.append([name, str(len(of)), share(sum(row["found_2x"] for row in of), len(of)), share(sum(row["nothing_2x"] for row in of), len(of)),
                     share(sum(row["nothing_2x"] and (row["bound_2x"] or 0) < 2 * row["bound_nm"] for row in of), len(of)),
                     share(sum(row["found_1x"] for row in of), len(of)), median([row["bound_in_largest"] for row in of]),
                     tenth([row["bound_in_largest"] for row in of]), median([row["bound_in_errors"] for row in of])])
    left = {}
    for row in rows:
        left[row["outcome"]] = left.get(row["outcome"], 0) + 1
    what = ", ".join(f"{count} {'undecided' if name == 'cannot tell' else name}" for name, count in sorted(left.items()))
    asked = measured("a sinusoid of 2X found in at least 99 %", sum(row["found_2x"] for row in tried), len(tried))
    heads = ["logs that answer \"no line above X\"", "logs", "2X found", "2X: \"no line\"", "2X: \"no line\" above less than 2X", "X found",
             "X / largest standard error", "10 % and 90 % quantile", "X / standard error of the order"]
    return asked + shown("identify-injection", "By travel, cycles per sweep, sample rate, motion, noise, position and angle", heads, body, (),
                         (heads[3], heads[4], heads[7])) + f"\nOutcomes of {len(rows)} logs: {what}.\n"


def ratio(rows):
    body = []
    for name, of in grouped(rows, ("ripple", "visible lines", "multiples", "travel", "ratio", "sample rate", "motion", "position")):
        def count(outcome):
            return share(sum(row["outcome"] == outcome for row in of), len(of))
        given = [row for row in of if "covers" in row]
        right = [row for row in given if row["match"] == "right"]
        body.append([name, str(len(of)), count("right"), count("multiple"), count("other"), count("other comb"), count("cannot tell"), count("missed"), count("failed"),
                     f"{share(sum(row['covers'] for row in right), len(right))} of {len(right)}",
                     f"{share(sum(row['covers_either'] for row in given), len(given))} of {len(given)}"])
    wrong = sum(row["outcome"] in ("multiple", "other", "other comb") for row in rows)
    given = [row for row in rows if row.get("match") == "right" and "covers" in row]
    asked = measured("no conclusive ratio that is wrong", wrong, len(rows)) + \
        measured("intervals of right ratios hold the truth in 90 to 98 %", sum(row["covers"] for row in given), len(given))
    heads = ["logs with ripple", "logs", "right", "wrong multiple", "wrong", "ratio of the other comb", "undecided", "\"no line\"", "failed", "right: interval covers",
             "all: interval covers either comb"]
    return asked + shown("identify-ratio", "By ripple, lines, travel, ratio, sample rate, motion and position", heads, body, ("visible lines",),
                         ("failed", heads[-1])) + "\n" + lines(rows)


def lines(rows):
    """Lines of the same logs: how many are found, the error of their amplitude, and false ones."""
    made = [{**row, **line} for row in rows for line in row.get("lines", []) if not row["folded"]]
    body = []
    for name, of in grouped(made, ("strength", "cycles per sweep", "motion")):
        seen = [row for row in of if row["strength"] > 10 and row["cycles_per_sweep"] >= 4]
        sizes = [row["size"] for row in seen if row["size"] and row["alone"] and row["strength"] > 30]
        body.append([name, str(len(of)), share(sum(row["found"] for row in of), len(of)), share(sum(row["found"] for row in seen), len(seen)),
                     median(sizes), share(sum(abs(size - 1) < 0.1 for size in sizes), len(sizes))])
    counted = [row for row in rows if row.get("false_lines") is not None]
    some = sum(row["false_lines"] > 0 for row in counted)
    heads = ["true lines", "lines", "found", "found, of 10 standard errors and 4 cycles", "amplitude / truth, median", "within 10 %"]
    return shown("identify-lines", "By strength, cycles per sweep and motion", heads, body, (), heads[4:]) + \
        f"\nLines at no true order: in {share(some, len(counted))} of {len(counted)} logs.\n"


TABLES = {"noise": noise, "injection": injection, "ratio": ratio}
