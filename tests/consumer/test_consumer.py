# SPDX-License-Identifier: MIT
"""Somebody else's CMake project finds the library, as a subdirectory and as an installed package."""

import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from commands import SOURCE

CMAKE = os.environ.get("CMAKE_COMMAND", "cmake")


def known():
    """What the build around this test has found of the compiler by trying: the same compiler would only say it again."""
    cache = (pathlib.Path(os.environ["RIPPLENOTCH_BUILD"]) / "CMakeCache.txt").read_text()
    return [f"-D{name}={value}" for name, value in re.findall(r"^(RIPPLENOTCH_[A-Z0-9_]+):INTERNAL=(1|TRUE)$", cache, re.M)]


class Consumers(unittest.TestCase):
    def cmake(self, *words):
        done = subprocess.run([CMAKE, *map(str, words)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def configure(self, folder, *definitions):
        self.cmake("-S", SOURCE / "tests" / "consumer", "-B", folder, "-G", "Ninja",
                   f"-DCMAKE_CXX_COMPILER={os.environ['RIPPLENOTCH_CXX']}", *definitions)

    def test_as_a_subdirectory_it_configures_and_brings_no_tests_and_installs_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            self.configure(folder, f"-DRIPPLENOTCH_SOURCE={SOURCE}", *known())
            self.assertFalse(pathlib.Path(folder, "ripplenotch", "tests").exists())
            self.cmake("--install", folder, "--prefix", f"{folder}/prefix")
            self.assertFalse(pathlib.Path(folder, "prefix").exists())

    def test_as_an_installed_package_it_links_and_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            self.cmake("--install", os.environ["RIPPLENOTCH_BUILD"], "--prefix", f"{folder}/prefix")
            self.configure(f"{folder}/build", f"-DCMAKE_PREFIX_PATH={folder}/prefix")
            self.cmake("--build", f"{folder}/build")
            done = subprocess.run([f"{folder}/build/consumer", SOURCE / "data" / "paper_90deg_s.csv"],
                                  capture_output=True, text=True)
            # A notch of Q 1/4 by the bilinear transform: b0 = (1 + k^2) / (1 + 4 k + k^2), k = tan(pi 25 / 1000).
            k = math.tan(math.pi * 25 / 1000)
            self.assertEqual(done.stdout, f"1000 Hz, {(1 + k * k) / (1 + 4 * k + k * k):.6f}\n", done.stderr)
