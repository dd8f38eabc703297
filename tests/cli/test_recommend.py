# SPDX-License-Identifier: MIT
"""ripplenotch recommend: what it says can be pasted, comes out as told, and is no worse under looser limits."""

import json
import shlex

from commands import SharedCase
from logs import slow_log

GEAR = ["--gear-ratio", "100", "--orders", "1,2"]


def write_log(path, **more):
    path.write_text(slow_log(**more))


class Recommended(SharedCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.log, cls.told = cls.folder / "log.csv", {}
        write_log(cls.log)

    def recommended(self, *words, log="log.csv", code=0, gear=GEAR):
        """What is told; of the log that all tests share, what an earlier run has said of the same words."""
        asked = (words, code, tuple(gear)) if log == "log.csv" else None
        if asked in self.told:
            return self.told[asked]
        done = self.run_tool("recommend", log, *gear, *words, "--json")
        self.assertEqual(done.returncode, code, done.stderr + done.stdout)
        told = json.loads(done.stdout)
        self.assertEqual(told["schema"], "ripplenotch/recommendation/1")
        if asked:
            self.told[asked] = told
        return told

    def paste(self, line):
        words = shlex.split(line)
        self.assertEqual(words[0], "ripplenotch")
        done = self.run_tool(*words[1:], *([] if words[1] == "compare" else ["--force"]))
        self.assertEqual(done.returncode, 0, f"{line}: {done.stderr}")
        return done


class Limits(Recommended):
    def test_looser_limits_never_give_a_worse_answer(self):
        best = None
        for limit in ("0.5ms", "3ms", "8ms", "20ms", "100ms", None):
            told = self.recommended(*(["--max-delay", limit] if limit else []), "--target", "c-header")
            first = told["methods"][0]
            self.assertTrue(first["meets"])
            if best is not None:
                self.assertLessEqual(first["error_nm"], best)
            best = first["error_nm"]
        told = [self.recommended("--min-attenuation", f"{db}dB", code=code) for db, code in ((60, 1), (30, 0), (10, 0))]
        self.assertGreaterEqual(told[1]["methods"][0]["error_nm"], told[2]["methods"][0]["error_nm"])


class Honest(Recommended):
    def test_a_method_that_learns_is_held_to_its_start(self):
        held = self.recommended("--max-start-error", "0.001", code=1)
        self.assertIn("at its start (asked: 0.001)", held["verdict"])
        for one in held["methods"]:
            self.assertEqual(one["meets"], one["start_ratio"] <= 0.001)

    def test_a_gear_that_nobody_states_is_found_in_the_first_part(self):
        told = self.recommended(gear=[])
        self.assertEqual(told["finding"], "recommended", told["verdict"])
        self.assertAlmostEqual(told["gear"]["ratio"] * told["gear"]["orders"][0] / 100, round(told["gear"]["ratio"] * told["gear"]["orders"][0] / 100),
                               delta=0.02)
        for line in [*told["take_commands"], told["check"]]:
            self.paste(line)
