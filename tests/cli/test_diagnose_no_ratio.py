# SPDX-License-Identifier: MIT
"""ripplenotch diagnose of a log whose gear ratio nobody knows."""

import json

from commands import Case, ended


class NoGearRatio(Case):
    """What needs no ratio is examined, ripple is not, and that is said."""

    MOTION = ["--motion", "rest,duration=0.5s", "--motion", "poly6,to=120deg,duration=2s", "--motion", "rest,duration=0.5s",
              "--motion", "poly6,to=-60deg,duration=3s", "--motion", "rest,duration=0.5s"]
    FRICTION = ["--effect", "coulomb-friction,torque_nm=0.5,width_deg_s=0.2", "--effect",
                "viscous-friction,coefficient_nm_per_deg_s=0.01"]

    def log(self, *words, seed=1):
        ended(0, self.run_tool("simulate", "--gear-ratio", "100", "--inertia", "0.4", *words, *self.MOTION, "--sample-rate",
                               "500Hz", "--noise", "0.05Nm", "--velocity-noise", "0.1deg/s", "--seed", str(seed), "-o", "log.csv", "--force"))

    def test_friction_is_named_and_ripple_is_said_not_to_be_examined(self):
        self.log(*self.FRICTION)
        done = ended(0, self.run_tool("diagnose", "log.csv", "--model", "auto", "--json", "--improved-model", "improved.json"))
        found = json.loads(done.stdout)
        self.assertIsNone(found["gear"]["ratio"])
        self.assertEqual(sorted(found["named"]), ["coulomb-friction", "viscous-friction"])
        reasons = {one["effect"]: one["reason"] for one in found["undecidable"]}
        for effect in ("ripple", "gear-ratio", "ripple-load-dependence", "ripple-modulation"):
            self.assertEqual(reasons[effect], "needs the gear ratio, --gear-ratio N")
        ended(0, self.run_tool("simulate", "--model", "improved.json", "log.csv", "-o", "expected.csv"))
        (self.folder / "bad.json").write_text(json.dumps(
            {"schema": "ripplenotch/model/1", "gear_ratio": "unknown", "effects": [{"effect": "ripple", "order": 1}]}))
        ended(3, self.run_tool("diagnose", "log.csv", "--model", "bad.json"), "ripple needs it")

    def test_nothing_missing_is_not_said_of_ripple_and_is_not_conclusive(self):
        self.log()
        done = ended(5, self.run_tool("diagnose", "log.csv", "--model", "auto", "--require-conclusive"))
        self.assertIn("Nothing is missing of what was examined, which ripple is not", done.stdout)
        self.assertIn("not examined: ripple: needs the gear ratio, --gear-ratio N", done.stdout)
        self.assertIn("gear ratio not known (identify: No ripple", done.stdout)

    def test_motion_that_is_too_fast_for_a_joint_is_asked_about(self):
        rows = "".join(f"{k * 0.01:.2f},{9000.0 + (k % 7):g},{0.5 + 0.01 * (k % 5):g}\n" for k in range(1000))
        (self.folder / "motor.csv").write_text("time_s,motor_velocity_deg_s,torque_nm\n" + rows)
        done = self.run_tool("diagnose", "motor.csv", "--model", "auto")
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("--gear-ratio", done.stderr)
        self.assertIn("--side joint", done.stderr)

    def test_over_less_than_a_cycle_of_a_ripple_nothing_is_named_for_it(self):
        ended(0, self.run_tool("simulate", "--gear-ratio", "6", "--inertia", "0.4", "--ripple", "2:0.2Nm", "--motion",
                               "rest,duration=0.5s", "--motion", "poly6,to=15deg,duration=1s", "--motion", "rest,duration=0.5s",
                               "--motion", "poly6,to=-10deg,duration=1.5s", "--motion", "rest,duration=0.5s", "--sample-rate",
                               "500Hz", "--noise", "0.05Nm", "--velocity-noise", "0.1deg/s", "--seed", "122", "-o", "log.csv"))
        found = json.loads(self.run_tool("diagnose", "log.csv", "--model", "auto", "--json").stdout)
        self.assertEqual(found["named"], [])

    def test_a_step_from_collinear_slopes_is_refused_not_taken(self):
        # The search for `lag` once took a step that was no number, and its residual then was none.
        ended(0, self.run_tool("simulate", "--gear-ratio", "10", "--inertia", "0.784", "--ripple", "1:0.688Nm:349deg", "--effect",
                               "coulomb-friction,torque_nm=0.257,width_deg_s=0.2", "--effect",
                               "viscous-friction,coefficient_nm_per_deg_s=0.0139", "--effect",
                               "gravity,amplitude_nm=9.195,phase_deg=285", "--motion", "poly6,to=13.2deg,duration=3.25s", "--motion",
                               "rest,duration=0.4s", "--motion", "poly6,to=-27.4deg,duration=2.51s", "--motion", "rest,duration=0.4s",
                               "--sample-rate", "500Hz", "--noise", "0.01Nm", "--velocity-noise", "0.1deg/s", "--seed", "72014",
                               "-o", "log.csv"))
        text = self.run_tool("diagnose", "log.csv", "--model", "auto").stdout
        self.assertNotIn("nan", text)
        self.assertNotIn("Nothing is missing", text)

    def test_a_ripple_gets_no_other_name(self):
        for seed, words in enumerate((["--ripple", "2:0.2Nm"], ["--ripple", "2:0.2Nm", *self.FRICTION])):
            self.log(*words, seed=30 + seed)
            found = json.loads(self.run_tool("diagnose", "log.csv", "--model", "auto", "--json").stdout)
            self.assertIsNone(found["gear"]["ratio"])
            self.assertLessEqual(set(found["named"]), {"coulomb-friction", "viscous-friction"})
            self.assertIn("output-ripple", [term["effect"] for term in found["own_terms"]])
