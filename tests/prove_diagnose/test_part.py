# SPDX-License-Identifier: MIT
"""A short case of each study of the proof; all of it is scripts/prove-diagnose. See docs/studies."""

import commands  # noqa: F401  first: it runs a file that is started by hand
import unittest

import prove  # first: it skips without numpy

prove.skip_unless_command("diagnose")

# Every effect is hidden in the tests of `diagnose`, by the tool's own catalogue; these two by the other program.
ALONE = ("coulomb-friction", "gear-ratio")


class Part(unittest.TestCase):
    def test_an_effect_hidden_alone_is_named_and_the_improved_model_does_on_another_log_what_was_said(self):
        rows = prove.rows(self, "single", 1, ALONE) + prove.rows(self, "pair", 1)
        self.assertEqual(len(rows), len(ALONE) + 1)
        self.assertEqual([(row["case"], row["named"]) for row in rows if not row["exact"]], [])
        self.assertEqual([row["case"] for row in rows if row["false"]], [])
        self.assertEqual([row["case"] for row in rows if row["gap"]["as_said"] is False], [])

    def test_nothing_hidden_nothing_named(self):
        self.assertEqual([(row["case"], row["named"]) for row in prove.rows(self, "null", 1) if row["named"]], [])

    def test_what_is_in_no_catalogue_is_reported_where_it_is_and_under_no_name(self):
        rows = prove.rows(self, "outside", 1, ("noise burst", "random wander"))
        self.assertEqual(len(rows), 2)
        self.assertEqual([(row["case"], row["named"]) for row in rows if row["named"] or not row["place"]], [])
