# SPDX-License-Identifier: MIT
"""The scores of a run in a file of JSON lines, to which a run that was cut off is added later.

Before the first case comes a line {"about": ...}: commit, program, machine and time. Scores of two programs in one
file would be no measurement of either, so that a record is only continued with the program that it was begun with.
"""

import datetime
import hashlib
import json
import os
import pathlib
import platform
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def processor():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def commit():
    done = subprocess.run(["git", "-C", SOURCE, "describe", "--always", "--dirty", "--abbrev=7"], capture_output=True,
                          text=True)
    return done.stdout.strip() or "unknown"


def about(program, options=()):
    """What was measured, where and when. The program counts as built from the sources that this script lies in."""
    return {"program": hashlib.sha256(pathlib.Path(program).read_bytes()).hexdigest()[:16], "commit": commit(),
            "options": list(options), "machine": f"{processor()}, {os.cpu_count()} cores", "load": round(os.getloadavg()[0], 1),
            "begun": datetime.datetime.now().isoformat(timespec="minutes")}


def read(path):
    """(abouts, scores)"""
    lines = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    return [line["about"] for line in lines if "about" in line], [line for line in lines if "case" in line]


def together(paths):
    """Scores of the same case in several records become one; (abouts of the first, scores)."""
    rows, first = {}, None
    for path in paths:
        abouts, scores = read(path)
        first = abouts if first is None else first
        for row in scores:
            rows[row["case"]] = {**rows.get(row["case"], {}), **row}
    return first or [], list(rows.values())


class Record:
    """The scores of one run; without a path they are only kept until its end."""

    def __init__(self, path, program, options):
        self.path = path
        self.about = about(program, options)
        self.abouts, self.rows = read(path) if path else ([], [])
        before = {(line["program"], *line["options"]) for line in self.abouts}
        if before - {(self.about["program"], *options)}:
            raise SystemExit(f"prove-diagnose: {path} holds scores of another program or other options; take another file")
        if not self.abouts:
            self.abouts = [self.about]
            self._append({"about": self.about})

    def _append(self, line):
        if self.path:
            with self.path.open("a") as file:
                file.write(json.dumps(line) + "\n")

    def add(self, row):
        row = {**row, "finished": datetime.datetime.now().isoformat(timespec="minutes")}
        self.rows.append(row)
        self._append(row)
