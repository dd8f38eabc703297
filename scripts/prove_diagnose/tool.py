# SPDX-License-Identifier: MIT
"""Runs the tool on a case's logs, as a user would, and keeps what it answers and how long it took."""

import json
import pathlib
import resource
import signal
import subprocess

from . import strengths

MODEL = {"schema": "ripplenotch/model/1", "gear_ratio": strengths.GEAR_RATIO}
BASE = {**MODEL, "effects": [{"effect": "inertia"}, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]}
LONGEST_S = 60


class ToolFailed(Exception):
    pass


def limit_processor_time():
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST_S, LONGEST_S + 5))


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def as_model(truth):
    """The truth in the tool's words; which samples chance hits is in no model, so these effects stay out."""
    return {**MODEL, "effects": [effect for effect in truth if effect["effect"] not in strengths.CHANCE]}


def run(tool, *words):
    done = subprocess.run([tool, *map(str, words)], capture_output=True, text=True, preexec_fn=limit_processor_time)
    if done.returncode == -signal.SIGXCPU:
        raise ToolFailed(f"{words[0]}: no answer within {LONGEST_S} s of processor time")
    if done.returncode != 0:
        raise ToolFailed(f"{words[0]}: exit {done.returncode}: {done.stderr.strip()[-300:]}")
    return json.loads(done.stdout)


def diagnose(tool, folder, options=()):
    """The diagnosis of train.npy against base.json, checked on validate.npy, and the seconds of processor time."""
    folder = pathlib.Path(folder)
    before = cpu_seconds()
    found = run(tool, "diagnose", folder / "train.npy", "--model", folder / "base.json", "--validate",
                folder / "validate.npy", "--json", "--force", "-o", folder / "improved.json", *options)
    seconds = cpu_seconds() - before
    (folder / "diagnosis.json").write_text(json.dumps(found, indent=2))
    return found, seconds


def residual_nm(tool, model, log):
    """rms of measured less expected torque of a complete model along a log, by `simulate`."""
    expected = log.with_name("expected.npy")
    summary = run(tool, "simulate", "--model", model, log, "-o", expected, "--force", "--json")
    expected.unlink()
    return summary["along_log"]["residual_rms_nm"]
