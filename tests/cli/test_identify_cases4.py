# SPDX-License-Identifier: MIT
"""identify on logs in the layouts that people have, whose truth is known: ../shared/cases-4, section 2. Gear 100 where nothing
else is said, order 1 of 0.8 Nm and order 2 of 0.5 Nm zero to peak."""

import json
import unittest

from commands import LOGS, Case

CASES = LOGS.parent / "cases-4"


@unittest.skipUnless(CASES.is_dir(), "no logs of ../shared/cases-4")
class CasesOfUsers(Case):
    def answered(self, name, *words):
        done = self.run_tool("identify", "--json", "-q", CASES / f"{name}.csv.gz", *words)
        self.assertIn(done.returncode, (0, 5), done.stderr)
        return json.loads(done.stdout)

    def assert_line(self, found, field, value, amplitude, tolerance=0.01):
        """A line within a tolerance of its place, and its amplitude within a tenth."""
        near = [line["amplitude_nm"] for line in found["lines"] if line[field] is not None and abs(line[field] / value - 1.0) <= tolerance]
        self.assertTrue(near, f"no line at {value}: {found['verdict']}")
        self.assertAlmostEqual(max(near) / amplitude, 1.0, delta=0.1)

    def test_a_tone_at_rest(self):
        self.assert_line(self.answered("tone7_at_rest"), "hz", 7.0, 0.6)

    @unittest.expectedFailure  # A line whose amplitude changes within a sweep by more than 40 % is lost.
    def test_an_amplitude_that_grows_with_speed(self):
        found = self.answered("ripple_grows_with_speed")
        for order in (100.0, 200.0):
            self.assertTrue(any(abs((line["order_output"] or 0.0) / order - 1.0) <= 0.01 for line in found["lines"]), found["verdict"])
        if found["conclusive"]:
            self.assertAlmostEqual(found["gear_ratio"]["value"], 100.0, delta=1.0)

    def test_the_strongest_order_of_a_motor(self):
        found = self.answered("motor_order42_no_ratio", "--side", "motor")
        self.assert_line(found, "order", 42.0, 0.12)
        self.assert_line(found, "order", 7.0, 0.06)
        self.assert_line(found, "hz", 87.0, 0.04)

    def test_a_stated_ratio_is_not_replaced(self):
        found = self.answered("belt_84_1666", "--gear-ratio", "84.1666")
        self.assert_line(found, "order_output", 100.0, 0.8)
        self.assert_line(found, "order_output", 200.0, 0.5)
        self.assertAlmostEqual(found["gear_ratio"]["value"], 84.1666, delta=0.1)
        self.assertIn("100", " ".join([found["verdict"], *map(str, found["doubts"])]))

    def test_lines_of_a_quantised_encoder_are_none(self):
        found = self.answered("dynamixel_12bit", "--scale", "torque=0.0033333Nm", "--scale", "velocity=0.229rpm", "--scale", "position=360deg/4096")
        self.assert_line(found, "order_output", 100.0, 0.8)
        self.assert_line(found, "order_output", 200.0, 0.5)
        self.assertEqual(len(found["lines"]), 2, found["verdict"])

    def test_which_of_three_torques(self):
        done = self.run_tool("identify", CASES / "three_torques.csv.gz")
        said = done.stdout + done.stderr
        self.assertIn("torque_sm_2", said)
        self.assertNotIn("No ripple", said)

    def test_a_line_alone_is_found(self):
        done = self.run_tool("identify", "--json", "-q", CASES / "phase_constant.csv")
        self.assert_line(json.loads(done.stdout), "order_output", 200.0, 0.3)

