# SPDX-License-Identifier: MIT
"""Logs made of what a real robot's log lends."""

import unittest

import prove  # noqa: F401, first: it skips without numpy
import numpy as np
from prove_diagnose.semi import cases, chain, real, table


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
    def test_kinds_are_planned_on_every_robot_and_bars_count_what_they_say(self):
        planned = cases.planned(2, 40)
        self.assertEqual(len({case.name for case in planned}), len(planned))
        rows = [{"case": f"semi-a-{k}", "label": "ripple", "sizes": [size], "least": size, "exact": right, "false": [],
                 "named": ["ripple 1"] if right else [], "offered": right, "parameters": [{"beyond": 0.5}]}
                for k, (size, right) in enumerate(((0.8, False), (2.0, True), (3.0, True)))]
        lines = {line[0]: line for line in table.bar_lines(rows)}
        self.assertIn("2/3", lines["names exactly right, each hidden effect at least 0.7 times the residual"][2])
        self.assertIn("2/2", lines["the same, each 1.5 times or more"][2])
        self.assertIn("3/3", lines["95 % interval covers the truth"][2])
