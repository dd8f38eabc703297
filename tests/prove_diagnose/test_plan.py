# SPDX-License-Identifier: MIT
"""Logs that end undecided, and the motion that diagnose --plan asks for; all of it is scripts/prove-diagnose --study plan."""

import unittest

import numpy

from commands import new_folder
import prove  # first: it skips without numpy

prove.skip_unless_command("diagnose")

from prove_diagnose import motion, planned  # noqa: E402


class Rows(unittest.TestCase):
    def test_a_motion_read_back_from_its_rows_is_that_motion(self):
        travel = motion.Motion(10.0).rest(0.5).stroke(80.0, 2.0).rest(0.5)
        time = numpy.arange(0.0, 3.0, 0.002)
        q, v, _ = travel.at(time)
        path = new_folder(self) / "plan.csv"
        numpy.savetxt(path, numpy.column_stack([time, q, v]), delimiter=",", header="time_s,position_deg,velocity_deg_s", comments="")
        rows = planned.Rows(path)
        between = time[:-1] + 0.0007
        for found, true, most in zip(rows.at(between), travel.at(between), (1e-6, 1e-3, 2.0)):
            self.assertLess(numpy.max(numpy.abs(found - true)), most)


class Plan(unittest.TestCase):
    def test_what_a_poor_motion_leaves_open_is_decided_along_the_planned_one(self):
        rows = prove.rows(self, "plan", 1, ("coulomb-friction",))
        self.assertEqual(len(rows), len(planned.POOR))
        undecided = [row for row in rows if row["undecided"]]
        self.assertTrue(undecided)
        self.assertEqual([row for row in undecided if not row["decided"] or not row["exact"]], [])
        self.assertTrue(all(row["duration_s"] <= 30.0 for row in undecided))
