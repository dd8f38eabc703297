# SPDX-License-Identifier: MIT
"""Effects of a size in units of the noise, and the table of them; all of it is scripts/prove-diagnose --power."""

import unittest

import numpy

import prove  # first: it skips without numpy

prove.skip_unless_command("diagnose")

from prove_diagnose import joint, power, strengths  # noqa: E402


class Sizes(unittest.TestCase):
    def test_what_is_hidden_changes_the_torque_by_its_size(self):
        for case in power.chosen(1, 1, ("delay", "gravity", "saturation", "ripple-direction-dependence", "dropout")):
            sized, reached = power.of_size(case)
            self.assertEqual(len(sized.given), 1)
            self.assertAlmostEqual(reached / case.size, 1.0, delta=0.25 if case.label == "dropout" else 0.04, msg=case.name)

    def test_the_log_of_another_size_has_the_same_noise_and_motion(self):
        small, large = (power.of_size(case)[0] for case in power.chosen(2, 1, ("offset",)) if case.size in (0.1, 3.0))
        offsets = [case.given[0]["torque_nm"] for case in (small, large)]
        logs = [case.log("train") for case in (small, large)]
        self.assertTrue(numpy.array_equal(logs[0].position_deg, logs[1].position_deg))
        off = logs[1].torque_nm - logs[0].torque_nm - (offsets[1] - offsets[0])
        self.assertLess(numpy.max(numpy.abs(off)), 1e-9)
        self.assertAlmostEqual(abs(offsets[1]), 3.0 * strengths.TORQUE_NOISE_NM, delta=0.01)

    def test_every_effect_of_the_generator_but_errors_of_the_motion_has_a_size(self):
        labels = {joint.RARER[label](numpy.random.default_rng(1))["effect"] for label in joint.RARER}
        labels |= set(joint.HIDDEN) | set(joint.FURTHER)
        self.assertEqual(labels - set(power.SIZE), {"velocity-bias", "encoder-eccentricity"})


class Table(unittest.TestCase):
    def test_it_counts_what_is_named_and_tells_what_it_was_mistaken_for(self):
        rows = [{"label": "delay", "size": 0.4, "right": False, "offered": False, "false": ["resonance"]},
                {"label": "delay", "size": 0.4, "right": True, "offered": False, "false": []},
                {"label": "delay", "size": 3.0, "right": False, "offered": True, "false": []}]
        line = power.line("delay", rows)
        self.assertEqual(line, ["delay", "0/0", "0/0", "1/2", "0/0", "0/0", "0/1 +1", "resonance (1 at 0.4)"])
