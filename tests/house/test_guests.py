# SPDX-License-Identifier: MIT
"""A method, an effect, a format, a command, an export target and a figure come in by a few files each, as scripts/try-guests adds them;
that it still finds the places where it cuts its guests from is what keeps it from being out of date."""

import pathlib
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]


class Guests(unittest.TestCase):
    def test_each_touches_four_files_at_most(self):
        done = subprocess.run([sys.executable, "-B", SOURCE / "scripts/try-guests", "--count"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), 6)


if __name__ == "__main__":
    unittest.main()
