# SPDX-License-Identifier: MIT
"""Runs the tool on a case's logs, as a user would, and keeps what it answers and how long it took."""

import contextlib
import json
import pathlib
import resource
import signal
import subprocess

from . import joint

MODEL = {"schema": "ripplenotch/model/1", "gear_ratio": joint.GEAR_RATIO}
BASE = {**MODEL, "effects": [{"effect": "inertia"}, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]}
LONGEST_S = 60


class ToolFailed(Exception):
    pass


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def as_model(truth):
    """The truth in the tool's words; which samples chance hits is in no model, so these effects stay out."""
    return {**MODEL, "effects": [effect for effect in truth if effect["effect"] not in joint.CHANCE]}


def run(tool, *words):
    # Limited from outside: a function that runs before the program does would need a copy of all that NumPy has loaded.
    with subprocess.Popen([tool, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        with contextlib.suppress(ProcessLookupError):
            resource.prlimit(running.pid, resource.RLIMIT_CPU, (LONGEST_S, LONGEST_S + 5))
        told, said = running.communicate()
    if running.returncode == -signal.SIGXCPU:
        raise ToolFailed(f"{words[0]}: no answer within {LONGEST_S} s of processor time")
    if running.returncode != 0:
        raise ToolFailed(f"{words[0]}: exit {running.returncode}: {said.strip()[-300:]}")
    return json.loads(told)


def diagnose(tool, folder, options=()):
    """The diagnosis of train.npy against base.json, checked on validate.npy, and the seconds of processor time."""
    folder = pathlib.Path(folder)
    before = cpu_seconds()
    found = run(tool, "diagnose", folder / "train.npy", "--model", folder / "base.json", "--validate",
                folder / "validate.npy", "--json", "--force", "--improved-model", folder / "improved.json", *options)
    seconds = cpu_seconds() - before
    (folder / "diagnosis.json").write_text(json.dumps(found, indent=2))
    return found, seconds


def residual_nm(tool, model, log):
    """rms of measured less expected torque of a complete model along a log, by `simulate`."""
    expected = log.with_name("expected.npy")
    summary = run(tool, "simulate", "--model", model, log, "-o", expected, "--force", "--json")
    expected.unlink()
    return summary["along_log"]["residual_rms_nm"]
