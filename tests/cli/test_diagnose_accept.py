# SPDX-License-Identifier: MIT
"""What diagnose leaves to its user: --accept, and what to do next."""

import json

from commands import Case, ended

MODEL = {"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [
    {"effect": "inertia"}, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]}
TRUTH = ["--gear-ratio", "100", "--inertia", "0.4", "--ripple", "1:0.7Nm:30deg", "--ripple", "2:0.4Nm:-60deg",
         "--effect", "coulomb-friction,torque_nm=0.5,width_deg_s=0.2"]
THERE_AND_BACK = ["rest,duration=0.5s", "poly6,to=120deg,duration=2s", "rest,duration=0.5s", "poly6,to=-60deg,duration=3s",
                  "rest,duration=0.5s", "poly6,to=30deg,duration=1.5s", "rest,duration=0.5s"]
BLIND = [word for name in ("coulomb-friction", "stribeck-friction", "hysteresis", "friction-warm-up", "position-dependent-friction")
         for word in ("--without", name)]


class Accept(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "model.json").write_text(json.dumps(MODEL))

    def json_of(self, *words):
        done = ended(0, self.run_tool(*words, "--json", "-q", "--force"))
        return json.loads(done.stdout)

    def log(self, name, motions):
        words = [word for motion in motions for word in ("--motion", motion)]
        ended(0, self.run_tool("simulate", *TRUTH, *words, "--sample-rate", "500Hz", "--noise", "0.05Nm", "--velocity-noise",
                           "0.1deg/s", "--seed", "1", "-o", name))

    def test_a_refused_candidate_is_taken_and_told_as_accepted(self):
        self.log("log.csv", THERE_AND_BACK)
        words = ["diagnose", "log.csv", "--model", "model.json", *BLIND]
        before = self.json_of(*words)
        self.assertTrue(before["refused"])
        name = before["refused"][0]["effect"]
        after = self.json_of(*words, "--accept", name, "--improved-model", "improved.json")
        self.assertEqual([(one["effect"], one["status"]) for one in after["accepted"]], [(name, "refused")])
        self.assertNotIn(name, after["named"])
        self.assertEqual(after["gap"]["before_nm"], before["gap"]["before_nm"])
        effects = [one["effect"] for one in json.loads((self.folder / "improved.json").read_text())["effects"]]
        self.assertEqual(effects[:4], ["inertia", "ripple", "ripple", name])
        left = self.json_of("simulate", "--model", "improved.json", "log.csv", "-o", "again.csv")["along_log"]["residual_rms_nm"]
        self.assertAlmostEqual(left / after["gap"]["after_nm"], 1.0, delta=1e-4)
        story = self.run_tool(*words, "--accept", name).stdout
        self.assertRegex(story, rf"accepted by you and not confirmed by this log \(refused\): {name}, ")

    def test_what_is_not_in_doubt_is_refused_with_what_is(self):
        self.log("log.csv", THERE_AND_BACK)
        for words, part in (((*BLIND, "--accept", "velocity-bias"), "no finding of that name; uncertain findings: "),
                            (("--accept", "coulomb-friction"), "it is confirmed, and in the model already; uncertain findings: "),
                            (("--accept", "coulomb"), "there is no effect 'coulomb'")):
            ended(2, self.run_tool("diagnose", "log.csv", "--model", "model.json", *words), part)

    def test_nothing_in_doubt_nothing_to_do(self):
        self.log("log.csv", THERE_AND_BACK)
        self.assertNotIn("next", self.json_of("diagnose", "log.csv", "--model", "model.json"))

    def test_a_log_of_one_direction_asks_for_the_other_and_a_side_can_be_taken(self):
        self.log("log.csv", [f"constant,speed={speed}deg/s,duration=3s" for speed in (40, 80, 20)])
        found = self.json_of("diagnose", "log.csv", "--model", "model.json")
        self.assertTrue(found["ambiguous"], found["rounds"])
        sides = found["ambiguous"][0]["effects"]
        self.assertTrue(found["next"][0].startswith(" or ".join(sides)), found["next"])
        self.assertIn("the other direction of motion", found["next"][-1])
        taken = self.json_of("diagnose", "log.csv", "--model", "model.json", "--accept", sides[1])
        self.assertEqual([one["effect"] for one in taken["accepted"]], [sides[1]])
        # What a user accepts is no verdict.
        self.assertEqual(taken["verdict"], "partly-explained")
        done = ended(5, self.run_tool("diagnose", "log.csv", "--model", "model.json", "--accept", sides[1], "--require-conclusive"))
        self.assertIn("accepted by you and not confirmed by this log", done.stdout)
