# SPDX-License-Identifier: MIT
"""How often a confirmed name is wrong, by the verdict that it came with, with the chance that the diagnosis states
(`wrong_percent`): one line a verdict.

Counted are logs that have nothing in common: halves of a log, the same log in other units and logs whose effect the tool
may not name are left out.
"""

from . import bars

STUDIES = ("single", "rarer", "pair", "triple", "noise", "poor", "null", "null ar0.5", "null t4", "outside", "outside+single",
           "formula")
HEAD = ["verdict", "logs", "names", "wrong", "share wrong", "95 % interval", "stated", "within"]
# Only "explained" says that nothing is left beside the names.
VERDICTS = ("explained", "partly-explained", "unexplained", "matches")


def line(verdict, rows):
    named = [row for row in rows if row["named"]]
    names = sum(len(row["named"]) for row in named)
    wrong = sum(len(row["false"]) for row in named)
    if not names:
        return [verdict, str(len(rows)), "0", "-", "-", "-", "-", "-"]
    low, high = bars.wilson(wrong, names)
    told = {row.get("told_wrong") for row in named}
    chance = told.pop() if len(told) == 1 else None
    return [verdict, str(len(rows)), str(names), str(wrong), f"{100 * wrong / names:.1f} %", f"{100 * low:.1f} to {100 * high:.1f} %",
            *(["-", "-"] if chance is None else [f"{chance:.2g} %", "yes" if low <= chance / 100 <= high else "**no**"])]


def lines(rows):
    counted = [row for row in rows if row["study"] in STUDIES and "named" in row and not row.get("recorded")]
    found = []
    for verdict in VERDICTS:
        of_verdict = [row for row in counted if row["verdict"] == verdict]
        # Names tested against a residual come without a chance, and so did all those of earlier programs.
        untold = [row for row in of_verdict if row["named"] and row.get("told_wrong") is None]
        told = [row for row in of_verdict if row not in untold]
        found += [line(verdict, told)] if told else []
        found += [line(f"{verdict}, no chance stated", untold)] if untold else []
    return found
