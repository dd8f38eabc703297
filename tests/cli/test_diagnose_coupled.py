# SPDX-License-Identifier: MIT
"""diagnose --arm: the friction of a motor that turns with two joints, named on both and nowhere else."""

import json
import math
import random
import unittest

from commands import LOGS, SHORT, Case, ended
from logs import link_torques, links_at

TX40 = LOGS.parent / "benchmarks/tx40"
DEG = 180.0 / math.pi
DH, DOWN = "a_m,alpha_deg,d_m,theta_deg\n0.5,0,0,0\n0.4,0,0,0\n", "gravity=0:-9.81:0"
# Friction of each joint alone, and of the motor that turns with r v1 + s v2: Nm, Nm s/rad.
OWN, SHARED = ((1.2, 0.9), (0.8, 0.7)), (1.5, 1.1)


def write_log(path, seed, turns=None, seconds=30.0, rate=250.0, stribeck_nm=0.0):
    noise = random.Random(seed)
    with open(path, "w") as log:
        log.write("time_s," + ",".join(f"j{j}_{kind}" for j in (1, 2) for kind in
                                       ("position_deg", "velocity_deg_s", "torque_nm")) + "\n")
        for k in range(int(seconds * rate)):
            t = k / rate
            states = links_at(t, seed)
            cells = [f"{t:.4f}"]
            motor = sum(turn * state[1] for turn, state in zip(turns, states)) if turns else 0.0
            shared = SHARED[0] * math.tanh(motor * DEG) + SHARED[1] * motor
            for joint, (q, v, _) in enumerate(states):
                coulomb, viscous = OWN[joint]
                coulomb += stribeck_nm * math.exp(-(v * DEG / 7.0) ** 2)
                torque = link_torques(*states)[joint] + coulomb * math.tanh(v * DEG / 0.5) + viscous * v
                torque += (turns[joint] if turns else 0.0) * shared + noise.gauss(0.0, 0.05)
                cells += [f"{q * DEG:.6f}", f"{v * DEG + noise.gauss(0.0, 0.02):.5f}", f"{torque:.5f}"]
            log.write(",".join(cells) + "\n")


def shared_of(found):
    return [one for one in found["rounds"] if one["effect"] == "coupled-joint-friction"]


class Coupled(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "dh.csv").write_text(DH)

    def diagnosed(self, joint, *words):
        done = ended(0, self.run_tool("diagnose", "log.csv", "--joint", joint, "--arm", f"dh,file=dh.csv,{DOWN}",
                                      "--gear-ratio", "100", "--json", "-q", *words))
        return json.loads(done.stdout)

    def test_it_is_named_on_both_joints_with_the_ratio_of_either(self):
        for seed, turns in ((2, (1.0, -0.6)), (1, (1.0, 1.0)), (5, (0.8, 1.3)))[:1 if SHORT else 3]:
            write_log(self.folder / "log.csv", seed, turns)
            for joint, (own, other) in enumerate((turns, turns[::-1])):
                with self.subTest(turns=turns, joint=joint):
                    found = self.diagnosed(f"j{joint + 1}")
                    (shared,) = shared_of(found)
                    values = {name: one["value"] for name, one in shared["parameters"].items()}
                    self.assertEqual(found["model"]["effects"][-1].get("joint", 2 - joint), 2 - joint)
                    self.assertEqual(set(found["named"]), {"coupled-joint-friction", "coulomb-friction", "viscous-friction"})
                    self.assertAlmostEqual(values["ratio"] / (other / own), 1.0, delta=0.002)
                    self.assertAlmostEqual(values["width_deg_s"] * abs(own), 1.0, delta=0.05)
                    self.assertAlmostEqual(values["torque_nm"], abs(own) * SHARED[0], delta=0.01 * SHARED[0])
                    self.assertAlmostEqual(values["coefficient_nm_per_deg_s"] * DEG, own * own * SHARED[1], delta=0.01 * SHARED[1])
                    self.assertLess(found["gap"]["after_nm"], 0.051)

    def test_stribeck_friction_beside_it_is_named_with_it(self):
        write_log(self.folder / "log.csv", 9, (1.2, 0.9), stribeck_nm=0.8)
        for joint in ("j1", "j2"):
            with self.subTest(joint=joint):
                named = set(self.diagnosed(joint)["named"])
                self.assertEqual(named, {"coupled-joint-friction", "coulomb-friction", "viscous-friction", "stribeck-friction"})

    def test_joints_that_share_nothing_have_no_such_name(self):
        for seed in (3,) if SHORT else (3, 4, 6, 7):
            write_log(self.folder / "log.csv", seed)
            for joint in ("j1", "j2"):
                with self.subTest(seed=seed, joint=joint):
                    found = self.diagnosed(joint)
                    self.assertLessEqual({"coulomb-friction", "viscous-friction"}, set(found["named"]))
                    self.assertNotIn("coupled-joint-friction", json.dumps([found["named"], found["ambiguous"]]))

    def test_simulate_takes_the_other_joint_from_the_log_and_says_where_it_lacks_one(self):
        write_log(self.folder / "log.csv", 1, (1.0, 1.0), seconds=20.0)
        found = self.diagnosed("j1", "--improved-model", "improved.json")
        self.assertTrue(shared_of(found))
        again = json.loads(ended(0, self.run_tool("simulate", "log.csv", "--model", "improved.json", "-o", "again.csv", "--json", "-q")).stdout)
        self.assertAlmostEqual(again["along_log"]["residual_rms_nm"] / found["gap"]["after_nm"], 1.0, delta=1e-3)
        ended(2, self.run_tool("simulate", "--gear-ratio", "100", "--motion", "rest,duration=1s", "--sample-rate", "1kHz", "--effect",
                               "coupled-joint-friction,joint=2,ratio=1,torque_nm=1,coefficient_nm_per_deg_s=0"), "motion of joint 2 of the arm")

    @unittest.skipUnless((TX40 / "tx40_500hz.csv").is_file(), "the published log is not here")
    def test_the_wrist_of_a_published_log(self):
        # Published, with two standard deviations (FIGAROH, TX40_bp_5): Nm s/rad, Nm.
        published = {"viscous-friction": {"5": (1.854, 0.077), "6": (0.648, 0.023)}, "coulomb-friction": {"5": (3.041, 0.203)},
                     "shared": ((0.616, 0.022), (1.956, 0.152))}
        for joint, ratio, left_nm in (("5", 45, 1.3), ("6", 32, 0.7)):
            done = ended(0, self.run_tool("diagnose", str(TX40 / "tx40_500hz.csv"), "--arm", f"urdf,file={TX40 / 'tx40.urdf'}",
                                          "--gear-ratio", str(ratio), "--to", "7.45s", "--joint", joint, "--json", "-q"))
            found = json.loads(done.stdout)
            with self.subTest(joint=joint):
                self.assertLessEqual(set(found["named"]), {"ripple", "viscous-friction", "coulomb-friction", "coupled-joint-friction"})
                self.assertLessEqual(found["gap"]["after_nm"], left_nm)
                (shared,) = shared_of(found)
                checked = [(shared["parameters"]["coefficient_nm_per_deg_s"], published["shared"][0], DEG),
                           (shared["parameters"]["torque_nm"], published["shared"][1], 1.0)]
                for one in found["rounds"]:
                    if joint in published.get(one["effect"], {}):
                        value = next(iter(one["parameters"].values()))
                        checked.append((value, published[one["effect"]][joint], DEG if one["effect"].startswith("v") else 1.0))
                self.assertEqual(len(checked), 4 if joint == "5" else 3)
                for value, (truth, allowed), unit in checked:
                    low, high = (unit * edge for edge in value["ci95"])
                    self.assertTrue(low <= truth <= high or abs(unit * value["value"] - truth) <= allowed, (value, truth))
