# SPDX-License-Identifier: MIT
"""ripplenotch diagnose on logs of real robots, whose truth nobody knows: what must hold all the same."""

import json
import unittest

from commands import LOGS, Case

INERTIA = {"effect": "inertia"}
PAPER = [INERTIA, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]
KUKA_J6 = 206793 / 1340


@unittest.skipUnless(LOGS.is_dir(), "no logs of real robots here (RIPPLENOTCH_LOGS)")
class Robots(Case):
    def path(self, name):
        return self.folder / name

    def part(self, log, name, first, last, columns=None, step=1):
        """Rows of a log from the share `first` to the share `last`, in a file of their own; of `step` rows one."""
        header, *rows = [line.split(",")[:columns] for line in (LOGS / log).read_text().splitlines()]
        kept = rows[round(first * len(rows)):round(last * len(rows)):step]
        self.path(name).write_text("\n".join(",".join(row) for row in [header, *kept]) + "\n")
        return self.path(name)

    def diagnosed(self, log, validation, ratio, effects, *words):
        self.path("model.json").write_text(
            json.dumps({"schema": "ripplenotch/model/1", "gear_ratio": ratio, "effects": effects}))
        return json.loads(self.good("diagnose", log, "--model", self.path("model.json"), "--validate", validation, "--json", *words).stdout)

    def halves(self, log, columns=None, step=1):
        return (self.part(log, "train.csv", 0.0, 0.6, columns, step),
                self.part(log, "other.csv", 0.6, 1.0, columns, step))

    def check_no_false_story(self, found):
        """Whatever it says, rows that it never saw are not told worse, and what is left is admitted."""
        gap = found["gap"]
        self.assertLessEqual(gap["after_nm"], 1.001 * gap["before_nm"])
        self.assertLessEqual(gap["validation_after_nm"], 1.02 * gap["validation_before_nm"])
        self.assertNotIn("tone", found["named"])
        self.assertNotIn(found["verdict"], ("matches", "explained"))
        self.assertIsNotNone(found["remaining"])

    def test_an_arm_that_moves_as_a_whole_is_not_explained_by_one_joint(self):
        for joint in ("j1", "j4"):
            with self.subTest(joint):
                # Of two rows one: 287 Hz are fast enough for this arm, and half the work.
                logs = self.halves(f"gpl3/panda_gaz_{joint}.csv", step=2)
                self.check_no_false_story(self.diagnosed(*logs, 120, PAPER))

    def test_gravity_of_the_joint_that_moves_alone_is_found_and_holds_at_positions_that_were_never_seen(self):
        found = self.diagnosed(*self.halves("neura_lara8_j3.csv"), 101, [INERTIA])
        self.assertIn("gravity", found["named"])
        gap = found["gap"]
        self.assertLess(gap["after_nm"], 0.1 * gap["before_nm"])
        self.assertLess(gap["validation_after_nm"], 0.4 * gap["validation_before_nm"])
        self.check_no_false_story(found)

    def test_without_a_position_gravity_is_not_decidable_and_said_to_be(self):
        found = self.diagnosed(*self.halves("neura_lara8_j3.csv", 3), 101, [INERTIA])
        self.assertFalse(found["position_in_log"])
        self.assertNotIn("gravity", found["named"])
        self.assertIn("gravity", [entry["effect"] for entry in found["undecidable"]])

    def test_friction_of_the_wrist_is_told_with_what_it_is_worth_on_a_second_recording_and_not_believed(self):
        """Its size is not the same wherever it acts: the catalogue holds no friction of just this form."""
        logs = [LOGS / f"kuka_kr300_traj{name}_all.csv" for name in "AB"]
        found = self.diagnosed(*logs, KUKA_J6, [INERTIA], "--joint", "j6")
        friction = [entry for entry in found["rounds"] if entry["effect"].endswith("-friction")]
        self.assertGreater(len(friction), 0)
        self.assertLess(friction[0]["validation_after_nm"], 0.65 * friction[0]["validation_before_nm"])
        for entry in friction:
            self.assertTrue(entry["status"] == "confirmed" or entry["reason"])
        self.check_no_false_story(found)
