# SPDX-License-Identifier: MIT
"""The same log as other recorders write it, and logs made of what a real robot's log lends."""

import unittest

import prove  # first: it skips without numpy
import numpy as np
from prove_diagnose import cases, nulls, plan, recordings, reliability, score
from prove_diagnose.semi import cases as semi_cases, chain, real, table


def short(way):
    case = cases.Case("single", "offset", 4, hidden=("offset",), seconds=16.0)
    return plan.as_recorded(case, way)


class Recordings(unittest.TestCase):
    def test_a_way_of_recording_changes_what_is_written_and_nothing_that_is_true(self):
        plain = short("").log("train")
        for way in recordings.WAYS:
            with self.subTest(way):
                case = short(way)
                self.assertEqual(case.truth(), short("").truth())
                np.testing.assert_array_equal(case.log("train").torque_nm, plain.torque_nm)
                self.assertNotEqual(case.name, short("").name)

    def test_each_way_does_what_it_is_called(self):
        plain = short("").log("train")
        written = {way: recordings.recorded(plain, short(way), "train") for way in recordings.WAYS}
        self.assertIsNone(written["without position"].position_deg)
        self.assertAlmostEqual(np.mean(np.diff(written["250 Hz"].time_s)), 0.004)
        self.assertLess(np.max(np.abs(written["0.1 Nm steps"].torque_nm - plain.torque_nm)), 0.0501)
        jittered = written["jitter"]
        self.assertGreater(np.min(np.diff(jittered.time_s)), 0.0)
        self.assertAlmostEqual(len(jittered.time_s) / len(plain.time_s), 0.97, delta=0.01)

    def test_a_third_of_the_rows_repeats_the_row_before_under_its_own_stamp(self):
        plain = short("").log("train")
        rows, torques = (recordings.recorded(plain, short(way), "train") for way in ("held rows", "held torque"))
        for log in (rows, torques):
            np.testing.assert_array_equal(log.time_s, plain.time_s)
            held = np.diff(log.torque_nm) == 0
            self.assertAlmostEqual(np.mean(held), 1 / 3, delta=0.02)
        together = np.diff(rows.velocity_deg_s)[np.diff(rows.torque_nm) == 0]
        self.assertEqual(np.max(np.abs(together)), 0.0)
        np.testing.assert_array_equal(torques.velocity_deg_s, plain.velocity_deg_s)

    def test_coarse_steps_are_those_of_the_joint_in_both_of_its_logs(self):
        case, steps = short("coarse steps"), []
        for purpose in ("train", "validate"):
            torque = recordings.recorded(case.log(purpose), case, purpose).torque_nm
            steps.append(np.min(np.diff(np.unique(torque))))
        self.assertAlmostEqual(steps[0], steps[1], places=9)
        self.assertTrue(recordings.COARSE_NM[0] <= steps[0] <= recordings.COARSE_NM[1])

    def test_the_study_has_37_logs_with_something_hidden_and_finds_each_by_its_name(self):
        planned = [plan.as_recorded(case, "250 Hz") for case in plan.planned(["recorded"], 1, 30)]
        self.assertEqual(len({case.name for case in planned}), 37)
        self.assertTrue(all(case.hidden for case in planned))
        for case in planned[::6]:
            self.assertEqual(plan.by_name(case.name), case)


class Nulls(unittest.TestCase):
    def test_every_kind_has_nothing_hidden_and_is_found_by_its_name(self):
        planned = plan.planned(["nulls"], 2, 70)
        self.assertEqual(len({case.name for case in planned}), 2 * len(nulls.KINDS))
        self.assertEqual({case.hidden for case in planned}, {()})
        for case in planned:
            self.assertEqual(plan.by_name(case.name), case)

    def test_what_the_recorder_did_may_be_named_and_nothing_else(self):
        rounds = [{"effect": name, "status": "confirmed", "parameters": {}} for name in ("dropout", "offset")]
        found = {"named": ["dropout", "offset"], "rounds": rounds, "ambiguous": []}
        for way, false in (("held rows", ["offset"]), ("jitter", ["dropout", "offset"])):
            names = score.names(None, (), [], found, recordings.BROUGHT.get(way, ()))
            self.assertEqual(names["false"], false)

    def test_the_upper_bound_is_that_of_clopper_and_pearson(self):
        # 1 - 0.05^(1/300) by hand; 1 of 300: (1-p)^300 + 300 p (1-p)^299 = 0.05 at p = 0.0157.
        self.assertAlmostEqual(nulls.upper(0, 300), 1 - 0.05 ** (1 / 300), places=9)
        p = nulls.upper(1, 300)
        self.assertAlmostEqual((1 - p) ** 300 + 300 * p * (1 - p) ** 299, 0.05, places=9)
        self.assertEqual(nulls.upper(5, 5), 1.0)

    def test_bars_count_all_kinds_together(self):
        rows = [{"noise": kind.noise, "recorded": kind.recorded, "false": ["offset"] if (k, number) == (4, 0) else [],
                 "seconds": 1.0} for k, kind in enumerate(nulls.KINDS) for number in range(300)]
        self.assertEqual([line[-1] for line in nulls.bar_lines(rows)], ["yes", "yes"])
        self.assertEqual([line[-1] for line in nulls.bar_lines(rows[1200:1300])], ["**no**", "**no**"])
        self.assertEqual([line[1] for line in nulls.lines(rows)], ["300"] * len(nulls.KINDS) + [str(len(rows))])


class Reliability(unittest.TestCase):
    def test_names_are_counted_by_verdict_and_not_those_of_logs_that_are_parts_of_others(self):
        rows = [{"study": study, "verdict": "explained", "named": ["offset", "lag"], "false": ["lag"] * wrong, "told_wrong": 0.5}
                for study, wrong in (("single", 0), ("pair", 1), ("variant", 1), ("without", 1))]
        rows += [{"study": "null", "verdict": "matches", "named": [], "false": []}]
        lines = reliability.lines(rows)
        self.assertEqual(lines[0], ["explained", "2", "4", "1", "25.0 %", "4.6 to 69.9 %", "0.5 %", "**no**"])
        self.assertEqual(lines[1], ["matches", "1", "0", "-", "-", "-", "-", "-"])

    def test_a_told_chance_within_the_interval_of_the_counted_share_is_met(self):
        row = {"study": "single", "verdict": "explained", "named": ["offset"], "false": []}
        self.assertEqual(reliability.lines([{**row, "told_wrong": 0.5}] * 100)[0][-2:], ["0.5 %", "yes"])
        self.assertEqual(reliability.lines([{**row, "told_wrong": 5.0}] * 100)[0][-2:], ["5 %", "**no**"])
        # Names tested against a residual have a line of their own.
        lines = reliability.lines([{**row, "told_wrong": 0.5}] * 3 + [{**row, "told_wrong": None}] * 2)
        self.assertEqual([line[:3] for line in lines], [["explained", "3", "3"], ["explained, no chance stated", "2", "2"]])
        self.assertEqual(lines[1][-2:], ["-", "-"])


class Arm(unittest.TestCase):
    def test_one_link_is_a_pendulum(self):
        arm = chain.of_table("dh", [(0.0, 90.0, 0.0, 0.0)])
        rng = np.random.default_rng(1)
        q, dq, ddq = rng.standard_normal((3, 50, 1))
        # Mass 2 kg, 0.3 m out along x of the link; the joint turns about z, gravity is along -y of the base.
        values = np.zeros(10)
        values[[0, 1, 9]] = 2.0, 2.0 * 0.3, 2.0 * 0.3**2
        torque = chain.regressor(arm, q, dq, ddq, (0, -9.81, 0))[:, 0] @ values
        np.testing.assert_allclose(torque, (0.18 * ddq + 2.0 * 0.3 * 9.81 * np.cos(q))[:, 0], atol=1e-12)

    def test_power_is_the_change_of_energy(self):
        arm = chain.of_table("mdh", [(0, 0, 0.3, 10), (0.1, -90, 0.05, 0), (0.4, 20, 0.0, 30)])
        time = np.arange(0, 2, 1e-4)
        q = np.stack([0.5 * np.sin((1 + k) * time) for k in range(3)], 1)
        dq, ddq = np.gradient(q, time, axis=0), np.gradient(np.gradient(q, time, axis=0), time, axis=0)
        values = np.tile([1.5, 0.1, -0.05, 0.2, 0.08, 0.01, -0.005, 0.07, 0.004, 0.05], 3)
        power = np.sum((chain.regressor(arm, q, dq, ddq) @ values) * dq, 1)
        work = np.concatenate([[0.0], np.cumsum((power[1:] + power[:-1]) / 2 * 1e-4)])
        # Twice the kinetic energy is the inertial torque at the acceleration dq and no speed, times dq; what is left of the
        # work when the arm is as fast as at the start, at the same place, is nothing.
        kinetic = 0.5 * np.sum((chain.regressor(arm, q, 0 * q, dq, (0, 0, 0)) @ values) * dq, 1)
        weight = np.sum((chain.regressor(arm, q, 0 * q, 0 * q) @ values) * dq, 1)
        lifted = np.concatenate([[0.0], np.cumsum((weight[1:] + weight[:-1]) / 2 * 1e-4)])
        inside = slice(5, -5)
        np.testing.assert_allclose((work - kinetic - lifted)[inside], (work - kinetic - lifted)[5], atol=2e-3)

    def test_a_low_pass_keeps_what_is_slow_in_place_and_takes_what_is_fast(self):
        time = np.arange(0, 4, 1e-3)
        slow, fast = np.sin(2 * np.pi * time), np.sin(2 * np.pi * 60 * time)
        np.testing.assert_allclose(real.low_pass(slow + fast, 10.0, 1000.0)[500:-500], slow[500:-500], atol=1e-3)


class Scores(unittest.TestCase):
    def test_the_numbers_of_several_runs_are_told_with_their_gaps(self):
        def cases(*numbers):
            return [{"case": f"semi-a-ripple-{k}"} for k in numbers]
        self.assertEqual(table.numbers_told(cases(7, 5, 6, 5)), "5 to 7")
        self.assertEqual(table.numbers_told(cases(5, 6, 18, 20, 21)), "5 to 6 and 18 and 20 to 21")
        self.assertEqual(table.numbers_told([]), "none")

    def test_kinds_are_planned_on_every_robot_and_bars_count_what_they_say(self):
        planned = semi_cases.planned(2, 40)
        self.assertEqual([semi_cases.by_name(case.name) for case in planned], planned)
        for unknown in ("semi-ur10-nonesuch-40", "semi-ur10-drift", "single-drift-40"):
            with self.assertRaisesRegex(SystemExit, "there is no semi-synthetic case"):
                semi_cases.by_name(unknown)
        self.assertEqual(len({case.name for case in planned}), len(planned))
        rows = [{"case": f"semi-a-{k}", "label": "ripple", "sizes": [size], "least": size, "exact": right, "false": [],
                 "named": ["ripple 1"] if right else [], "offered": right, "parameters": [{"beyond": 0.5}]}
                for k, (size, right) in enumerate(((0.8, False), (2.0, True), (3.0, True)))]
        lines = {line[0]: line for line in table.bar_lines(rows)}
        self.assertIn("2/3", lines["names exactly right, each hidden effect at least 0.7 times the residual"][2])
        self.assertIn("2/2", lines["the same, each 1.5 times or more"][2])
        self.assertIn("3/3", lines["95 % interval covers the truth"][2])
