# SPDX-License-Identifier: MIT
"""A short case of each study of the proof; all of it is scripts/prove-diagnose. See docs/studies."""

import unittest

import prove  # first: it skips without numpy

prove.skip_unless_command("diagnose")

# Every effect is hidden in the tests of `diagnose`, by the tool's own catalogue; these two by the other program.
ALONE = ("coulomb-friction", "gear-ratio")


class Part(unittest.TestCase):
    def exact(self, rows, count):
        self.assertEqual(len(rows), count)
        self.assertEqual([(row["case"], row["named"]) for row in rows if not row["exact"]], [])
        self.assertEqual([row["case"] for row in rows if row["gap"]["as_said"] is False], [])

    def test_an_effect_hidden_alone_is_named_and_the_improved_model_does_on_another_log_what_was_said(self):
        self.exact(prove.rows(self, "single", 1, ALONE), 2)

    def test_two_hidden_effects_are_named(self):
        self.exact(prove.rows(self, "pair", 3, first=1), 3)

    @unittest.expectedFailure  # saturation alone is named
    def test_friction_behind_a_clipped_torque_is_named(self):
        self.exact(prove.rows(self, "pair", 1), 1)

    def test_nothing_hidden_nothing_named(self):
        rows = [row for row in prove.rows(self, "null", 1) if "-t4-" not in row["case"]]
        self.assertEqual((len(rows), [(row["case"], row["named"]) for row in rows if row["named"]]), (6, []))

    @unittest.expectedFailure  # spikes are named, in 6 of 6 such logs
    def test_noise_with_heavy_tails_is_no_spikes(self):
        rows = [row for row in prove.rows(self, "null", 1) if "-t4-" in row["case"]]
        self.assertEqual([row["named"] for row in rows], [[]])

    def test_what_is_in_no_catalogue_has_no_name_and_what_is_in_all_of_the_log_is_reported(self):
        rows = prove.rows(self, "outside", 1, ("noise burst", "random wander"))
        self.assertEqual((len(rows), [(row["case"], row["named"]) for row in rows if row["named"]]), (2, []))
        self.assertEqual([row["place"] for row in rows if "wander" in row["case"]], [True])

    @unittest.expectedFailure  # nothing is reported, in 8 of 8 such logs
    def test_a_burst_of_noise_is_reported_where_it_is(self):
        self.assertEqual([row["place"] for row in prove.rows(self, "outside", 1, ("noise burst",))], [True])
