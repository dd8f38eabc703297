# SPDX-License-Identifier: MIT
"""The tool finds it, not its author: an effect that is taken out of the list leaves its place unexplained."""

import unittest

import prove  # first: it skips without numpy

prove.skip_unless_command("diagnose")

TAKEN_OUT = ("tone",)


class Without(unittest.TestCase):
    def test_its_place_is_told_and_no_other_name_takes_it(self):
        rows = prove.rows(self, "without", 1, TAKEN_OUT)
        self.assertEqual([row["label"] for row in rows], list(TAKEN_OUT))
        self.assertEqual([(row["case"], row["told"]) for row in rows if row["told"] < 0.5], [])
        self.assertEqual([(row["case"], row["named"]) for row in rows if row["named"]], [])
