# SPDX-License-Identifier: MIT
"""ripplenotch diagnose as users meet it: the story, diagnosis.json, the improved model, refusals."""

import json

from commands import Case, ended

MODEL = {"schema": "ripplenotch/model/1", "gear_ratio": 100,
         "effects": [{"effect": "inertia"}, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]}
JOINT = ["--gear-ratio", "100", "--inertia", "0.4", "--ripple", "1:0.7Nm:30deg", "--ripple", "2:0.4Nm:-60deg"]


def move(first, *targets):
    words = ["--motion", f"rest,duration=0.4s,from={first}deg"]
    for k, target in enumerate(targets):
        words += ["--motion", f"poly6,to={target}deg,duration={1.4 + 0.5 * (k % 3)}s", "--motion", "rest,duration=0.4s"]
    return words


class Diagnose(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "model.json").write_text(json.dumps(MODEL))

    def log(self, name, motion, *hidden, seed=1):
        words = [word for effect in hidden for word in ("--effect", effect)]
        ended(0, self.run_tool("simulate", *JOINT, *words, *motion, "--sample-rate", "500Hz", "--noise", "0.05Nm",
                               "--velocity-noise", "0.05deg/s", "--seed", str(seed), "-o", name))

    def test_what_is_hidden_is_named_added_and_the_improved_model_does_on_another_log_what_was_said(self):
        self.log("log.csv", move(0, 120, -60, 30, -40), "viscous-friction,coefficient_nm_per_deg_s=0.006")
        self.log("other.csv", move(40, -90, 60), "viscous-friction,coefficient_nm_per_deg_s=0.006", seed=2)
        done = self.run_tool("diagnose", "log.csv", "--model", "model.json", "--validate", "other.csv", "--improved-model", "improved.json",
                             "--json")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        found = json.loads(done.stdout)
        self.assertEqual(found["schema"], "ripplenotch/diagnosis/1")
        self.assertEqual((found["verdict"], found["named"]), ("explained", ["viscous-friction"]))
        coefficient = found["rounds"][0]["parameters"]["coefficient_nm_per_deg_s"]
        self.assertAlmostEqual(coefficient["value"], 0.006, delta=1e-4)
        self.assertLess(coefficient["ci95"][0], 0.006)
        self.assertGreater(coefficient["ci95"][1], coefficient["value"])
        gap = found["gap"]
        self.assertGreater(gap["before_nm"], 3 * gap["after_nm"])
        self.assertGreater(gap["closed_percent"], 99.0)
        summary = json.loads(self.run_tool("simulate", "--model", "improved.json", "other.csv", "-o", "expected.csv",
                                           "--json").stdout)
        self.assertAlmostEqual(summary["along_log"]["residual_rms_nm"], gap["validation_after_nm"], delta=1e-6)
        self.assertEqual(json.loads((self.folder / "improved.json").read_text())["effects"],
                         found["model"]["effects"])
