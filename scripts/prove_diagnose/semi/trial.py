# SPDX-License-Identifier: MIT
"""One semi-synthetic log from its making to its scores."""

import dataclasses
import pathlib
import shutil
import tempfile

import numpy as np

from .. import score, tool
from . import cases, robots, table

# Widths of a friction's step are those of the smoothed motion.
UNCOUNTED = ("exponent",)


def write(log, folder):
    rows = np.empty(len(log.columns["time_s"]), [(name, "<f8") for name in log.columns])
    for name, values in log.columns.items():
        rows[name] = values
    np.save(folder / "log.npy", rows)
    robot = robots.ROBOTS[log.case.robot]
    (folder / "arm.csv").write_text(robot.table_text())
    return [folder / "log.npy", "--joint", robot.joints[log.joint], "--arm", f"{robot.kind},file={folder / 'arm.csv'}",
            "--gear-ratio", robot.ratios[log.joint]]


def scored(log, found):
    """Names right, false, offered; values and their intervals; reported sizes of what was rightly named."""
    names = score.names(log.hidden, found)
    values = [p for p in score.parameters(log.hidden, found, log.seconds)
              if p["parameter"].partition(".")[2] not in UNCOUNTED]
    offered = {k[0] for k in score.named_keys(found)} | score.undecided_names(found)
    return {**names, "parameters": values, "least": log.least, "offered": all(e["effect"] in offered for e in log.hidden),
            "verdict": found["verdict"], "joint": robots.ROBOTS[log.case.robot].joints[log.joint],
            "statuses": [f"{entry['effect']} {entry['status']}" for entry in found["rounds"]]}


NO_ANSWER = {"exact": False, "in_set": False, "false": [], "named": ["no answer"], "parameters": [], "offered": False,
             "verdict": "no answer", "statuses": [], "joint": "-"}


@dataclasses.dataclass(frozen=True)
class Study:
    logs: pathlib.Path  # the folder of the real logs
    options: tuple = ()
    seeds = 10

    def chosen(self, first, seeds):
        return cases.planned(seeds, first)

    def trial(self, program, case, keep=None):
        """Scores of a case; keep: where the files of a case that is not right stay."""
        about = {"study": "semi", "robot": case.robot, "label": case.kind, "case": case.name}
        try:
            log = cases.made(case, self.logs)
        except ValueError as failure:
            return {**about, **NO_ANSWER, "error": str(failure), "least": None, "sizes": [], "seconds": 0.0}
        about |= {"sizes": log.sizes, "least": log.least}
        with tempfile.TemporaryDirectory(prefix="prove-diagnose-") as name:
            folder = pathlib.Path(name)
            before = tool.cpu_seconds()
            try:
                found = tool.run(program, "diagnose", *write(log, folder), "--json", *self.options)
                row = scored(log, found)
            except (tool.ToolFailed, KeyError, TypeError, ValueError) as failure:
                row = {**NO_ANSWER, "error": f"{type(failure).__name__}: {failure}"}
            if keep and not row["exact"]:
                shutil.copytree(folder, keep / case.name, dirs_exist_ok=True)
            return {**about, **row, "seconds": tool.cpu_seconds() - before}

    @staticmethod
    def blocks(about, rows):
        return table.blocks(about, rows)

    @staticmethod
    def answer(row):
        return (", ".join(row["named"]) or "nothing") + ("" if row["exact"] else " WRONG " + "; ".join(row["statuses"]))
