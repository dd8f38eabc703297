# SPDX-License-Identifier: MIT
"""Windows of 5 and 10 s of logs of real robots, and the whole logs, against the ratios of their data sheets.

A window that answers "no line above X" is held against the longer windows that hold it, up to the whole log.
"""

import csv

from . import answer, studies, tables

WINDOWS_S = (5.0, 10.0, None)
# File, unit of angle, ratio of each joint by the part of the column name before its quantity (None: nothing published).
LOGS = (
    ("gpl3/panda_gaz_all.csv", "rad", {**{f"panda_joint{k}": 120.0 for k in range(1, 5)}, "panda_joint5": 80.0, "panda_joint6": 80.0,
                                       "panda_joint7": None}),
    ("kuka_kr300_trajA_all.csv", "deg", {"j1": 1798 / 7, "j2": 1872 / 7, "j3": 757 / 3, "j4": 221.0, "j5": 5032 / 21, "j6": 206793 / 1340}),
    ("kuka_kr300_trajB_all.csv", "deg", {"j1": 1798 / 7, "j2": 1872 / 7, "j3": 757 / 3, "j4": 221.0, "j5": 5032 / 21, "j6": 206793 / 1340}),
    ("neura_lara8_j3.csv", "rad", {"": 101.0}),
    ("ur10_unisa_exciting_all.csv", "rad", {f"{name}_joint": None for name in ("shoulder_pan", "shoulder_lift", "elbow",
                                                                                "wrist_1", "wrist_2", "wrist_3")}),
)
# Joints whose ripple was filtered out before publication: a line there is false.
SILENT = ("ur10_unisa_exciting_all.csv",)


def columns(path, joint, unit):
    """Rows of (time, velocity, torque, position) of one joint, as text."""
    start = joint + "_" if joint else ""
    torque = "effort_Nm" if "ur10" in path.name else "torque_Nm"
    names = ("time_s", f"{start}velocity_{unit + '_s'}", start + torque, f"{start}position_{unit}")
    with path.open(newline="") as stream:
        reader = csv.reader(stream)
        heads = next(reader)
        places = [heads.index(name) for name in names]
        return [[row[place] for place in places] for row in reader]


def spans(rows, length):
    """(first, last) times of consecutive windows of a length; the whole log for None."""
    begin, end = float(rows[0][0]), float(rows[-1][0])
    if length is None:
        return [(begin, end)]
    return [(begin + k * length, begin + (k + 1) * length) for k in range(int((end - begin) / length + 0.02))]


def text_of(rows, unit, begin, end):
    chosen = [row for row in rows if begin <= float(row[0]) <= end]
    return f"time_s,velocity_{unit}_s,torque_nm,position_{unit}\n" + "\n".join(",".join(row) for row in chosen) + "\n"


def answers(options):
    """One row for each window of each joint; None where none of the logs is there."""
    made, present = [], False
    for name, unit, joints in LOGS:
        path = options.logs / name
        if not path.exists():
            continue
        present = True
        for joint, ratio in joints.items():
            rows = columns(path, joint, unit)
            for length in WINDOWS_S:
                for begin, end in spans(rows, length):
                    row = {"log": path.stem, "joint": joint, "ratio": ratio, "length": length, "begin": begin, "end": end,
                           "silent": name in SILENT}
                    try:
                        row["answer"] = answer.identify(options.program, text_of(rows, unit, begin, end))
                    except answer.Failed as failure:
                        row |= {"answer": None, "why": str(failure)}
                    made.append(row)
    return made if present else None


def exceeded(row, rows):
    """(order, amplitude) of the largest line over 1.3 X that a longer window around this one has in the searched range."""
    found = row["answer"]
    bound, searched = found.bound_nm(), found.searched() or (20.0, float("inf"))
    worst = None
    for other in rows:
        if other["answer"] is None or (other["log"], other["joint"]) != (row["log"], row["joint"]) or \
                other["begin"] > row["begin"] + 1e-6 or other["end"] < row["end"] - 1e-6 or other["length"] == row["length"]:
            continue
        for line in other["answer"].lines:
            order = line["order_output"]
            if order and searched[0] <= order <= searched[1] and line["amplitude_nm"] > 1.3 * bound and \
                    (worst is None or line["amplitude_nm"] > worst[1]):
                worst = order, line["amplitude_nm"]
    return worst


def table(options):
    rows = answers(options)
    if rows is None:
        return None
    body, notes, sums = [], [], {}
    for log in dict.fromkeys((row["log"], row["length"]) for row in rows):
        of = [row for row in rows if (row["log"], row["length"]) == log]
        known = [row for row in of if row["ratio"] and row["answer"]]
        counts = {"right": 0, "multiple": 0, "other": 0, "open": 0}
        covered = given = 0
        for row in known:
            found = row["answer"]
            match = studies.multiple_of(found.ratio, row["ratio"]) if found.ratio else "open"
            if found.ratio:
                given += 1
                covered += found.interval[0] <= row["ratio"] <= found.interval[1]
            counts[match if found.conclusive else "open"] += 1
            if found.conclusive and match in ("multiple", "other"):
                notes.append(f"{row['log']} {row['joint']} {row['begin']:.0f} to {row['end']:.0f} s: {found.verdict}")
        silent = [row for row in of if row["answer"] and row["answer"].says_nothing() and row["answer"].bound_nm()]
        over = [(row, exceeded(row, rows)) for row in silent]
        over = [(row, worst) for row, worst in over if worst]
        notes += [f"{row['log']} {row['joint']} {row['begin']:.0f} to {row['end']:.0f} s: no line above {row['answer'].bound_nm():.3g} Nm, but "
                  f"{worst[1]:.3g} Nm at order {worst[0]:.1f} in a longer window" for row, worst in over]
        false = sum(bool(row["answer"] and row["answer"].lines) for row in of if row["silent"])
        numbers = [len(of), *counts.values(), covered, given, len(silent), len(over), false, sum(row["answer"] is None for row in of)]
        body.append((log, numbers))
        sums[log[1]] = [a + b for a, b in zip(sums.get(log[1], [0] * len(numbers)), numbers)]
    body = [[f"{log}, {'whole' if length is None else f'{length:g} s'}", *map(str, n[:5]), f"{n[5]} of {n[6]}", *map(str, n[7:])]
            for (log, length), n in [(("all", length), n) for length, n in sums.items()] + body]
    heads = ["log", "windows", "right", "wrong multiple", "wrong", "undecided", "interval covers data sheet", "\"no line\"", "exceeded", "false lines", "failed"]
    if not options.page:
        print("".join(f"* {note}\n" for note in notes))
    return tables.shown("identify-windows", "Each log", heads, [[f"all: {cells[0][5:]}", *cells[1:]] if cells[0].startswith("all, ") else cells for cells in body], (), ("failed",))
