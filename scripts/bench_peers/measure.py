# SPDX-License-Identifier: MIT
"""Whole processes, timed by the operating system's own account of each."""

import os
import pathlib
import statistics
import subprocess
import time
from dataclasses import asdict, dataclass


@dataclass
class Run:
    wall_s: float
    cpu_s: float
    peak_mib: float


@dataclass
class Side:
    """One program of a comparison: its command, the file that it makes, and how often it runs at most."""
    name: str
    words: list
    makes: pathlib.Path
    most_runs: int = 1000


def run(words, makes=None):
    """One run. What it makes is taken away before: nobody overwrites. RuntimeError with what it said when it failed."""
    if makes:
        makes.unlink(missing_ok=True)
    began = time.perf_counter()
    child = subprocess.Popen([str(word) for word in words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                             stderr=subprocess.PIPE)
    said = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - began
    child.returncode = os.waitstatus_to_exitcode(status)
    child.stderr.close()
    if child.returncode != 0:
        raise RuntimeError(said.decode(errors="replace").strip().split("\n")[-1] or f"exit code {child.returncode}")
    return Run(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def in_turn(sides, rounds, say):
    """{name: [runs]} of rounds in which every side has one run, so that a slow spell meets all; and what failed."""
    runs, failed = {side.name: [] for side in sides}, {}
    for number in range(rounds):
        for side in sides:
            if side.name in failed or number >= side.most_runs:
                continue
            try:
                runs[side.name].append(run(side.words, side.makes))
                say(f"  {side.name}: {runs[side.name][-1].wall_s:.3f} s wall, {runs[side.name][-1].cpu_s:.3f} s CPU")
            except (RuntimeError, OSError) as reason:
                failed[side.name] = str(reason)
                say(f"  SKIPPED {side.name}: {reason}")
    return {name: taken for name, taken in runs.items() if taken}, failed


def median(runs):
    return Run(*(statistics.median(column) for column in zip(*(asdict(one).values() for one in runs))))
