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

    def test_a_difference_of_viscous_friction_is_not_examined_on_a_log_of_one_direction(self):
        self.log("log.csv", move(0, 60, 90, 400, 520, 560), "viscous-friction,coefficient_nm_per_deg_s=0.006")
        done = ended(0, self.run_tool("diagnose", "log.csv", "--model", "model.json", "--json", "-q"))
        found = json.loads(done.stdout)
        self.assertEqual((found["verdict"], found["named"]), ("explained", ["viscous-friction"]))
        self.assertEqual([(one["effect"], one["reason"]) for one in found["undecidable"]],
                         [("asymmetric-viscous-friction", "needs motion in both directions")])

    def test_a_torque_of_the_output_angle_over_less_than_its_cycle_is_not_confirmed(self):
        self.log("log.csv", move(0, 130, 10, 120, 5), "output-ripple,order=2,amplitude_nm=70,phase_deg=20")
        done = ended(0, self.run_tool("diagnose", "log.csv", "--model", "model.json", "--json", "-q"))
        found = json.loads(done.stdout)
        self.assertNotIn("output-ripple", found["named"])
        for one in found["rounds"]:
            if one["effect"] == "output-ripple":
                self.assertIn("of its cycles", one["reason"])

    def test_the_same_log_gives_the_same_bytes_and_a_conclusive_verdict_can_be_asked_for(self):
        self.log("log.csv", move(0, 120, -60), "offset,torque_nm=0.4")
        first = ended(0, self.run_tool("diagnose", "log.csv", "--model", "model.json", "--require-conclusive"))
        self.assertEqual(first.stdout, self.run_tool("diagnose", "log.csv", "--model", "model.json").stdout)
        # The answer comes first.
        self.assertRegex(first.stdout, r"^Missing: offset 0\.4\d* \+/- 0\.00\d+ Nm; residual 0\.3\d+ to 0\.04\d+ Nm rms, noise 0\.04\d+ Nm rms\.\n"
                                       r"gap 0\.3\d* -> 0\.0\d* Nm, \d+\.\d % of it closed\nverdict: explained\nnamed: offset\n")
        others = [name for effect in ("offset", "drift", "gravity", "output-ripple", "coulomb-friction", "hysteresis")
                  for name in ("--without", effect)]
        second = ended(5, self.run_tool("diagnose", "log.csv", "--model", "model.json", "--require-conclusive", *others))
        self.assertIn("named: nothing\n", second.stdout)
        self.assertIn("remaining: ", second.stdout)

    def test_explain_says_in_one_line_each_why_a_candidate_was_not_named(self):
        self.log("log.csv", move(0, 120, -60))
        done = self.run_tool("diagnose", "log.csv", "--model", "model.json", "--explain")
        self.assertRegex(done.stdout, r"(?m)^not named: [a-z-]+: it reduces the residual no more than chance$")

    def test_the_catalogue_is_printed_alone(self):
        for words in (["log.csv", "--effects"], ["--model", "model.json", "--effect", "delay"], ["--effects", "--effect", "delay"]):
            done = self.run_tool("diagnose", *words)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("stand alone", done.stderr)
        self.assertTrue(self.run_tool("diagnose", "--effect", "delay").stdout.startswith("delay: "))

    def test_a_model_is_made_of_the_log_by_identify(self):
        self.log("log.csv", move(0, 120, -60), "coulomb-friction,torque_nm=0.4,width_deg_s=2")
        done = ended(0, self.run_tool("diagnose", "log.csv", "--model", "auto", "-v", "--improved-model", "made.json", "--force"),
                     "the model is made of the log: gear ratio ")
        self.assertIn("named: coulomb-friction", done.stdout)
        made = json.loads((self.folder / "made.json").read_text())
        self.assertAlmostEqual(made["gear_ratio"], MODEL["gear_ratio"], delta=0.1)
        told = self.run_tool("diagnose", "log.csv")
        self.assertIn("--model auto", told.stderr)
        piped = self.run_tool("diagnose", "-", "--model", "auto")
        self.assertEqual((piped.returncode, piped.stdout), (2, ""))
        self.log("rest.csv", ["--motion", "rest,duration=2s,from=0deg"])
        silent = self.run_tool("diagnose", "rest.csv", "--model", "auto")
        self.assertEqual((silent.returncode, silent.stdout), (3, ""), silent.stderr)
        self.assertIn("--gear-ratio N", silent.stderr)

    def test_the_old_spelling_of_improved_model_is_taken_with_a_warning_and_stands_in_no_help(self):
        self.log("log.csv", move(0, 120))
        words = ("diagnose", "log.csv", "--model", "model.json")
        expected = self.run_tool(*words, "--improved-model", "improved.json")
        self.assertEqual((expected.returncode, expected.stderr), (0, ""))
        warning = ("ripplenotch: warning: --output of diagnose will mean the result; write --improved-model FILE\n")
        for spelling, said in ((("-o", "old.json"), warning), (("-oold.json",), warning), (("--output", "old.json"), warning),
                               (("--output=old.json",), warning), (("-qo", "old.json"), "")):
            with self.subTest(spelling):
                done = self.run_tool(*words, *spelling, "--force")
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, expected.stdout, said))
                self.assertEqual((self.folder / "old.json").read_bytes(), (self.folder / "improved.json").read_bytes())
        ended(2, self.run_tool(*words, "-o", "a.json", "--improved-model", "b.json"), "--improved-model is given more than once")
        told = self.run_tool(*words, "--improved-model", "-")
        self.assertEqual((told.returncode, told.stdout), (2, ""))
        self.assertIn("--improved-model -: the result goes to standard output; give a file", told.stderr)
        self.assertNotRegex(self.run_tool("diagnose", "--help-all").stdout, r"-o\b|--output\b")

    def test_wrong_requests_get_one_message(self):
        self.log("log.csv", move(0, 120))
        (self.folder / "open.json").write_text(
            json.dumps({**MODEL, "effects": [{"effect": "ripple"}]}))
        for words, code, message in (
                ((), 2, "--model is missing"),
                (("--model", "model.json", "--without", "dely"), 2, "did you mean delay?"),
                (("--model", "open.json"), 2, "effects[0].order"),
                (("--model", "model.json", "--smoothing", "-1s"), 2, "below 0"),
                (("--model", "none.json"), 4, "none.json")):
            done = self.run_tool("diagnose", "log.csv", *words)
            self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
            self.assertIn(message, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
