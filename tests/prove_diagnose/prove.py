# SPDX-License-Identifier: MIT
"""Finds the scripts under test; without numpy the test ends as skipped."""

import subprocess
import sys

from commands import SOURCE, TOOL, new_folder, run

try:
    import numpy  # noqa: F401
except ModuleNotFoundError:
    print(f"skipped: numpy is missing in {sys.executable}; Debian's python3-numpy brings it")
    sys.exit(77)


def skip_unless_command(name):
    if run(name, "--help").returncode != 0:
        print(f"skipped: this ripplenotch has no command {name}")
        sys.exit(77)


def prove(*words):
    return subprocess.run([sys.executable, SOURCE / "scripts" / "prove-diagnose", "--tool", TOOL, *words],
                          capture_output=True, text=True, timeout=600)


def rows(case, study, seeds, only=(), first=0):
    """The scores of a study's cases; case: the TestCase, which fails when one of them did not end."""
    from prove_diagnose import record as records
    record = new_folder(case) / "record.jsonl"
    chosen = [word for label in only for word in ("--only", label)]
    done = prove("--study", study, "--seeds", str(seeds), "--first", str(first), "--record", str(record), *chosen)
    case.assertEqual(done.returncode, 0, done.stderr)
    found = records.read(record)[1]
    case.assertEqual([row for row in found if "error" in row], [])
    return found
