# SPDX-License-Identifier: MIT
"""What was asked of names in arms whose torque MuJoCo computed against what was measured."""

from .. import bars, table


def line(text, asked, answers, low=0.0):
    if not answers:
        return [text, asked, "no logs", "-", "-"]
    right, count = sum(answers), len(answers)
    least, most = bars.wilson(right, count)
    return [text, asked, f"{right}/{count} = {100 * right / count:.1f} %", f"{100 * least:.1f} to {100 * most:.1f} %",
            "yes" if right / count >= low else "**no**"]


def label(row):
    return "+".join(sorted(row["hidden"])) or "nothing"


def blocks(about, rows):
    rows = sorted((row for row in rows if "failed" not in row), key=lambda row: row["case"])
    hidden = [row for row in rows if row["hidden"]]
    nulls = [row for row in rows if not row["hidden"]]
    head = table.markdown(bars.HEAD, [
        line("one or two effects hidden: names exactly right", "at least 95 %", [row["exact"] for row in hidden], 0.95),
        line("no false name beside them", "each", [not row["false"] for row in hidden], 1.0),
        line("nothing hidden: no name", "each", [not row["named"] for row in nulls], 1.0)])
    kinds = []
    for kind in sorted({label(row) for row in rows}):
        group = [row for row in rows if label(row) == kind]
        kinds.append([kind, str(len(group)), table.share(group, lambda r: r["exact"]), table.share(group, lambda r: r["in_set"]),
                      table.share(group, lambda r: r["false"])])
    body = table.markdown(["hidden", "logs", "exactly right", "in the set", "false name"], kinds)
    wrong = "\n".join(f"* {row['case']}: named {', '.join(row['named']) or 'nothing'}, {row['verdict']}" for row in rows if not row["exact"])
    return {"mujoco": f"{about}\n\n{head}\n\n{body}\n\nWrong:\n\n{wrong or 'Nothing.'}"}
