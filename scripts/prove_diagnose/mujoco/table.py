# SPDX-License-Identifier: MIT
"""What was asked of names in arms whose torque MuJoCo computed against what was measured."""

import page_tables

from .. import bars, table


def label(row):
    return "+".join(sorted(row["hidden"])) or "nothing"


def blocks(about, rows):
    rows = sorted((row for row in rows if "failed" not in row), key=lambda row: row["case"])
    hidden = [row for row in rows if row["hidden"]]
    nulls = [row for row in rows if not row["hidden"]]
    head = bars.shown("diagnose-arms-mujoco-criteria", [
        bars.line("one or two effects hidden: names exactly right", "at least 95 %", [row["exact"] for row in hidden], 0.95),
        bars.line("the same: no false name", "each", [not row["false"] for row in hidden], 1.0),
        bars.line("nothing hidden: no name", "each", [not row["named"] for row in nulls], 1.0)])
    kinds = []
    for kind in sorted({label(row) for row in rows}):
        group = [row for row in rows if label(row) == kind]
        kinds.append([kind, str(len(group)), table.share(group, lambda r: r["exact"]), table.share(group, lambda r: r["in_set"]),
                      table.share(group, lambda r: r["false"])])
    body = table.markdown(["hidden", "logs", "exactly right", "not contradicted", "false name"], kinds)
    wrong = [f"{row['case']}: named {', '.join(row['named']) or 'nothing'}, {row['verdict']}" for row in rows if not row["exact"]]
    return {"mujoco": table.joined(about, head, page_tables.detail("diagnose-arms-mujoco", "Each hidden effect", body),
                                   table.listed("diagnose-arms-mujoco-wrong", "Cases that are not exactly right", wrong))}
