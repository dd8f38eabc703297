# SPDX-License-Identifier: MIT
"""ripplenotch diagnose of a log whose gear ratio nobody knows."""

import json

from commands import Case


class NoGearRatio(Case):
    """What needs no ratio is examined, ripple is not, and that is said."""

    MOTION = ["--motion", "rest,duration=0.5s", "--motion", "poly6,to=120deg,duration=2s", "--motion", "rest,duration=0.5s",
              "--motion", "poly6,to=-60deg,duration=3s", "--motion", "rest,duration=0.5s"]
    FRICTION = ["--effect", "coulomb-friction,torque_nm=0.5,width_deg_s=0.2", "--effect",
                "viscous-friction,coefficient_nm_per_deg_s=0.01"]

    def log(self, *words, seed=1):
        done = self.run_tool("simulate", "--gear-ratio", "100", "--inertia", "0.4", *words, *self.MOTION, "--sample-rate",
                             "500Hz", "--noise", "0.05Nm", "--velocity-noise", "0.1deg/s", "--seed", str(seed), "-o", "log.csv", "--force")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_friction_is_named_and_ripple_is_said_not_to_be_examined(self):
        self.log(*self.FRICTION)
        done = self.run_tool("diagnose", "log.csv", "--model", "auto", "--json", "-o", "improved.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertIsNone(found["gear"]["ratio"])
        self.assertEqual(sorted(found["named"]), ["coulomb-friction", "viscous-friction"])
        reasons = {one["effect"]: one["reason"] for one in found["undecidable"]}
        for effect in ("ripple", "gear-ratio", "ripple-load-dependence", "ripple-modulation"):
            self.assertEqual(reasons[effect], "needs the gear ratio, --gear-ratio N")
        again = self.run_tool("simulate", "--model", "improved.json", "log.csv", "-o", "expected.csv")
        self.assertEqual(again.returncode, 0, again.stderr)
        (self.folder / "bad.json").write_text(json.dumps(
            {"schema": "ripplenotch/model/1", "gear_ratio": "unknown", "effects": [{"effect": "ripple", "order": 1}]}))
        bad = self.run_tool("diagnose", "log.csv", "--model", "bad.json")
        self.assertEqual(bad.returncode, 3)
        self.assertIn("ripple needs it", bad.stderr)

    def test_nothing_missing_is_not_said_of_ripple_and_is_not_conclusive(self):
        self.log()
        done = self.run_tool("diagnose", "log.csv", "--model", "auto", "--require-conclusive")
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("Nothing is missing of what was examined, which ripple is not", done.stdout)
        self.assertIn("not examined: ripple: needs the gear ratio, --gear-ratio N", done.stdout)
        self.assertIn("gear ratio not known (identify: No ripple", done.stdout)

    def test_a_ripple_gets_no_other_name(self):
        for seed, words in enumerate((["--ripple", "2:0.2Nm"], ["--ripple", "2:0.2Nm", *self.FRICTION])):
            self.log(*words, seed=30 + seed)
            found = json.loads(self.run_tool("diagnose", "log.csv", "--model", "auto", "--json").stdout)
            self.assertIsNone(found["gear"]["ratio"])
            self.assertLessEqual(set(found["named"]), {"coulomb-friction", "viscous-friction"})
            self.assertIn("output-ripple", [term["effect"] for term in found["own_terms"]])
