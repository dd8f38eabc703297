# SPDX-License-Identifier: MIT
"""The generator and the tool's catalogue are two programs; each draws every effect of the other."""

import dataclasses
import json
import subprocess
import unittest

import prove  # first: it skips without numpy
import numpy as np
from prove_diagnose import cases, joint


class Agreement(unittest.TestCase):
    def test_every_effect_of_the_catalogue_is_drawn(self):
        listed = subprocess.run([prove.TOOL, "diagnose", "--effects", "--json"], capture_output=True, check=True, timeout=60).stdout
        names = {effect["effect"] for effect in json.loads(listed)["effects"]}
        rng = np.random.default_rng(1)
        always = {effect["effect"] for effect in joint.base_joint(rng)}
        with_simulation = {"simulation-scale"}  # nothing without a simulation, which these logs do not have
        drawn = {joint.draw(rng, label)["effect"] for label in (*joint.HIDDEN, *joint.FURTHER, *joint.RARER)}
        self.assertEqual(names - drawn - always - with_simulation, set(), "formula and strength are missing: scripts/prove_diagnose/joint.py")
        self.assertEqual((drawn | always) - names, set(), "drawn by scripts/prove_diagnose/joint.py, and no effect")

    def test_every_effect_that_can_be_drawn_changes_the_log(self):
        for study in ("single", "rarer"):
            for case in cases.studies(study, 1):
                log, plain = case.log("train"), dataclasses.replace(case, hidden=()).log("train")
                changed = [np.max(np.abs(a - b)) for a, b in ((log.torque_nm, plain.torque_nm),
                                                              (log.velocity_deg_s, plain.velocity_deg_s))]
                self.assertGreater(max(changed), 0.015, case.label)
