# SPDX-License-Identifier: MIT
"""Runs diagnose on the arms and counts names."""

import json
import pathlib
import shutil
import subprocess
import tempfile

import numpy

from .. import score
from . import cases

HERE = pathlib.Path(__file__).parent


def is_here():
    return shutil.which("node") is not None and pathlib.Path("node_modules/@mujoco/mujoco").is_dir()


def mujocos_torque(case):
    """Of bodies and friction, and of cogging; a column a joint."""
    told = json.dumps({"xml": case.xml, "rows": numpy.asarray(case.rows).tolist()})
    done = subprocess.run(["node", str(HERE / "arm.mjs")], input=told, capture_output=True, text=True, check=True)
    table = numpy.array([[float(cell) for cell in line.split(",")] for line in done.stdout.splitlines()])
    return table[:, 1:4], table[:, 4:7]


def write_log(path, table):
    names = ["time_s"] + [f"{joint} {word}" for word in ("position_deg", "velocity_deg_s", "torque_nm") for joint in cases.JOINTS]
    numpy.savetxt(path, table, delimiter=",", header=",".join(names), comments="", fmt="%.9g")


def chosen(first, seeds):
    """Of each number a log with one effect and one with two, and as many with nothing hidden, which come first."""
    nulls = [cases.case("null", number) for number in range(first, first + 2 * seeds)]
    return nulls + [cases.case(kind, number) for number in range(first, first + seeds) for kind in ("single", "pair")]


def one(tool, case, keep=None):
    """Scores of one case."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(keep) / case.name if keep else pathlib.Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        write_log(folder / "log.csv", cases.measured(case, *mujocos_torque(case)))
        (folder / "arm.xml").write_text(case.xml)
        (folder / "truth.json").write_text(json.dumps(case.hidden))
        (folder / "model.json").write_text(json.dumps({
            "schema": "ripplenotch/model/1", "gear_ratio": cases.GEAR,
            "effects": [{"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]}))
        done = subprocess.run([tool, "diagnose", "log.csv", "--joint", cases.JOINTS[case.joint], "--arm", "mjcf,file=arm.xml",
                               "--model", "model.json", "--json", "-q"], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            return {"case": case.name, "failed": done.stderr.strip()[-300:]}
        found = json.loads(done.stdout)
        (folder / "found.json").write_text(done.stdout)
        return {"case": case.name, "hidden": [effect["effect"] for effect in case.hidden], **score.names(case, None, case.hidden, found), "verdict": found["verdict"],
                "offered": sorted(score.undecided_names(found)), "before_nm": found["gap"]["before_nm"], "after_nm": found["gap"]["after_nm"]}
