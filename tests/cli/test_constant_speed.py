# SPDX-License-Identifier: MIT
"""Logs of a bench that hold a torque and no motion: what needs none, and a constant speed that is stated."""

import json
import math
import random

from commands import DATA
from test_gear_methods import Case

STATED = ["--constant-speed", "10rpm"]  # 60 deg/s: order 1 of a gear of 100 at 16.67 Hz


class TorqueOnly(Case):
    def setUp(self):
        super().setUp()
        draw = random.Random(4)
        with open(self.folder / "bench.csv", "w", encoding="utf-8") as file:
            file.write("time_s,torque_Nm\n")
            for k in range(6000):
                ripple = 0.8 * math.cos(2 * math.pi * 100 * 60 / 360 * k / 1000)
                file.write(f"{k / 1000:.3f},{5 + ripple + draw.gauss(0, 0.05):.5f}\n")

    def json_of(self, *words):
        return json.loads(self.good(*words, "--json").stdout)

    def test_frequencies_and_filters_of_one_design_need_no_motion(self):
        for words in [], ["--segment", "2s"]:
            spectrum = self.json_of("spectrum", "bench.csv", *words)["spectra"][0]
            self.assertAlmostEqual(spectrum["peaks"][0]["hz"], 100 / 6, delta=0.02)
            self.assertIsNone(spectrum["speed_deg_s"])
        for method in "lowpass,cutoff=10Hz", "fixed,centers=16.67Hz", "none":
            self.good("filter", "bench.csv", "--method", method, "-o", "out.csv", "--force")
        header, first = (self.folder / "out.csv").read_text().split("\n")[:2]
        self.assertEqual((header, first.split(",")[0]), ("time_s,torque_Nm", "0.000"))

    def test_what_needs_motion_names_the_option(self):
        for words in (["identify"], ["spectrum", "--track", "--gear-ratio", 100], ["spectrum", "--domain", "order"],
                      ["filter", "--method", "tracking,gear-ratio=100"], ["map", "--gear-ratio", 100]):
            done = self.run_tool(words[0], "bench.csv", *words[1:])
            self.assertEqual(done.returncode, 3, words)
            self.assertIn("expected a velocity column", done.stderr)
            self.assertIn("--constant-speed 60rpm", done.stderr)
        self.assertIn("--constant-speed", self.good("info", "bench.csv").stdout)

    def test_a_stated_speed_stands_for_the_motion_and_is_on_record(self):
        found = self.json_of("identify", "bench.csv", *STATED)
        self.assertAlmostEqual(found["lines"][0]["order_output"], 100, delta=0.1)
        said = found["recording"]["inferences"][0]
        self.assertEqual((said["about"], said["assumed"]), ("velocity", "60 deg/s throughout"))
        line = self.json_of("spectrum", "bench.csv", "--track", *STATED, "--gear-ratio", 100, "--orders", 1)["lines"][0]
        self.assertAlmostEqual(line["ripple"]["amplitude_nm"], 0.8, delta=0.01)
        told = self.json_of("recommend", "bench.csv", *STATED, "--gear-ratio", 100, "--orders", 1)
        self.assertEqual(told["finding"], "recommended")
        self.assertTrue(all("--constant-speed 60deg/s" in command for command in told["take_commands"] if "bench.csv" in command))
        self.good("filter", "bench.csv", *STATED, "--method", "tracking,gear-ratio=100,orders=1", "-o", "out.csv")
        self.assertEqual((self.folder / "out.csv").read_text().split("\n")[0], "time_s,torque_Nm")

    def test_of_the_motor_it_is_divided_by_the_ratio(self):
        motor = ["--constant-speed", "1000rpm", "--side", "motor"]
        line = self.json_of("spectrum", "bench.csv", "--track", *motor, "--gear-ratio", 100, "--orders", 1)["lines"][0]
        self.assertAlmostEqual(line["ripple"]["amplitude_nm"], 0.8, delta=0.01)
        done = self.run_tool("identify", "bench.csv", *motor)
        self.assertEqual((done.returncode, "needs --gear-ratio" in done.stderr), (2, True), done.stderr)

    def test_a_log_with_motion_refuses_it(self):
        done = self.run_tool("identify", DATA / "paper_90deg_s.csv", *STATED)
        self.assertEqual((done.returncode, "leave it out" in done.stderr), (2, True), done.stderr)

    def test_each_of_several_logs_has_its_speed(self):
        text = (self.folder / "bench.csv").read_text()
        (self.folder / "other.csv").write_text(text)
        found = self.json_of("identify", "bench.csv", "other.csv", "--constant-speed", "10rpm,10rpm")
        self.assertAlmostEqual(found["lines"][0]["order_output"], 100, delta=0.1)
        for words in (["identify", "bench.csv", "--constant-speed", "10rpm,20rpm"], ["spectrum", "bench.csv", "--constant-speed", "10rpm,20rpm"]):
            done = self.run_tool(*words)
            self.assertEqual((done.returncode, "read 2 speeds" in done.stderr), (2, True), done.stderr)

    def test_filters_of_one_design_are_compared_without_motion(self):
        methods = ["--method", "lowpass,cutoff=10Hz", "--method", "fixed,centers=16.67Hz"]
        told = self.good("compare", "bench.csv", *methods).stdout
        self.assertIn("Settling and delays: on a step", told)
        done = self.run_tool("compare", "bench.csv", "--method", "tracking,gear-ratio=100")
        self.assertIn("expected a velocity column", done.stderr)
        uses = {use["name"]: use["possible"] for use in self.json_of("info", "bench.csv")["uses"]}
        self.assertEqual((uses["spectrum"], uses["filter"], uses["identify"]), (True, True, False))
