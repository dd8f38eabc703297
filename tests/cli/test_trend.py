# SPDX-License-Identifier: MIT
"""ripplenotch trend: what it finds in simulated histories, and what it leaves alone."""

import json
import os
import random
import subprocess
import sys
import unittest

import commands
from commands import SOURCE, TOOL, ended, run, sanitized
import fleet


def trend(*words, text=None):
    return run("trend", *words, stdin=text)


def text_of(lines):
    return "".join(json.dumps(line) + "\n" for line in lines)


class Case(commands.Case):
    def trend(self, lines, *words):
        done = ended(0, trend("-", "--json", *words, text=text_of(lines)))
        return json.loads(done.stdout)


def lines_of(made):
    return [line for joint in made for line in joint.lines]


class Findings(Case):
    def test_events_are_found_named_dated_and_sized(self):
        made = fleet.fleet(16, 52, 5, events=True, logs_after=8)
        told = self.trend(lines_of(made))
        named = 0
        for joint in made:
            alerts = [alert for alert in told["alerts"] if alert["robot"] == joint.robot]
            self.assertTrue(alerts, joint.event.words)
            right = [alert for alert in alerts if alert["descriptor"] in joint.event.descriptors]
            named += bool(right)
            self.assertTrue(any(joint.logs_between(joint.event.day, alert["date"]) <= 1 for alert in alerts), joint.event.words)
        self.assertGreaterEqual(named, 15)
        sizes = [alert["percent"] for alert in told["alerts"] if alert["descriptor"] == "ripple_2_amplitude_nm"]
        self.assertTrue(all(16 < size < 24 for size in sizes), sizes)

    def test_joints_to_which_nothing_happens_raise_no_more_than_the_rate(self):
        # 60 joints, 11.5 months each: 0.7 alerts are to be expected at most; 4 or more would be 1 in 170.
        told = self.trend(lines_of(fleet.fleet(60, 52, 77, events=False)))
        self.assertLess(len(told["alerts"]), 4)
        self.assertAlmostEqual(told["expected_false_alarms"], 0.001 * told["joint_months"], delta=1e-4)

    def test_warmth_that_is_not_told_is_no_wear_where_it_is_told(self):
        made = fleet.fleet(10, 52, 9, events=False)
        lines = lines_of(made)
        slopes = [abs(one["slope_per_month"] / one["baseline"]) for one in self.trend(lines)["descriptors"]
                  if one["descriptor"] == "viscous_friction_nm_per_deg_s"]
        self.assertLess(max(slopes), 0.01)

    def test_a_slow_drift_is_a_drift(self):
        made = fleet.fleet(4, 52, 11, events=False)
        for joint in made:
            for week, line in enumerate(joint.lines):
                if line["coulomb_friction_nm"] is not None:
                    factor = 1 + 0.2 * week / len(joint.lines)
                    line["coulomb_friction_nm"] *= factor
                    line["coulomb_friction_ci95_nm"] = [factor * end for end in line["coulomb_friction_ci95_nm"]]
        told = self.trend(lines_of(made))
        for joint in made:
            kinds = [(alert["kind"], alert["descriptor"]) for alert in told["alerts"] if alert["robot"] == joint.robot]
            self.assertEqual(kinds[:1], [("drift", "coulomb_friction_nm")])

    def test_two_changes_of_one_joint_are_two_alerts(self):
        joint, = fleet.fleet(1, 52, 12, events=False)
        for week, line in enumerate(joint.lines):
            if week >= 15 and line["coulomb_friction_nm"] is not None:
                line["coulomb_friction_nm"] += 0.8
                line["coulomb_friction_ci95_nm"] = [end + 0.8 for end in line["coulomb_friction_ci95_nm"]]
            if week >= 30 and line["ripple_1_phase_deg"] is not None:
                for name in ("ripple_1_phase", "ripple_2_phase"):
                    if line[name + "_deg"] is not None:
                        line[name + "_deg"] += 60
                        line[name + "_ci95_deg"] = [end + 60 for end in line[name + "_ci95_deg"]]
        signs = [alert["descriptor"] for alert in self.trend(joint.lines)["alerts"]]
        self.assertEqual(len(signs), 2, signs)
        self.assertEqual(signs[0], "coulomb_friction_nm")
        self.assertIn("phase", signs[1])

    def test_another_gear_is_named(self):
        joint, = fleet.fleet(1, 52, 13, events=False)
        for line in joint.lines[30:]:
            if line["gear_ratio"] is not None:
                line["gear_ratio"] += 20
                line["gear_ratio_ci95"] = [end + 20 for end in line["gear_ratio_ci95"]]
        alert, *_ = self.trend(joint.lines)["alerts"]
        self.assertEqual(alert["descriptor"], "gear_ratio")

    def test_logs_of_another_motion_are_left_out_and_said_to_be(self):
        joint, = fleet.fleet(1, 52, 15, events=False)
        for line in joint.lines[20:24]:
            line["speed_p50_deg_s"] *= 20
        note = self.trend(joint.lines)["joints"][0]["notes"]
        self.assertIn("4 of", note)
        self.assertIn("cannot be compared", note)


class Example(Case):
    def test_the_example_of_the_pages_is_what_its_script_makes(self):
        done = subprocess.run([sys.executable, SOURCE / "tests/support/fleet.py"], capture_output=True, text=True)
        self.assertEqual((SOURCE / "data/fleet.ndjson").read_text(), done.stdout)


class Determinism(Case):
    def test_the_order_of_lines_and_files_does_not_matter(self):
        lines = lines_of(fleet.fleet(6, 40, 21, events=True))
        first = self.trend(lines)
        random.Random(1).shuffle(lines)
        second = self.trend(lines)
        a, b = self.folder / "a.ndjson", self.folder / "b.ndjson"
        a.write_text(text_of(lines[:50]))
        b.write_text(text_of(lines[50:]))
        third = json.loads(trend(b, a, "--json").stdout)
        for told in (first, second, third):
            told.pop("inputs"), told.pop("command")
        self.assertEqual(first, second)
        self.assertEqual(first, third)

    @unittest.skipIf(sanitized(TOOL), "sanitizers take their own time")
    def test_ten_thousand_lines_take_at_most_two_seconds_of_a_core(self):
        path = self.folder / "many.ndjson"
        path.write_text(text_of(lines_of(fleet.fleet(214, 52, 23, events=False))))
        self.assertGreater(path.read_text().count("\n"), 9800)
        before = os.times()
        done = trend(path, "-q")
        after = os.times()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(after.children_user - before.children_user, 6.0, "three times the bar, for slow machines")
