# SPDX-License-Identifier: MIT
"""Simulations that have friction of their own: the motion, rigid bodies and leftover of a real robot, and a simulation of one
joint, each inertial value a little off, with Coulomb friction that is right, too much, too little, or of another form than the
joint's.
"""

import dataclasses
import pathlib
import tempfile
import zlib

import numpy as np

from .. import bars, score, table, tool
from . import cases, real, robots

KINDS = ("right", "too much", "too little", "another form", "too much and ripple")
INERTIA_OFF = 0.03  # standard deviation of what each inertial value of the simulation is off by, of the value
COLUMN = "sim_torque_Nm"
WAYS = {"plain": "", "fit": ",friction=fit"}


@dataclasses.dataclass(frozen=True)
class Case:
    robot: str
    label: str
    number: int

    @property
    def name(self):
        return f"rubbing-{self.robot}-{self.label.replace(' ', '_')}-{self.number}"


def drawn(case, folder):
    """(columns of the log, gear ratio, the simulation's Coulomb friction in Nm, what of it is missing in Nm, hidden effects)"""
    log = real.real(case.robot, pathlib.Path(folder))
    rng = np.random.default_rng([zlib.crc32(case.name.encode())])
    j = int(rng.integers(log.q.shape[1]))
    off = 1 + INERTIA_OFF * rng.standard_normal(len(log.values))
    torque = log.motion.torque(log.robot, log.values)[:, j]
    simulated = log.motion.torque(log.robot, log.values * off)[:, j]
    rows = len(log.time)
    left = np.roll(log.left[:, j], int(rng.integers(rows // 10, 9 * rows // 10))) * rng.choice([-1, 1])
    x = real.Angles(log.time, log.motion.q[:, j], log.motion.dq[:, j], torque, log.robot.ratios[j])
    step = np.tanh(x.v / rng.uniform(0.5, 8.0))
    own_nm, part = rng.uniform(1, 4) * cases.rms(left), rng.uniform(0.3, 1.0)
    part = {"right": 0.0, "too little": part, "another form": -1.0}.get(case.label, -part)
    torque = torque + left + (1 + part) * own_nm * step
    hidden = []
    if case.label == "another form":
        hidden = [{"effect": "hysteresis", "torque_nm": own_nm, "width_deg": rng.uniform(1, 6)}]
    elif "ripple" in case.label:
        unit = {"effect": "ripple", "order": float(rng.choice(log.robot.orders)), "phase_deg": rng.uniform(-180, 180),
                "amplitude_nm": 1.0}
        hidden = [unit | {"amplitude_nm": rng.uniform(1, 3) * cases.rms(left) / float(np.std(cases.unit_torque(x, unit)))}]
    for effect in hidden:
        size = cases.SIZE.get(effect["effect"], "torque_nm")
        torque = torque + effect[size] * cases.unit_torque(x, effect | {size: 1.0})
    columns = {"time_s": log.time, "j_position_rad": log.q[:, j], "j_velocity_rad_s": log.dq[:, j], "j_torque_Nm": torque,
               COLUMN: simulated + own_nm * step}
    return columns, log.robot.ratios[j], own_nm, part * own_nm, hidden


def told(found, own_nm, missing_nm):
    """What is said of the simulation's own friction: its fitted scale acts on that as well."""
    row = {"named": sorted({key[0] for key in score.named_keys(found)}), "verdict": found["verdict"]}
    for term in found["own_terms"]:
        value = term["parameters"]["torque_nm"]
        truth = missing_nm + (1 - found["simulated"]["scale"]["value"]) * own_nm
        row |= {"value": value["value"], "ci95": value["ci95"], "truth": truth}
    return row


@dataclasses.dataclass(frozen=True)
class Study:
    folder: pathlib.Path  # of the real logs

    @staticmethod
    def chosen(first, seeds):
        return [Case(robot, label, n) for n in range(first, first + seeds) for label in KINDS for robot in robots.ROBOTS]

    def trial(self, program, case, _keep):
        row = {"study": "rubbing", "case": case.name, "label": case.label, "named": []}
        columns, ratio, own_nm, missing_nm, hidden = drawn(case, self.folder)
        row |= {"own_nm": own_nm, "missing_nm": missing_nm, "hidden": [effect["effect"] for effect in hidden]}
        with tempfile.TemporaryDirectory(prefix="prove-diagnose-") as name:
            path = pathlib.Path(name) / "log.npy"
            rows = np.empty(len(columns["time_s"]), [(column, "<f8") for column in columns])
            for column, values in columns.items():
                rows[column] = values
            np.save(path, rows)
            for way, words in WAYS.items():
                found = tool.run(program, "diagnose", path, "--gear-ratio", ratio, "--simulated", COLUMN + words, "--json")
                row[way] = told(found, own_nm, missing_nm)
        return row | {"named": row["fit"]["named"]}

    @staticmethod
    def blocks(about, rows):
        rows = sorted(rows, key=lambda row: row["case"])
        head = ["the simulation's friction", "logs", "named as hidden", "a false name", "interval of its error holds",
                "without `friction=fit`: named as hidden", "a false name"]
        lines = [[label, str(len(of)), table.share(of, lambda r: right(r, "fit")), table.share(of, lambda r: false(r, "fit")),
                  table.share(of, holds), table.share(of, lambda r: right(r, "plain")), table.share(of, lambda r: false(r, "plain"))]
                 for label in KINDS if (of := [row for row in rows if row["label"] == label])]
        asked = table.markdown(bars.HEAD, [
            bars.line("a false name with `friction=fit`", "at most 1 %", [false(row, "fit") for row in rows], 0.0, 0.01),
            bars.line("a false name without", "at most 1 %", [false(row, "plain") for row in rows], 0.0, 0.01),
            bars.line("the interval of the friction's error holds it", "at least 90 %", [holds(row) for row in rows if holds(row) is not None],
                      0.9)])
        wrong = "\n".join(f"* {row['case']}: named {', '.join(row['fit']['named']) or 'nothing'}; without `friction=fit` "
                          f"{', '.join(row['plain']['named']) or 'nothing'}" for row in rows if false(row, "fit") or false(row, "plain"))
        return {"rubbing": f"{about}\n\n{asked}\n\n{table.markdown(head, lines)}\n\nFalse names:\n\n{wrong or 'None.'}"}


def hidden_in(row, way):
    """Friction that is missing is a name where it is no value of the fit."""
    more = {"coulomb-friction"} if way == "plain" and row["label"] == "too little" else set()
    return set(row["hidden"]) | more


def right(row, way):
    return hidden_in(row, way) <= set(row[way]["named"])


def false(row, way):
    return bool(set(row[way]["named"]) - hidden_in(row, way))


def holds(row):
    ends = row["fit"].get("ci95")
    return None if ends is None else ends[0] <= row["fit"]["truth"] <= ends[1]
