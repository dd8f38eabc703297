# SPDX-License-Identifier: MIT
"""Tables of the studies, in Markdown: one row for all logs, and one for each class of them."""

import bisect
import math
import statistics

import page_tables

from .real import SILENT
from .real_studies import STRENGTHS


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


TRAVEL, RATIO, RATE = (40, 90, 180, 360), (3, 10, 30, 100), (100, 500)
# Name of the class and the order in which classes are listed, from a row; None leaves the row out.
CLASSES = {
    "travel": lambda row: (rank(TRAVEL)(row["travel_deg"]), banded(TRAVEL, " deg")(row["travel_deg"])),
    "ratio": lambda row: (rank(RATIO)(row["ratio"]), banded(RATIO, "")(row["ratio"])),
    "sample rate": lambda row: (rank(RATE)(row["rate_hz"]), banded(RATE, " Hz")(row["rate_hz"])),
    "motion": lambda row: (0, row["motion"]),
    "noise": lambda row: (0, row["colour"]),
    "position": lambda row: (0, "with position" if row["position"] else "velocity only"),
    "ripple": lambda row: (0, row["ripple"] + (", folded" if row["folded"] else "")),
    "visible lines": lambda row: "visible" in row and (row["visible"] > 0, f"{min(2, row['visible'])}{' or more' if row['visible'] > 1 else ''}"),
}


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


def measured(asked, count, total):
    return f"Required: {asked}. Measured: {share(count, total)} ({count} of {total}).\n\n"


def noise(rows):
    names = ("false line", "false tone", "tone as unknown", "gravity", "nothing", "cannot tell", "failed")
    asked = measured("lines of an order in at most 1 % of logs", sum(row["outcome"] == "false line" for row in rows), len(rows))
    heads = ["logs without ripple", "logs", *("undecided" if name == "cannot tell" else name for name in names)]
    body = [[name, str(len(of)), *(share(sum(row["outcome"] == outcome for row in of), len(of)) for outcome in names)]
            for name, of in grouped(rows, ("travel", "ratio", "sample rate", "motion", "noise", "position"))]
    return asked + shown("identify-noise", "By travel, ratio, sample rate, motion, noise and position", heads, body, (), ("failed",))


def median(values):
    values = [value for value in values if value is not None and math.isfinite(value)]
    return f"{statistics.median(values):.3g}" if values else "-"


def tenth(values):
    values = sorted(values)
    return f"{values[len(values) // 10]:.2g} to {values[(9 * len(values)) // 10]:.2g}" if values else "-"


def ratio(rows):
    body = []
    for name, of in grouped(rows, ("ripple", "visible lines", "travel", "ratio", "sample rate", "motion", "position")):
        right = [row["covers"] for row in of if row.get("right") and "covers" in row]
        body.append([name, str(len(of)), *(share(sum(row["outcome"] == outcome for row in of), len(of)) for outcome in
                                           ("right", "wrong", "cannot tell", "missed", "failed")),
                     f"{share(sum(right), len(right))} of {len(right)}"])
    covers = [row["covers"] for row in rows if row.get("right") and "covers" in row]
    asked = measured("no conclusive ratio that is wrong", sum(row["outcome"] == "wrong" for row in rows), len(rows)) + \
        measured("intervals of right ratios hold the truth in 90 to 98 %", sum(covers), len(covers))
    counted = [row for row in rows if row.get("false_lines") is not None]
    heads = ["logs with ripple", "logs", "right", "wrong", "undecided", "\"no line\"", "failed", "right: interval covers"]
    caption = "By ripple, lines, travel, ratio, sample rate, motion and position"
    return asked + shown("identify-ratio", caption, heads, body, ("visible lines",), ("failed",)) + \
        f"\nLines at no true order: in {share(sum(row['false_lines'] > 0 for row in counted), len(counted))} of {len(counted)} logs.\n\n" + \
        calibration([(row["probability"], row["probable"]) for row in rows if "probability" in row], "simulated logs")


def by_length(rows):
    """(head, rows) of all, of each length of a window, of each log."""
    yield "all", rows
    for key in ("length", "log"):
        for value in sorted({row[key] for row in rows}):
            yield f"{key}: {value}", [row for row in rows if row[key] == value]


def left_out(rows, kept):
    counts = {name: sum(row["outcome"] == name for row in rows) for name in sorted({row["outcome"] for row in rows} - set(kept))}
    return "".join(f", {count} {name}" for name, count in counts.items())


def power(rows):
    every = [row for row in rows if row["outcome"] == "tried"]
    # Noise that was filtered out before publication is none to be told from: such logs are shown and not counted.
    filtered, tried = ([row for row in every if (row["log"] in SILENT) == silent] for silent in (True, False))
    body, asked = [], ""
    for name, of in [*by_length(tried), *([("not counted: filtered logs", filtered)] if filtered else [])]:
        bound, over = [row["found_X"] for row in of if "found_X" in row], [row["bound_in_least"] for row in of]
        body.append([name, str(len(of)), *(share(sum(row[f"found_{times}"] for row in of), len(of)) for times in STRENGTHS),
                     share(sum(bound), len(bound)), str(len(of) - len(bound)), median([row.get("amplitude") for row in of]),
                     f"{statistics.median(row['bound_in_errors'] for row in of):.3g}", f"{statistics.median(over):.3g}", tenth(over)])
    for size, percent in ((7, 50), (10, 90), (14, 98), ("X", 95)):
        found = [row[f"found_{size}"] for row in tried if f"found_{size}" in row]
        asked += measured(f"lines of {size}{'' if size == 'X' else ' standard errors'} found in at least {percent} %", sum(found), len(found))
    asked += f"Required: X at most 3 times what least squares needs, in the median. Measured: {body[0][-2]}.\n\n"
    heads = ["a line put in", "windows", *(f"{times} standard errors" for times in STRENGTHS), "X", "no X",
             "amplitude / truth", "X / standard error", "X / what least squares needs", "10 % and 90 % quantile"]
    return asked + shown("identify-power", "Each length and log", heads, body, ("length", "not counted")) + \
        f"\nOf {len(rows)} windows: {len(every)} tried{left_out(rows, ('tried',))}.\n"


def stretched(rows):
    tried = [row for row in rows if "sweeps" in row]
    names = ("false line", "false tone", "nothing", "cannot tell")
    body = [[name, str(len(of)), *(share(sum(row["outcome"] == outcome for row in of), len(of)) for outcome in names)]
            for name, of in by_length(tried)]
    asked = measured("lines of an order in at most 2 % of windows", sum(row["outcome"] == "false line" for row in tried), len(tried))
    heads = ["windows without their lines", "windows", *("undecided" if name == "cannot tell" else name for name in names)]
    return asked + shown("identify-stretched", "Each length and log", heads, body, ("length",)) + \
        f"\nOf {len(rows)} windows: {len(tried)} tried{left_out(rows, names)}.\n"


CHANCES = (0.5, 0.7, 0.85, 0.95, 0.99)


def calibration(told, title):
    """told: (probability of the most probable ratio, whether it is right)."""
    body = []
    for low, high in zip(CHANCES, (*CHANCES[1:], 1.01)):
        of = [right for chance, right in told if low <= chance < high]
        body.append([f"{100 * low:.0f} to {100 * min(high, 1):.0f} %", str(len(of)), share(sum(of), len(of))])
    return page_tables.units_in_head(markdown([f"{title}: probability of the ratio", "answers", "right"], body)) + "\n"


TABLES = {"power": power, "stretched": stretched, "noise": noise, "ratio": ratio}
