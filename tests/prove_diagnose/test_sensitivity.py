# SPDX-License-Identifier: MIT
"""Half and twice of a rule: which values are tried, and what is counted."""

import unittest

import prove  # first: it skips without numpy
from prove_diagnose import sensitivity


class Values(unittest.TestCase):
    def test_every_rule_of_the_program_is_read_with_its_bounds(self):
        rules = sensitivity.rules(prove.TOOL)
        self.assertGreater(len(rules), 100)
        for name, (value, lowest, highest, _) in rules.items():
            self.assertTrue(lowest <= value <= highest, name)
        self.assertEqual(rules["search.most_names"][3], True)
        self.assertEqual(rules["doubt.outgrown"], (0.7, 0.0, 100.0, False))

    def test_half_and_twice_stay_within_bounds_and_whole(self):
        self.assertEqual(sensitivity.moved((0.7, 0.0, 100.0, False), 2.0), 1.4)
        self.assertEqual(sensitivity.moved((0.7, 0.0, 1.0, False), 2.0), 1.0)
        self.assertEqual(sensitivity.moved((7.0, 1.0, 30.0, True), 0.5), 3)
        self.assertIsNone(sensitivity.moved((1.0, 1.0, 30.0, True), 0.5))
        self.assertIsNone(sensitivity.moved((0.0, -1.0, 1.0, False), 2.0))

    def test_the_table_marks_what_differs_from_the_program_as_it_is(self):
        sums = {(None, 1.0): (None, [3, 1, 0, 0]), ("a.b", 0.5): (0.2, [3, 1, 0, 0]), ("a.b", 2.0): (0.8, [2, 2, 1, 0])}
        line = sensitivity.text(sums, 4, {"a.b": (0.4, 0.0, 1.0, False)}).splitlines()[-1]
        self.assertEqual(line, "| a.b | 0.4 | 0.2 | 3/4 | 1 | 0 | 0.8 | **2/4** | **2** | **1** |")


prove.skip_unless_command("diagnose")


class Run(unittest.TestCase):
    def test_a_limit_above_every_torque_misses_what_is_hidden(self):
        done = prove.prove("--sensitivity", "--rule", "judge.material_sigma", "--option=--rule",
                           "--option=judge.material_sigma=10", "--option=--rule",
                           "--option=residual.least_left=100", "--study", "single", "--only", "viscous-friction", "--seeds", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        usual, moved = done.stdout.splitlines()[2:4]
        self.assertIn("| 0/1 | 1 | 0 |", usual)
        self.assertIn("| 0.06 | **1/1** | **0** | 0 |", moved)
