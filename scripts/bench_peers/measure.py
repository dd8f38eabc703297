# SPDX-License-Identifier: MIT
"""Whole processes, timed by the operating system's own account of each."""

import pathlib
import statistics
import subprocess
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


def run(run_once, words, makes):
    """One run, by the program that starts others from little memory. What it makes is taken away before: nobody
    overwrites. RuntimeError with what it said when it failed."""
    makes.unlink(missing_ok=True)
    done = subprocess.run([str(word) for word in (run_once, *words)], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().split("\n")[-1] or f"exit code {done.returncode}")
    wall, cpu, peak_kib = done.stdout.split()
    return Run(float(wall), float(cpu), int(peak_kib) / 1024)


def in_turn(run_once, sides, rounds, say):
    """{name: [runs]} of rounds in which every side has one run, so that a slow spell meets all; and what failed."""
    runs, failed = {side.name: [] for side in sides}, {}
    for number in range(rounds):
        for side in sides:
            if side.name in failed or number >= side.most_runs:
                continue
            try:
                runs[side.name].append(run(run_once, side.words, side.makes))
                say(f"  {side.name}: {runs[side.name][-1].wall_s:.3f} s wall, {runs[side.name][-1].cpu_s:.3f} s CPU")
            except (RuntimeError, OSError) as reason:
                failed[side.name] = str(reason)
                say(f"  SKIPPED {side.name}: {reason}")
    return {name: taken for name, taken in runs.items() if taken}, failed


def median(runs):
    return Run(*(statistics.median(column) for column in zip(*(asdict(one).values() for one in runs))))
