# SPDX-License-Identifier: MIT
"""docs/certificate.md is what scripts/certify measures today, and it quotes README."""

import pathlib
import subprocess
import sys
import unittest

from commands import SOURCE, TOOL

PYTHONS = [python for python in (sys.executable, "/usr/bin/python3")
           if pathlib.Path(python).exists() and not subprocess.run([python, "-c", "import scipy"], capture_output=True).returncode]


class Certificate(unittest.TestCase):
    @unittest.skipUnless(PYTHONS, "no SciPy")
    def test_the_page_is_not_stale(self):
        """Rows whose oracle is not there are skipped; certify names them."""
        done = subprocess.run([PYTHONS[0], SOURCE / "scripts/certify", "--check"], env={"RIPPLENOTCH": TOOL, "PATH": "/usr/bin:/bin"},
                              capture_output=True, text=True)
        print(*(line for line in done.stderr.splitlines() if "SKIPPED" in line), sep="\n")
        self.assertEqual(done.returncode, 0, done.stderr)
