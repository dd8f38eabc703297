# SPDX-License-Identifier: MIT
"""How often a confirmed name is wrong, by the verdict that it came with: one line a verdict.

Counted are logs that have nothing in common: halves of a log, the same log in other units and logs whose effect the tool
may not name are left out.
"""

from . import nulls

STUDIES = ("single", "rarer", "pair", "triple", "noise", "poor", "null", "null ar0.5", "null t4", "outside", "outside+single",
           "formula")
HEAD = ["verdict", "logs", "names told", "wrong", "share wrong", "95 % below"]
# Only "explained" says that nothing is left beside the names.
VERDICTS = ("explained", "partly-explained", "unexplained", "matches")


def line(verdict, rows):
    names = sum(len(row["named"]) for row in rows)
    wrong = sum(len(row["false"]) for row in rows)
    if not names:
        return [verdict, str(len(rows)), "0", "-", "-", "-"]
    return [verdict, str(len(rows)), str(names), str(wrong), f"{100 * wrong / names:.1f} %", f"{100 * nulls.upper(wrong, names):.1f} %"]


def lines(rows):
    counted = [row for row in rows if row["study"] in STUDIES and "named" in row and not row.get("recorded")]
    groups = {verdict: [row for row in counted if row["verdict"] == verdict] for verdict in VERDICTS}
    return [line(verdict, group) for verdict, group in groups.items() if group]
