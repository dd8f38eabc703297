# SPDX-License-Identifier: MIT
"""diagnose --arm: the rigid bodies of a whole arm from the torques of its joints, and names beside what they leave."""

import json
import unittest

from commands import LOGS, Case, ended
from logs import two_links

DH = "a_m,alpha_deg,d_m,theta_deg\n0.5,0,0,0\n0.4,0,0,0\n"
DOWN = "gravity=0:-9.81:0"
UR10_DH = ("theta_deg,d_m,a_m,alpha_deg\n0,0.1273,0,90\n0,0,-0.612,0\n0,0,-0.5723,0\n0,0.163941,0,90\n"
           "0,0.1157,0,-90\n0,0.0922,0,0\n")


def write_log(path, seed, **more):
    path.write_text(two_links(seed, **more))


class Arm(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "dh.csv").write_text(DH)

    def diagnosed(self, *words):
        done = ended(0, self.run_tool("diagnose", *words, "--gear-ratio", "100", "--json", "-q"))
        return json.loads(done.stdout)

    def test_of_a_long_log_all_joints_are_looked_at_in_the_same_pieces(self):
        write_log(self.folder / "log.csv", 1, coulomb_nm=1.2, seconds=180.0)
        found = self.diagnosed("log.csv", "--joint", "j2", "--arm", f"dh,file=dh.csv,{DOWN}")
        self.assertEqual(found["recording"]["looked_at"], {"rows": 40960, "pieces": 16})
        self.assertEqual(found["named"], ["coulomb-friction"])
        friction = next(one for one in found["rounds"] if one["effect"] == "coulomb-friction")
        self.assertAlmostEqual(friction["parameters"]["torque_nm"]["value"], 1.2, delta=0.06)
        self.assertEqual(found["arm"]["values_told"], found["arm"]["values_there"])

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
