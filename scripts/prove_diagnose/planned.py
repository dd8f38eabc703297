# SPDX-License-Identifier: MIT
"""Logs that end undecided, the motion that `diagnose --plan` asks for, and what the joint's log along it decides.

The joint is moved by a poor motion: one way, one stroke, 15 or 4 degrees to and fro, two near speeds. Where the diagnosis leaves a tie or
calls a finding unidentifiable, its plan is read from the CSV, the same joint moves along it, and that log alone is diagnosed.
"""

import dataclasses
import json
import pathlib
import shutil
import tempfile

import numpy as np

import page_tables

from . import bars, cases, joint, motion, score, sensor, strengths, table, tool

LIMITS = "speed=180deg/s,acceleration=600deg/s2,range=-170deg:170deg"
LONGEST_S = 30.0
# What looks alike where the motion is poor.
LABELS = ("offset", "coulomb-friction", "viscous-friction", "stribeck-friction", "gravity", "hysteresis", "drift", "output-ripple",
          "quadratic-viscous-friction", "load-friction")
PAIRS = (("offset", "viscous-friction"), ("coulomb-friction", "viscous-friction"), ("coulomb-friction", "gravity"),
         ("hysteresis", "offset"), ("stribeck-friction", "offset"), ("gravity", "drift"))


def two_speeds(rng, start_deg, seconds):
    """One way, without a rest, at two speeds that are near each other."""
    travel = motion.Motion(start_deg)
    travel.speed_deg_s = rng.uniform(60.0, 90.0)
    return travel.stay(seconds / 2 - 0.5).speed_to(1.3 * travel.speed_deg_s, 1.0).stay(seconds / 2 - 0.5)


def small_swings(rng, start_deg, seconds):
    """To and fro by 4 degrees."""
    travel, direction = motion.Motion(start_deg).rest(0.5), 1.0
    while travel.duration_s < seconds - 2.0:
        travel.stroke(direction * 4.0, rng.uniform(0.3, 0.8)).rest(rng.uniform(0.1, 0.3))
        direction = -direction
    return travel.rest(seconds - travel.duration_s)


POOR = {"one way": motion.one_way, "one stroke": motion.one_stroke, "short travel": motion.short_travel, "two speeds": two_speeds,
        "small swings": small_swings}


@dataclasses.dataclass(frozen=True)
class Planned(cases.Case):
    """A case whose second log is along a plan."""

    def along(self, travel, purpose):
        """The joint's log along any motion that has at(time) and duration_s."""
        base, hidden = self.truth()
        rng = self.rng(purpose)
        time = np.arange(round(travel.duration_s * cases.SAMPLE_RATE_HZ)) / cases.SAMPLE_RATE_HZ
        torque = joint.torque(travel, base + hidden, strengths.GEAR_RATIO, time, None)
        noise = sensor.noise(rng, self.noise, len(time), strengths.TORQUE_NOISE_NM)
        q, v, _ = travel.at(time)
        v = v + strengths.VELOCITY_NOISE_DEG_S * rng.standard_normal(len(time))
        return cases.Log(time, v, sensor.convert(torque + noise, hidden, rng), np.round(q * 2**19 / 360) * 360 / 2**19,
                         float(np.sqrt(np.mean(noise**2))), None)

    def poor_log(self):
        rng = self.rng("train")
        start = rng.uniform(-60.0, 0.0)
        return self.along(POOR[self.motion](rng, start, 3.0 if self.motion == "one stroke" else self.seconds), "noise")


class Rows:
    """The motion of a CSV of time, position and velocity, by the cubic between its rows; still before and after."""

    def __init__(self, path):
        self.time, self.q, self.v = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
        self.duration_s = float(self.time[-1])

    def at(self, time_s):
        t = np.clip(time_s, self.time[0], self.time[-1])
        k = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.time) - 2)
        h = self.time[k + 1] - self.time[k]
        s, q0, q1, v0, v1 = (t - self.time[k]) / h, self.q[k], self.q[k + 1], self.v[k] * h, self.v[k + 1] * h
        q = q0 + s * (v0 + s * (3 * (q1 - q0) - 2 * v0 - v1 + s * (2 * (q0 - q1) + v0 + v1)))
        v = (v0 + s * (2 * (3 * (q1 - q0) - 2 * v0 - v1) + 3 * s * (2 * (q0 - q1) + v0 + v1))) / h
        a = (2 * (3 * (q1 - q0) - 2 * v0 - v1) + 6 * s * (2 * (q0 - q1) + v0 + v1)) / h**2
        return q, v, a


def chosen(first, seeds):
    several = [(label,) for label in LABELS] + list(PAIRS)
    return [Planned("plan", "+".join(labels), number, motion=kind, hidden=labels, seconds=20.0)
            for number in range(first, first + seeds) for kind in POOR for labels in several]


def left_open(found):
    return bool(found["ambiguous"]) or any(entry["status"] in ("ambiguous", "unidentifiable") for entry in found["rounds"])


def diagnosed(program, folder, log, *words):
    return tool.run(program, "diagnose", log, "--model", folder / "base.json", "--json", "--force", "-q", *words)


def trial(program, case, keep=None):
    """Scores of a case; those that the poor log decides say so and no more."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="prove-plan-"))
    row = {"study": "plan", "case": case.name, "label": case.label, "motion": case.motion}
    try:
        (folder / "base.json").write_text(json.dumps(tool.BASE))
        case.poor_log().save(folder / "poor.npy")
        found = diagnosed(program, folder, folder / "poor.npy", "--plan", folder / "plan.csv", "--limits", LIMITS)
        row["undecided"] = left_open(found)
        if row["undecided"]:
            row["open"] = sorted(score.undecided_names(found))
            row["planned"] = bool(found.get("plan"))
        if row["undecided"] and row["planned"]:
            row["duration_s"], row["decides"] = found["plan"]["duration_s"], found["plan"]["decides"]
            case.along(Rows(folder / "plan.csv"), "planned").save(folder / "planned.npy")
            after = diagnosed(program, folder, folder / "planned.npy")
            names = score.names(case, (), case.truth()[1], after)
            row.update(decided=not left_open(after), exact=names["exact"], false=names["false"], named=names["named"],
                       still=sorted(score.undecided_names(after)))
    except (tool.ToolFailed, KeyError, ValueError) as failure:
        row["error"] = f"{type(failure).__name__}: {failure}"
    if keep and ("error" in row or row.get("undecided") and not row.get("exact")):
        shutil.rmtree(keep / case.name, ignore_errors=True)
        shutil.copytree(folder, keep / case.name)
    shutil.rmtree(folder)
    return row


def share(rows, key):
    return f"{sum(bool(row.get(key)) for row in rows)}/{len(rows)}"


def by_motion(lines):
    """Sums over the hidden effects, of the lines of the table."""
    found = []
    for kind in dict.fromkeys(line[0] for line in lines):
        own = [line for line in lines if line[0] == kind]
        counts = [str(sum(int(line[k].partition("/")[0]) for line in own)) for k in (3, 5, 6)]
        longest = max((int(line[7].partition(" ")[0]) for line in own if line[7] != "-"), default=None)
        found.append([kind, *counts, "-" if longest is None else f"{longest} s"])
    return table.markdown(["motion", "undecided", "decided after it", "exactly right", "longest plan"], found)


def blocks(about, rows):
    rows = sorted((row for row in rows if "error" not in row), key=lambda row: row["case"])
    undecided = [row for row in rows if row["undecided"]]
    criteria = table.markdown(bars.HEAD, [
        bars.line("undecided, and decided after one planned motion", "at least 95 %", [bool(row.get("decided")) for row in undecided], 0.95),
        bars.line("the same: names exactly right then", "-", [bool(row.get("exact")) for row in undecided], 0.95),
        bars.line("the same: no false name", "-", [not row.get("false") for row in undecided], 0.95),
        bars.line("planned motion of at most 30 s", "each", [row.get("duration_s", 99.0) <= LONGEST_S + 0.01 for row in undecided], 1.0)])
    lines = []
    for kind in POOR:
        for label in sorted({row["label"] for row in undecided if row["motion"] == kind}):
            group = [row for row in undecided if row["motion"] == kind and row["label"] == label]
            of = [row for row in rows if row["motion"] == kind and row["label"] == label]
            seconds = [row["duration_s"] for row in group if "duration_s" in row]
            lines.append([kind, label, str(len(of)), str(len(group)), " ".join(sorted({name for row in group for name in row["open"]})),
                          share(group, "decided"), share(group, "exact"), f"{max(seconds):.0f} s" if seconds else "-"])
    head = ["motion", "hidden", "logs", "undecided", "undecided between", "decided after it", "exactly right", "longest plan"]
    body = table.joined(by_motion(lines), page_tables.detail("diagnose-plans", "Each motion and hidden effect", table.markdown(head, lines)))
    wrong = [f"{row['case']}: {'named ' + (', '.join(row['named']) or 'nothing') if 'named' in row else 'no plan'}"
             f"{', undecided: ' + ', '.join(row['still']) if row.get('still') else ''}" for row in undecided if not row.get("exact")]
    return {"plan": table.joined(about, body,
                                 page_tables.detail("diagnose-plans-criteria", "Criteria, all met where no case is listed", criteria),
                                 table.listed("diagnose-plans-wrong", "Not exactly right after it", wrong,
                                                                     "All are exactly right after it."))}
