# SPDX-License-Identifier: MIT
"""An arm in model.json: what diagnose --improved-model writes, simulate, diagnose, identify and spectrum read; and --joint all."""

import hashlib
import json

from commands import SharedCase, ended, good
from test_diagnose_arm import DH, DOWN, write_log

ARM = f"dh,file=dh.csv,{DOWN}"


def without_head(document):
    return {key: value for key, value in document.items() if key not in
            ("schema", "tool", "version", "command", "inputs", "recordings", "joint")}


class Improved(SharedCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.folder / "dh.csv").write_text(DH)
        write_log(cls.folder / "log.csv", 1, coulomb_nm=1.2, seconds=20.0)
        write_log(cls.folder / "other.csv", 2, coulomb_nm=1.2, seconds=20.0)
        cls.found = {}
        for joint in ("j1", "j2"):
            cls.found[joint] = cls.json_of("diagnose", "log.csv", "--joint", joint, "--arm", ARM, "--gear-ratio", "100",
                                           "--validate", "other.csv", "--improved-model", f"{joint}.json")

    @classmethod
    def json_of(cls, *words):
        return json.loads(good(*words, "--json", "-q", "--force", cwd=cls.folder).stdout)

    def residual_nm(self, *words):
        return self.json_of("simulate", *words, "-o", "again.csv")["along_log"]["residual_rms_nm"]

    def test_the_model_holds_the_chain_its_links_and_the_hash_of_its_file(self):
        model = json.loads((self.folder / "j2.json").read_text())
        arm = model["arm"]
        self.assertEqual((arm["joint"], [one["log"] for one in arm["joints"]]), ("j2", ["j1", "j2"]))
        self.assertEqual(arm["gravity_m_s2"], [0, -9.81, 0])
        self.assertEqual(arm["identified"], "torque")
        self.assertEqual([len(link["inertia_kgm2"]) for link in arm["links"]], [6, 6])
        self.assertIn({"name": "dh.csv", "sha256": hashlib.sha256(DH.encode()).hexdigest()}, model["inputs"])
        self.assertEqual([one["effect"] for one in model["effects"]], ["coulomb-friction"])

    def test_simulate_leaves_what_the_diagnosis_said_on_both_logs(self):
        (self.folder / "dh.csv").rename(self.folder / "gone.csv")
        self.addCleanup(lambda: (self.folder / "gone.csv").rename(self.folder / "dh.csv"))
        for joint, found in self.found.items():
            with self.subTest(joint=joint):
                # The file holds 9 digits, the diagnosis 6. The model says which joint it is for.
                for log, gap in (("log.csv", "after_nm"), ("other.csv", "validation_after_nm")):
                    left = self.residual_nm("--model", f"{joint}.json", log)
                    self.assertAlmostEqual(left / found["gap"][gap], 1.0, delta=1e-4)

    def test_diagnosed_again_nothing_is_missing_and_the_gap_is_the_same(self):
        for joint, found in self.found.items():
            with self.subTest(joint=joint):
                again = self.json_of("diagnose", "log.csv", "--model", f"{joint}.json", "--improved-model", "again.json")
                self.assertEqual(again["named"], [])
                self.assertAlmostEqual(again["gap"]["before_nm"] / found["gap"]["after_nm"], 1.0, delta=1e-4)
                self.assertLessEqual(again["gap"]["after_nm"], found["gap"]["after_nm"] * 1.001)
                self.assertTrue(again["arm"]["values_are_stated"])
                once, twice = (json.loads((self.folder / name).read_text())["arm"] for name in (f"{joint}.json", "again.json"))
                self.assertEqual(once["links"], twice["links"])

    def test_an_arm_whose_links_are_left_out_is_fitted_anew(self):
        model = json.loads((self.folder / "j1.json").read_text())
        del model["arm"]["links"], model["arm"]["rotor_inertia_kgm2"]
        model["effects"] = []
        (self.folder / "open.json").write_text(json.dumps(model))
        again = self.json_of("diagnose", "log.csv", "--model", "open.json")
        self.assertEqual(again["named"], ["coulomb-friction"])
        ended(2, self.run_tool("simulate", "--model", "open.json", "log.csv"), "arm.links")

    def test_a_residual_is_looked_into(self):
        strongest = []
        for words in (("--joint", "j2"), ("--residual", "j2.json"), ("--residual", "j2.json", "--segment", "4s")):
            done = ended(0, self.run_tool("spectrum", "log.csv", "--bins", *words))
            strongest.append(max(float(line.split(",")[1]) for line in done.stdout.splitlines()[1:]))
        self.assertLess(max(strongest[1:]), 0.02 * strongest[0])
        done = ended(0, self.run_tool("identify", "log.csv", "--residual", "j2.json", "-v"))
        self.assertRegex(done.stderr, r"log.csv: [\d.]+ Nm rms of torque, 0.0\d+ less what is predicted")

    def test_all_joints_are_what_each_alone_is(self):
        words = ("diagnose", "log.csv", "--arm", ARM, "--gear-ratio", "100", "--validate", "other.csv")
        every = self.json_of(*words, "--joint", "all", "--improved-model", "all_{joint}.json")
        self.assertEqual(every["schema"], "ripplenotch/diagnoses/1")
        self.assertEqual([one["joint"] for one in every["joints"]], ["j1", "j2"])
        for one in every["joints"]:
            joint = one["joint"]
            self.assertEqual(json.dumps(without_head(one)), json.dumps(without_head(self.found[joint])))
            models = [json.loads((self.folder / name).read_text()) for name in (f"all_{joint}.json", f"{joint}.json")]
            self.assertEqual(*(json.dumps(without_head(model)) for model in models))
        (self.folder / "every.json").write_text(json.dumps(every))
        ended(0, self.run_tool("report", "every.json", "-o", "every.html", "-q"))
        for one in every["joints"]:
            self.assertIn(f'Missing effects: every.json, joint {one["joint"]}', (self.folder / "every.html").read_text())
        told = ended(0, self.run_tool(*words, "--joint", "all"))
        table = told.stdout.split("\n\n")[-1].splitlines()
        self.assertRegex(table[0], r"^joint +before, Nm +after, Nm +validation before +validation after +verdict +named$")
        self.assertEqual([line.split()[0] for line in table[1:]], ["j1", "j2"])
        for joint in ("j1", "j2"):
            alone = self.run_tool(*words, "--joint", joint).stdout
            self.assertIn(f"joint {joint}\n{alone}\n", told.stdout)

    def test_the_story_tells_the_gap_by_band(self):
        told = self.run_tool("diagnose", "log.csv", "--joint", "j2", "--arm", ARM, "--gear-ratio", "100").stdout
        rows = told[told.index("\nfrequency") + 1:].splitlines()
        self.assertRegex(rows[0], r"^frequency +torque, Nm rms +without the known terms +and the model$")
        self.assertEqual([row[:12].strip() for row in rows[1:4]], ["below 1 Hz", "1 to 10 Hz", "above 10 Hz"])
        by_band = self.json_of("diagnose", "log.csv", "--joint", "j2", "--arm", ARM, "--gear-ratio", "100")
        for column, whole in (("after_nm", by_band["gap"]["after_nm"]),):
            self.assertAlmostEqual(sum(band[column] ** 2 for band in by_band["bands"]) ** 0.5, whole, delta=1e-4)

    def test_refusals(self):
        model = json.loads((self.folder / "j1.json").read_text())
        model["effects"].append({"effect": "inertia"})
        (self.folder / "twice.json").write_text(json.dumps(model))
        for words, code, part in (
                (("simulate", "--model", "j1.json", "--motion", "rest,duration=1s", "--sample-rate", "100Hz"), 3, "arm is part of"),
                (("simulate", "--model", "j1.json", "log.csv", "--joint", "j2"), 2, "'j1'"),
                (("diagnose", "log.csv", "--model", "twice.json"), 3, "inertia is part of arm; remove one of the two"),
                (("diagnose", "log.csv", "--model", "j1.json", "--arm", ARM), 2, "--arm: the model states it already"),
                (("diagnose", "log.csv", "--model", "j1.json", "--accept", "hysteresis"), 2, "--accept hysteresis")):
            with self.subTest(words=words):
                ended(code, self.run_tool(*words), part)
