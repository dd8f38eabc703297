# SPDX-License-Identifier: MIT
"""Finds the scripts under test; without numpy the test ends as skipped."""

import os
import pathlib
import subprocess
import sys

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])
TOOL = os.environ["RIPPLENOTCH"]
sys.path.insert(0, str(SOURCE / "scripts"))

try:
    import numpy  # noqa: F401
except ModuleNotFoundError:
    print(f"skipped: numpy is missing in {sys.executable}; Debian's python3-numpy brings it")
    sys.exit(77)


def skip_unless_command(name):
    if subprocess.run([TOOL, name, "--help"], capture_output=True).returncode != 0:
        print(f"skipped: this ripplenotch has no command {name}")
        sys.exit(77)


def prove(*words):
    return subprocess.run([sys.executable, SOURCE / "scripts" / "prove-diagnose", "--tool", TOOL, *words],
                          capture_output=True, text=True, timeout=600)
