# SPDX-License-Identifier: MIT
"""ripplenotch diagnose --simulated: the torque of the user's own simulation, in a column and in a file of its own."""

import csv
import functools
import json
import math
import os
import pathlib
import struct
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


@functools.cache
def made(friction="coulomb-friction,torque_nm=0.9,width_deg_s=1"):
    """The rows of a joint that moves alone, simulated once for all tests."""
    with tempfile.TemporaryDirectory() as folder:
        motion = [word for lap in range(3) for to, s in ((150, 2.2), (-60, 3), (100, 1.6), (60, 1.7), (-20, 1.2))
                  for word in ("--motion", f"poly6,to={to}deg,duration={s}s")]
        plain = pathlib.Path(folder) / "plain.csv"
        subprocess.run([TOOL, "simulate", "--gear-ratio", "100", "--effect", friction,
                        "--effect", "viscous-friction,coefficient_nm_per_deg_s=0.012", *motion, "--sample-rate", "500Hz",
                        "--noise", "0.05Nm", "--seed", "1", "-o", plain], check=True, capture_output=True, timeout=300)
        with open(plain) as file:
            rows = list(csv.DictReader(file))
    names = {key.split("_")[0]: key for key in rows[0]}
    return [[float(row[names[key]]) for key in ("time", "velocity", "torque", "position")] for row in rows]


class Simulated(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        self.rows = made()
        log = [[t, v, tau + arm_nm(t, q, 1.03), q, arm_nm(t, q, 1.0)] for t, v, tau, q in self.rows]
        written(self.path / "log.csv", ["time_s", "velocity_deg_s", "torque_nm", "position_deg", "tau_model_nm"], log)

    def run_tool(self, *words):
        return subprocess.run([TOOL, *words], cwd=self.folder.name, capture_output=True, text=True, timeout=300,
                              stdin=subprocess.DEVNULL)

    def test_a_log_that_cannot_be_held_is_refused_before_it_is_read(self):
        names = ("time_s", "velocity_deg_s", "torque_nm", "tau_model")
        header = str({"descr": [(name, "<f8") for name in names], "fortran_order": False, "shape": (10**10,)}).ljust(250) + "\n"
        with open(self.path / "long.npy", "wb") as log:
            log.write(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
            log.write(b"".join(struct.pack("<4d", 0.001 * k, 60.0, 1.0, 2.0) for k in range(100_000)))
            log.truncate(10 + len(header) + 32 * 10**10)  # zeros that take no room
        done = self.run_tool("diagnose", "long.npy", "--simulated", "tau_model", "--gear-ratio", "100", "-o", "model.json")
        self.assertEqual(done.returncode, 6, done.stderr)
        self.assertIn("the whole log is held", done.stderr)
        self.assertIn("--from and --to", done.stderr)
        self.assertFalse((self.path / "model.json").exists())

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

    def residual_nm(self, *words):
        done = self.run_tool("simulate", *words, "-o", "again.csv", "--force", "--json", "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["along_log"]["residual_rms_nm"]

    def test_the_improved_model_leaves_what_was_said_and_diagnosed_again_begins_there(self):
        for name, scale in (("fitted", ""), ("kept", ",scale=1"), ("late", ",delay=fit")):
            with self.subTest(name):
                done = self.run_tool("diagnose", "log.csv", "--simulated", f"column,name=tau_model_nm{scale}", "--gear-ratio",
                                     "100", "--json", "-o", f"{name}.json")
                self.assertEqual(done.returncode, 0, done.stderr)
                found = json.loads(done.stdout)
                stated = json.loads((self.path / f"{name}.json").read_text())["simulated"]
                self.assertLessEqual({"offset_nm", "inertia_kgm2", "gravity_cosine_nm", "gravity_sine_nm"}, set(stated["nuisance"]))
                # A fitted delay is the slope of the column in the fit and a shift of it in the model.
                off = 0.02 if name == "late" else 1e-4
                left = self.residual_nm("--model", f"{name}.json", "log.csv")
                self.assertAlmostEqual(left / found["gap"]["after_nm"], 1.0, delta=off)
                again = self.run_tool("diagnose", "log.csv", "--model", f"{name}.json", "--json", "-o", "again.json", "--force")
                self.assertEqual(again.returncode, 0, again.stderr)
                before = json.loads(again.stdout)
                self.assertAlmostEqual(before["gap"]["before_nm"] / left, 1.0, delta=1e-4)
                self.assertEqual(before["named"], [])
                told = json.loads((self.path / "again.json").read_text())["simulated"]["nuisance"]
                for key, value in stated["nuisance"].items():
                    self.assertAlmostEqual(told[key], value, delta=0.02 + 0.05 * abs(value))

    def write_with_friction(self, friction_nm, payload=1.03):
        """The log beside a simulation that has this friction, and the viscous one as it is."""
        simulated = [arm_nm(t, q, 1.0) + friction_nm * math.tanh(v) + 0.012 * v for t, v, _, q in self.rows]
        log = [[t, v, tau + arm_nm(t, q, payload), q, nm] for (t, v, tau, q), nm in zip(self.rows, simulated, strict=True)]
        written(self.path / "rubs.csv", ["time_s", "velocity_deg_s", "torque_nm", "position_deg", "tau_model_nm"], log)

    def test_what_a_simulation_has_too_much_of_is_no_name_and_said_where_it_is_said_to_have_friction(self):
        self.write_with_friction(1.3)  # 0.9 are there
        words = ["diagnose", "rubs.csv", "--gear-ratio", "100"]
        done = self.run_tool(*words, "--simulated", "tau_model_nm")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("its size is below 0", done.stdout)
        self.assertIn("named: nothing", done.stdout)
        self.assertIn("next: if the simulation has friction of its own, --simulated ...,friction=fit", done.stdout)
        done = self.run_tool(*words, "--simulated", "tau_model_nm,friction=fit", "-o", "improved.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"simulated: coulomb-friction, torque_nm = -0\.4\d* \[.*: 1.0\d* times the simulation's torque has too much of it")
        self.assertNotIn("friction=fit", done.stdout)
        self.assertIn("named: nothing", done.stdout)
        improved = json.loads((self.path / "improved.json").read_text())
        (own,) = improved["effects"]
        self.assertEqual(own["effect"], "coulomb-friction")
        too_much_nm = 1.3 * improved["simulated"]["scale"] - 0.9
        self.assertAlmostEqual(own["torque_nm"], -too_much_nm, delta=0.03)  # its own error is 0.01 Nm, the width's another
        self.assertLess(self.residual_nm("--model", "improved.json", "rubs.csv"), 0.06)  # the noise is 0.05 Nm
        del improved["simulated"]
        (self.path / "alone.json").write_text(json.dumps(improved))
        done = self.run_tool("simulate", "--model", "alone.json", "rubs.csv")
        self.assertEqual(done.returncode, 3)
        self.assertIn("torque_nm is -0.", done.stderr)

    def test_friction_of_another_form_than_the_simulation_has_is_named_once_that_is_fitted_and_nothing_else_before(self):
        self.rows = made("hysteresis,torque_nm=0.9,width_deg=3")
        self.write_with_friction(0.9)
        words = ["diagnose", "rubs.csv", "--gear-ratio", "100", "--json"]
        done = self.run_tool(*words, "--simulated", "tau_model_nm,friction=fit")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(found["named"], ["hysteresis"])
        low, high = found["own_terms"][0]["parameters"]["torque_nm"]["ci95"]
        all_of_it_nm = 0.9 * found["simulated"]["scale"]["value"]
        self.assertTrue(low <= -all_of_it_nm <= high, (low, high))
        done = self.run_tool(*words, "--simulated", "tau_model_nm")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLessEqual(set(json.loads(done.stdout)["named"]), {"hysteresis"})

    def test_where_the_scale_is_not_told_neither_is_what_of_the_friction_is_too_much(self):
        # All else that the simulation holds is the joint's own weight, which is mended.
        def write(viscous):
            rows = []
            for t, v, tau, q in self.rows:  # 0.012 Nm per deg/s of it are viscous
                weight = 30 * math.cos(math.radians(q))
                rows.append([t, v, tau + (viscous - 0.012) * v + weight, q, weight + 1.3 * math.tanh(v)])
            written(self.path / "alone.csv", ["time_s", "velocity_deg_s", "torque_nm", "position_deg", "tau_model_nm"], rows)
        write(0.0)
        words = ["diagnose", "alone.csv", "--gear-ratio", "100", "--simulated"]
        done = self.run_tool(*words, "tau_model_nm,friction=fit")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("whether it has too much or too little is not told", done.stdout)
        self.assertNotIn("coulomb-friction, torque_nm = -0.4 [", done.stdout)
        done = self.run_tool(*words, "tau_model_nm,friction=fit,scale=1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"torque_nm = -0\.(39|40?)\d* \[.*: the simulation has too much of it")
        write(0.012)  # viscous friction is missing as well, and the step of the other is bent towards it
        done = self.run_tool(*words, "tau_model_nm,friction=fit,scale=1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("has too little of it", done.stdout)

    def test_a_friction_below_0_that_is_accepted_is_taken_into_the_model(self):
        self.write_with_friction(1.3)
        done = self.run_tool("diagnose", "rubs.csv", "--gear-ratio", "100", "--simulated", "tau_model_nm", "--accept",
                             "coulomb-friction", "-o", "improved.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"accepted by you .*: coulomb-friction, torque_nm = -0\.4")
        self.assertLess(self.residual_nm("--model", "improved.json", "rubs.csv"), 0.06)

    def test_of_a_simulation_with_the_right_friction_no_error_is_told(self):
        self.write_with_friction(0.9, payload=1.0)
        done = self.run_tool("diagnose", "rubs.csv", "--gear-ratio", "100", "--simulated", "tau_model_nm,friction=fit")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "simulated: coulomb-friction, .*: whether it has too much or too little is not told")
        self.assertIn("named: nothing", done.stdout)

    def test_friction_of_a_simulation_is_fitted_once_and_by_diagnose_alone(self):
        model = {"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [{"effect": "coulomb-friction", "torque_nm": 0.5}]}
        (self.path / "model.json").write_text(json.dumps(model))
        done = self.run_tool("diagnose", "log.csv", "--model", "model.json", "--simulated", "tau_model_nm,friction=fit")
        self.assertEqual(done.returncode, 2)
        self.assertIn("leave its torque_nm out there", done.stderr)
        done = self.run_tool("simulate", "log.csv", "--gear-ratio", "100", "--simulated", "tau_model_nm,scale=1,friction=fit")
        self.assertEqual(done.returncode, 2)
        self.assertIn("simulated.friction", done.stderr)
        done = self.run_tool("diagnose", "log.csv", "--gear-ratio", "100", "--simulated", "tau_model_nm,friction=yes")
        self.assertEqual(done.returncode, 2)
        self.assertIn("fit", done.stderr)

    def test_simulate_takes_a_simulation_whose_scale_is_stated(self):
        words = ["--gear-ratio", "100", "--effect", "coulomb-friction,torque_nm=0.9,width_deg_s=1"]
        left = self.residual_nm(*words, "--simulated", "column,name=tau_model_nm,scale=1", "log.csv")
        alone = self.residual_nm(*words, "log.csv")
        self.assertLess(left, 0.2 * alone)
        done = self.run_tool("simulate", *words, "--simulated", "column,name=tau_model_nm", "log.csv")
        self.assertEqual(done.returncode, 2)
        self.assertIn("simulated.scale", done.stderr)
        done = self.run_tool("simulate", *words, "--simulated", "column,name=tau", "--motion", "rest,duration=1s", "--sample-rate",
                             "100Hz")
        self.assertEqual(done.returncode, 2)

    def test_a_simulation_in_a_file_of_its_own_is_named_again_beside_the_model(self):
        written(self.path / "sim.csv", ["time_s", "velocity_deg_s", "torque_nm"], [[t, v, arm_nm(t, q, 1.0)] for t, v, _, q in self.rows])
        own = "log,file=sim.csv,column=torque_nm"
        done = self.run_tool("diagnose", "log.csv", "--simulated", own, "--gear-ratio", "100", "--json", "-o", "own.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        left = self.residual_nm("--model", "own.json", "--simulated", own, "log.csv")
        self.assertAlmostEqual(left / json.loads(done.stdout)["gap"]["after_nm"], 1.0, delta=1e-4)
        done = self.run_tool("simulate", "--model", "own.json", "--simulated", own + ",scale=1", "log.csv")
        self.assertEqual(done.returncode, 2)
        self.assertIn("the model states its scale", done.stderr)

    def test_ripple_is_found_in_measured_minus_simulated(self):
        motion = [word for lap in range(4) for to, s in ((150, 2.2), (-150, 4), (0, 1.6))
                  for word in ("--motion", f"poly6,to={to}deg,duration={s}s")]
        done = self.run_tool("simulate", "--gear-ratio", "100", "--ripple", "1:0.3Nm:20deg", "--ripple", "2:0.4Nm:50deg", *motion,
                             "--sample-rate", "1kHz", "--noise", "0.05Nm", "--seed", "1", "-o", "ripple.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path / "ripple.csv") as file:
            rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
        # A simulation that knows of the ripple's neighbours: teeth that mesh 231 times a turn, 8 Nm.
        def teeth(t, q):
            return arm_nm(t, q, 1.0) + 8 * math.cos(math.radians(231 * q))
        written(self.path / "log.csv", ["time_s", "velocity_deg_s", "torque_nm", "position_deg", "tau_model_nm"],
                [[t, v, tau + 1.1 * teeth(t, q), q, teeth(t, q)] for t, v, tau, q in rows], )
        # A scale that is fitted is a thousandth off, and so is what is left of the teeth.
        for words, left_nm in ((["--simulated", "column,name=tau_model_nm"], 0.02), (["--residual", "with.json"], 0.0)):
            (self.path / "with.json").write_text(json.dumps({"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [],
                                                             "simulated": {"column": "tau_model_nm", "scale": 1.1}}))
            done = self.run_tool("identify", "log.csv", *words, "--json", "-q")
            self.assertEqual(done.returncode, 0, done.stderr)
            lines = json.loads(done.stdout)["lines"]
            found = {round(line["order_output"]): line["amplitude_nm"] for line in lines if line["order_output"]}
            self.assertLessEqual({100, 200}, set(found))
            self.assertLessEqual(found.get(231, 0.0), left_nm)
        done = self.run_tool("identify", "log.csv", "--json", "-q")
        self.assertIn(231, [round(line["order_output"]) for line in json.loads(done.stdout)["lines"] if line["order_output"]])

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

    def test_a_name_alone_is_that_of_a_column(self):
        ratio = ["--gear-ratio", "100", "--json"]
        for more in ("", ",scale=1"):
            short, long = (self.run_tool("diagnose", "log.csv", "--simulated", simulated + more, *ratio)
                           for simulated in ("tau_model_nm", "column,name=tau_model_nm"))
            self.assertEqual(short.returncode, 0, short.stderr)
            self.assertEqual(json.loads(short.stdout)["gap"], json.loads(long.stdout)["gap"])

    def test_refusals_say_what_is_wrong(self):
        ratio = ["--gear-ratio", "100"]
        for words, code, part in (
                (["--simulated", "column,name=tau", *ratio], 2, "no column 'tau'"),
                (["--simulated", "column,name=torque_nm", *ratio], 3, "is the measured torque"),
                (["--simulated", "column,name=tau_model_nm"], 2, "--gear-ratio is missing"),
                (["--simulated", "tau", *ratio], 2, "no column 'tau'"),
                (["--simulated", "log.csv", *ratio], 2, "--simulated log,file=log.csv,column=NAME"),
                (["--simulated", "colum,name=tau_model_nm", *ratio], 2, "neither column,name=NAME nor log"),
                (ratio, 2, "--model is missing")):
            done = self.run_tool("diagnose", "log.csv", *words)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(part, done.stderr)


if __name__ == "__main__":
    unittest.main()
