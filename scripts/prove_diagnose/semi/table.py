# SPDX-License-Identifier: MIT
"""What was asked of names with a real residual against what was measured, and the tables of it."""

import page_tables

from .. import table
from . import cases

ENOUGH = 1.5  # times the residual's rms


def hides(row):
    return bool(row["sizes"])


def bar_lines(rows):
    hidden = [row for row in rows if hides(row)]
    large = [row for row in hidden if row["least"] >= ENOUGH]
    stribeck = [row for row in hidden if row["label"] == "coulomb-friction+stribeck-friction"]
    nothing = [row for row in rows if not hides(row)]
    return [
        table.line("names exactly right, each hidden effect at least 0.7 times the residual", "at least 95 %",
             [r["exact"] for r in hidden], 0.95),
        table.line("the same, each 1.5 times or more", "at least 97 %", [r["exact"] for r in large], 0.97),
        table.line("Coulomb with Stribeck friction", "at least 90 %", [r["exact"] for r in stribeck], 0.9),
        table.line("a false name, of all logs", "at most 0.5 %", [r["false"] for r in rows], 0.0, 0.005),
        table.line("nothing hidden, or a disturbance outside the catalogue: no name", "each", [not r["named"] for r in nothing], 1.0),
        table.line("named, or in a tie", "at least 98 %", [r["offered"] for r in hidden], 0.98),
        table.line("95 % interval covers the truth", "90 to 98 %", table.held(hidden), 0.9, 0.98),
    ]


def by_kind(rows):
    lines = []
    for kind in (*cases.KINDS, *cases.DISTURBANCES):
        group = [row for row in rows if row["label"] == kind]
        if not group:
            continue
        of = [p for row in group for p in row["parameters"]]
        sizes = [p["relative"] for p in of]
        lines.append([kind, str(len(group)), table.share(group, lambda r: r["exact"]),
                      table.share(group, lambda r: r["offered"] if hides(r) else None), table.share(group, lambda r: r["false"]),
                      table.median_percent(sizes), table.share(of, lambda p: None if p["beyond"] is None else p["beyond"] <= 1.0),
                      table.median([r["seconds"] for r in group], "{:.1f} s")])
    head = ["hidden", "logs", "exactly right", "named or in a tie", "false name", "parameter error", "interval covers", "time"]
    return page_tables.detail("diagnose-arms-semi", "Each hidden effect", table.markdown(head, lines))


def size(least):
    return f"{least:.1f}" if least is not None else "-"


def wrong(rows):
    lines = [f"{row['case']} ({row['joint']}, {size(row['least'])} times the residual): named "
             f"{', '.join(row['named']) or 'nothing'}{', the others in a tie' if row['offered'] and not row['exact'] else ''}"
             for row in rows if not row["exact"]]
    return table.listed("diagnose-arms-semi-wrong", "Cases that are not exactly right", lines)


def blocks(about, rows):
    """The tables by the name of their mark."""
    rows = sorted(rows, key=lambda r: r["case"])
    head = table.shown("diagnose-arms-semi-criteria", bar_lines(rows))
    return {"semi": table.joined(about, head, by_kind(rows), wrong(rows))}
