# SPDX-License-Identifier: MIT
"""ripplenotch diagnose --simulated: the torque of the user's own simulation, in a column and in a file of its own."""

import csv
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

TOOL = os.environ["RIPPLENOTCH"]


def written(path, head, rows):
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([head, *rows])


def arm_nm(t, q, payload):
    other = 40 * math.sin(0.8 * t + 0.3) + 25 * math.sin(1.9 * t)
    return (30 + 50 * payload) * math.cos(math.radians(q + other))


class Simulated(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        motion = [word for lap in range(3) for to, s in ((150, 2.2), (-60, 3), (100, 1.6), (60, 1.7), (-20, 1.2))
                  for word in ("--motion", f"poly6,to={to}deg,duration={s}s")]
        done = self.run_tool("simulate", "--gear-ratio", "100", "--effect", "coulomb-friction,torque_nm=0.9,width_deg_s=1",
                             "--effect", "viscous-friction,coefficient_nm_per_deg_s=0.012", *motion, "--sample-rate", "500Hz",
                             "--noise", "0.05Nm", "--seed", "1", "-o", "plain.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path / "plain.csv") as file:
            rows = list(csv.DictReader(file))
        names = {key.split("_")[0]: key for key in rows[0]}
        self.rows = [[float(row[names[key]]) for key in ("time", "velocity", "torque", "position")] for row in rows]
        log = [[t, v, tau + arm_nm(t, q, 1.03), q, arm_nm(t, q, 1.0)] for t, v, tau, q in self.rows]
        written(self.path / "log.csv", ["time_s", "velocity_deg_s", "torque_nm", "position_deg", "tau_model_nm"], log)

    def run_tool(self, *words):
        return subprocess.run([TOOL, *words], cwd=self.folder.name, capture_output=True, text=True, timeout=300,
                              stdin=subprocess.DEVNULL)

    def test_a_column_without_a_model_names_both_frictions_and_becomes_part_of_the_improved_model(self):
        done = self.run_tool("diagnose", "log.csv", "--simulated", "column,name=tau_model_nm", "--gear-ratio", "100",
                             "--json", "-o", "improved.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(sorted(found["named"]), ["coulomb-friction", "viscous-friction"])
        self.assertAlmostEqual(found["simulated"]["scale"]["value"], 1.02, delta=0.03)
        self.assertEqual(len(found["leftover"]), 3)
        self.assertTrue(all(entry["size_uncertain"] for entry in found["rounds"]))
        improved = json.loads((self.path / "improved.json").read_text())
        self.assertEqual(improved["simulated"]["column"], "tau_model_nm")
        again = self.run_tool("diagnose", "log.csv", "--model", "improved.json")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("named: nothing", again.stdout)

    def test_a_file_of_its_own_on_the_same_clock_gives_the_same_names_and_rows_outside_it_do_not_count(self):
        simulation = [[t, v, arm_nm(t, q, 1.0)] for t, v, _, q in self.rows[100:-100:2]]
        written(self.path / "sim.csv", ["time_s", "velocity_deg_s", "torque_nm"], simulation)
        done = self.run_tool("diagnose", "log.csv", "--simulated", "log,file=sim.csv,column=torque_nm", "--gear-ratio", "100",
                             "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(sorted(found["named"]), ["coulomb-friction", "viscous-friction"])
        self.assertIn("outside what sim.csv spans", done.stderr)
        self.assertLess(found["samples"], len(self.rows) - 190)

    def test_refusals_say_what_is_wrong(self):
        ratio = ["--gear-ratio", "100"]
        for words, code, part in (
                (["--simulated", "column,name=tau", *ratio], 2, "no column 'tau'"),
                (["--simulated", "column,name=torque_nm", *ratio], 3, "is the measured torque"),
                (["--simulated", "column,name=tau_model_nm"], 2, "--gear-ratio is missing"),
                (["--simulated", "torque", *ratio], 2, "neither column,name=NAME nor log"),
                (ratio, 2, "--model is missing")):
            done = self.run_tool("diagnose", "log.csv", *words)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(part, done.stderr)


if __name__ == "__main__":
    unittest.main()
