# SPDX-License-Identifier: MIT
"""diagnose --arm: the rigid bodies of a whole arm from the torques of its joints, and names beside what they leave."""

import json
import math
import random
import unittest

from commands import LOGS, SHORT, Case, ended

# Two links that hang in a plane: lengths, masses at their ends (m, kg).
LENGTH, MASS, G = (0.5, 0.4), (4.0, 2.5), 9.81
DH = "a_m,alpha_deg,d_m,theta_deg\n0.5,0,0,0\n0.4,0,0,0\n"
DOWN = "gravity=0:-9.81:0"
UR10_DH = ("theta_deg,d_m,a_m,alpha_deg\n0,0.1273,0,90\n0,0,-0.612,0\n0,0,-0.5723,0\n0,0.163941,0,90\n"
           "0,0.1157,0,-90\n0,0.0922,0,0\n")


def motion(t, phase):
    """Angle, speed and acceleration in radians: two sines, so that speed and posture are not one another."""
    q = 0.9 * math.sin(1.1 * t + phase) + 0.5 * math.sin(2.3 * t)
    v = 0.99 * math.cos(1.1 * t + phase) + 1.15 * math.cos(2.3 * t)
    return q, v, -1.089 * math.sin(1.1 * t + phase) - 2.645 * math.sin(2.3 * t)


def torques(a, b):
    """Of two point masses in a plane, as every textbook has them."""
    (q1, v1, a1), (q2, v2, a2) = a, b
    (l1, l2), (m1, m2) = LENGTH, MASS
    inertia, coupling = m2 * l2 * l2, m2 * l1 * l2
    one = ((m1 + m2) * l1 * l1 + inertia + 2 * coupling * math.cos(q2)) * a1 + (inertia + coupling * math.cos(q2)) * a2
    one += -coupling * math.sin(q2) * (2 * v1 * v2 + v2 * v2)
    one += (m1 + m2) * G * l1 * math.cos(q1) + m2 * G * l2 * math.cos(q1 + q2)
    two = (inertia + coupling * math.cos(q2)) * a1 + inertia * a2 + coupling * math.sin(q2) * v1 * v1
    return one, two + m2 * G * l2 * math.cos(q1 + q2)


def joints_at(t, seed):
    one, (q, v, a) = motion(t, 0.3 * seed), motion(0.83 * t + seed, 1.0)
    return one, (q, 0.83 * v, 0.83 ** 2 * a)


def write_log(path, seed, coulomb_nm=0.0, seconds=30.0, rate=250.0, sign=(1, 1), delay_s=(0.0, 0.0)):
    noise = random.Random(seed)
    with open(path, "w") as log:
        log.write("time_s," + ",".join(f"j{j}_{kind}" for j in (1, 2) for kind in
                                       ("position_deg", "velocity_deg_s", "torque_nm")) + "\n")
        for k in range(int(seconds * rate)):
            t = k / rate
            cells = [f"{t:.4f}"]
            for joint, ((q, v, _), side, delay) in enumerate(zip(joints_at(t, seed), sign, delay_s)):
                then = joints_at(t - delay, seed)
                torque = torques(*then)[joint] + coulomb_nm * math.tanh(math.degrees(then[joint][1]) / 0.5)
                torque = side * (torque + noise.gauss(0.0, 0.05))
                cells += [f"{math.degrees(q):.6f}", f"{math.degrees(v) + noise.gauss(0.0, 0.02):.5f}", f"{torque:.5f}"]
            log.write(",".join(cells) + "\n")


class Arm(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "dh.csv").write_text(DH)

    def diagnosed(self, *words):
        done = ended(0, self.run_tool("diagnose", *words, "--gear-ratio", "100", "--json", "-q"))
        return json.loads(done.stdout)

    def test_friction_of_a_joint_is_named_beside_the_arm_and_the_gap_closes_on_another_log(self):
        write_log(self.folder / "log.csv", 1, coulomb_nm=1.2)
        write_log(self.folder / "other.csv", 2, coulomb_nm=1.2)
        arm = f"dh,file=dh.csv,{DOWN}"
        for joint in ("j1", "j2"):
            with self.subTest(joint=joint):
                found = self.diagnosed("log.csv", "--joint", joint, "--arm", arm, "--validate", "other.csv")
                self.assertEqual(found["named"], ["coulomb-friction"])
                size = found["rounds"][0]["parameters"]["torque_nm"]["value"]
                self.assertAlmostEqual(size, 1.2, delta=0.06)
                # Nobody is left to blame: noise of 0.05 Nm, and a little of the width of the friction's step.
                self.assertLess(found["gap"]["validation_after_nm"], 0.08)
                self.assertGreater(found["gap"]["validation_before_nm"], 0.8)
                self.assertEqual((found["arm"]["values_told"], found["arm"]["all_joints_at_once"]),
                                 (found["arm"]["values_there"], True))
                self.assertEqual([one["log"] for one in found["arm"]["joints"]], ["j1", "j2"])

    def test_the_picture_shows_what_is_left_beside_the_arm(self):
        write_log(self.folder / "log.csv", 1, coulomb_nm=1.2)
        found = self.diagnosed("log.csv", "--joint", "j2", "--arm", f"dh,file=dh.csv,{DOWN}", "--plot", "left.json")
        curves = {curve["name"]: curve["y"] for panel in json.loads((self.folder / "left.json").read_text())["panels"]
                  for curve in panel["curves"]}
        # Of 10 Nm the arm leaves friction, and friction leaves noise.
        self.assertLess(max(map(abs, curves["before"])), 3.0)
        self.assertLess(max(map(abs, curves["after"])), 8 * found["gap"]["after_nm"])
        self.assertLess(max(map(abs, curves["after"])), 0.6 * max(map(abs, curves["before"])))

    def test_a_wrong_set_up_is_reported_first_and_nothing_is_confirmed_with_it(self):
        for sign, gravity, fault, option in (((1, 1), "gravity=0:9.81:0", "gravity-direction", "gravity=0:-9.81:0"),
                                             ((1, 1), "gravity=0:0:-9.81", "gravity-direction", "gravity=0:-9.81:0"),
                                             ((1, -1), DOWN, "torque-sign", ""), ((-1, -1), DOWN, "torque-sign", "")):
            with self.subTest(sign=sign, gravity=gravity):
                write_log(self.folder / "log.csv", 1, coulomb_nm=1.2, sign=sign)
                found = self.diagnosed("log.csv", "--joint", "j2", "--arm", f"dh,file=dh.csv,{gravity}")
                self.assertEqual([(one["fault"], one["option"]) for one in found["setup"]], [(fault, option)])
                self.assertEqual((found["named"], found["verdict"]), ([], "unexplained"))
                self.assertIn("correct the set-up", found["next"][0])
        done = self.run_tool("diagnose", "log.csv", "--joint", "j2", "--arm", f"dh,file=dh.csv,{DOWN}", "--gear-ratio", "100", "-q")
        self.assertEqual(done.stdout.splitlines()[2], "Check the set-up: the torque of joints j1, j2 has its sign reversed: "
                                                      "friction would drive the arm.")

    def test_a_delay_of_the_torques_is_one_number_for_all_joints_and_no_name(self):
        write_log(self.folder / "log.csv", 1, coulomb_nm=1.2, delay_s=(0.012, 0.012))
        for joint in ("j1", "j2"):
            with self.subTest(joint=joint):
                found = self.diagnosed("log.csv", "--joint", joint, "--arm", f"dh,file=dh.csv,{DOWN}")
                lag = found["arm"]["lag"]
                self.assertAlmostEqual(lag["delay_s"], 0.012, delta=5e-4)
                self.assertEqual((lag["applied"], [one["contradicts"] for one in lag["joints"]]), (True, [False, False]))
                self.assertEqual(found["named"], ["coulomb-friction"])
                (delay,) = (one["delay_s"] for one in found["model"]["effects"] if one["effect"] == "delay")
                self.assertAlmostEqual(delay, lag["delay_s"], delta=1e-7)
                self.assertLess(found["gap"]["after_nm"], 0.08)

    def test_delays_that_differ_between_joints_are_not_confirmed(self):
        write_log(self.folder / "log.csv", 1, coulomb_nm=1.2, delay_s=(0.009, -0.013))
        for joint in ("j1",) if SHORT else ("j1", "j2"):
            found = self.diagnosed("log.csv", "--joint", joint, "--arm", f"dh,file=dh.csv,{DOWN}")
            self.assertFalse(found["arm"]["lag"]["applied"])
            self.assertNotIn("delay", found["named"])

    def test_without_the_arm_the_next_step_says_that_other_joints_move(self):
        write_log(self.folder / "log.csv", 1, coulomb_nm=1.2)
        (self.folder / "own.json").write_text('{"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [{"effect": "inertia"}]}')
        done = ended(0, self.run_tool("diagnose", "log.csv", "--joint", "j1", "--model", "own.json", "--json", "-q"))
        found = json.loads(done.stdout)
        self.assertIn("the log has 2 joints", found["next"][0])
        self.assertIn("--arm", found["next"][0])

    def test_an_arm_without_friction_has_no_name(self):
        write_log(self.folder / "log.csv", 3)
        found = self.diagnosed("log.csv", "--joint", "j2", "--arm", f"dh,file=dh.csv,{DOWN}")
        self.assertEqual(found["named"], [])
        self.assertLess(found["gap"]["after_nm"], 0.06)

    def test_the_directions_of_the_axes_do_nearly_as_well(self):
        write_log(self.folder / "log.csv", 4, coulomb_nm=1.2)
        found = self.diagnosed("log.csv", "--joint", "j2", "--arm", f"axes,word=zz,{DOWN}")
        self.assertIn("coulomb-friction", found["named"])
        self.assertTrue(found["arm"]["lengths_are_guessed"])

    def test_of_a_long_log_all_joints_are_looked_at_in_the_same_pieces(self):
        write_log(self.folder / "log.csv", 1, coulomb_nm=1.2, seconds=180.0)
        found = self.diagnosed("log.csv", "--joint", "j2", "--arm", f"dh,file=dh.csv,{DOWN}")
        self.assertEqual(found["recording"]["looked_at"], {"rows": 40960, "pieces": 16})
        self.assertEqual(found["named"], ["coulomb-friction"])
        friction = next(one for one in found["rounds"] if one["effect"] == "coulomb-friction")
        self.assertAlmostEqual(friction["parameters"]["torque_nm"]["value"], 1.2, delta=0.06)
        self.assertEqual(found["arm"]["values_told"], found["arm"]["values_there"])

    def test_the_story_tells_the_arm_and_verbose_the_pairs(self):
        write_log(self.folder / "log.csv", 5, coulomb_nm=1.2, seconds=12.0)
        done = ended(0, self.run_tool("diagnose", "log.csv", "--joint", "j1", "--arm", f"dh,file=dh.csv,{DOWN}", "--gear-ratio", "100", "-v"))
        self.assertRegex(done.stdout, r"^arm: 2 joints of dh.csv matched by \w+ \(-v shows them\); ")
        self.assertIn("with friction included, 5-fold cross-validated", done.stdout)
        self.assertIn("of the log, and goes", done.stderr)
        self.assertIn("as if with joints=", done.stderr)

    def test_what_cannot_be_is_refused_with_the_remedy(self):
        write_log(self.folder / "log.csv", 6, seconds=4.0)
        arm = f"dh,file=dh.csv,{DOWN}"
        whole = ["diagnose", "log.csv", "--joint", "j1", "--gear-ratio", "100"]
        for words, code, message in (
                (["diagnose", "log.csv", "--joint", "all", "--gear-ratio", "100", "--arm", arm, "--improved-model", "one.json"], 2, "{joint}"),
                (["diagnose", "log.csv", "--joint", "all", "--gear-ratio", "100", "--arm", arm, "--plot", "a.svg"], 2, "--plot"),
                (["diagnose", "log.csv", "--joint", "j1", "--gear-ratio", "100", "--arm", arm, "--accept", "frictoin"], 2, "frictoin"),
                ([*whole, "--arm", "dh"], 2, "file"),
                ([*whole, "--arm", "dh,file=none.csv"], 4, "none.csv"),
                ([*whole, "--arm", "axes,word=zq"], 2, "zq"),
                ([*whole, "--arm", "axes,word=zzz"], 2, "joint"),
                (["diagnose", "log.csv", "--joint", "j1", "--arm", arm], 2, "--gear-ratio"),
                (["diagnose", "-", "--joint", "j1", "--gear-ratio", "100", "--arm", arm], 2, "file")):
            with self.subTest(words=words):
                text = (self.folder / "log.csv").read_text()
                done = ended(code, self.run_tool(*words, stdin=text), message)
                self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertFalse((self.folder / "one.json").exists())

    @unittest.skipUnless((LOGS / "ur10_unisa_exciting_all.csv").is_file(), "the real log is not here")
    def test_a_real_shoulder_has_names_and_its_gap_closes_on_rows_that_nothing_was_fitted_to(self):
        lines = (LOGS / "ur10_unisa_exciting_all.csv").read_text().splitlines(keepends=True)
        cut = 1 + 3 * (len(lines) - 1) // 5
        (self.folder / "first.csv").write_text("".join(lines[:cut]))
        (self.folder / "last.csv").write_text(lines[0] + "".join(lines[cut:]))
        (self.folder / "ur10.csv").write_text(UR10_DH)
        # Bounds: twice what was measured when this was written; of the lift 2.85 Nm, which was 2.4 with the engine before.
        for joint, names, after_nm in (("shoulder_pan_joint", {"coulomb-friction"}, 2.4),
                                       ("shoulder_lift_joint", {"coulomb-friction"}, 3.0),
                                       ("wrist_2_joint", {"coulomb-friction"}, 0.7)):
            with self.subTest(joint=joint):
                done = ended(0, self.run_tool("diagnose", "first.csv", "--joint", joint, "--arm", "dh,file=ur10.csv", "--gear-ratio", "101",
                                          "--validate", "last.csv", "--json", "-q"))
                found = json.loads(done.stdout)
                self.assertLessEqual(names, set(found["named"]))
                self.assertLess(found["gap"]["validation_after_nm"], after_nm)
