# SPDX-License-Identifier: MIT
"""ripplenotch recommend: what it says can be pasted, comes out as told, and is no worse under looser limits."""

import json
import math
import random
import shlex
import unittest

from commands import LOGS, SharedCase, ended

GEAR = ["--gear-ratio", "100", "--orders", "1,2"]


def write_log(path, seconds=16, ripple=1.0, noise=0.05, slow_nm=6.0, header="time_s,velocity_deg_s,torque_nm,position_deg",
              speed=None, seed=1):
    """Ripple of 0.8 Nm (order 1) and 0.5 Nm (order 2) at a gear ratio of 100, beside a slow torque."""
    draw = random.Random(seed)
    position, before = 3.0, None
    with open(path, "w") as file:
        file.write(header + "\n")
        for k in range(int(seconds * 1000)):
            t = k / 1000.0
            v = speed if speed is not None else 80 * math.sin(0.9 * t + 1) + 30 * math.sin(0.37 * t)
            position += 0.0 if before is None else (before + v) / 2000.0
            before = v
            theta = math.radians(100 * position)
            nm = slow_nm * math.sin(0.5 * t) + ripple * (0.8 * math.cos(theta + 0.5) + 0.5 * math.cos(2 * theta)) + draw.gauss(0, noise)
            cells = [t, v, nm, position]
            file.write(",".join(f"{cell:.6f}" for cell in cells[:len(header.split(","))]) + "\n")


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


class Pasted(Recommended):
    def test_what_is_told_to_paste_runs_and_measures_what_was_told(self):
        told = self.recommended()
        self.assertEqual((told["finding"], told["conclusive"]), ("recommended", True))
        for line in told["take_commands"] + told["runner_up_commands"]:
            self.paste(line)
        compared = json.loads(self.paste(told["check"] + " --json").stdout)
        rows = {row["method"]: row for row in compared["methods"]}
        for name in filter(None, (told["take"], told["runner_up"])):
            judged = next(one for one in told["methods"] if one["method"] == name)
            for mine, theirs in zip(judged["attenuation_db"], rows[name]["attenuation_db"], strict=True):
                self.assertAlmostEqual(mine["db"], theirs["db"], places=6)
            self.assertAlmostEqual(judged["ripple_rms_nm"], rows[name]["ripple_rms_nm"], places=8)
        # One judgement: what is recommended is the best on the rows that it was judged on, by the same figures.
        best = {key: value for key, value in compared["best"].items() if key != "reason"}
        self.assertEqual(best, next(one for one in told["methods"] if one["method"] == told["take"]))

    def test_a_table_that_is_pasted_is_the_one_that_was_judged(self):
        # Only tables fit into this target; without limits none of them has to come first, so both are pasted.
        told = self.recommended("--target", "cmsis-dsp")
        kinds = [line.split()[1] for line in told["take_commands"] + told["runner_up_commands"]]
        self.assertIn("design", kinds)
        for line in told["take_commands"] + told["runner_up_commands"]:
            if "export" not in line:
                self.paste(line)
        compared = json.loads(self.paste(told["check"] + " --json").stdout)
        for row in compared["methods"]:
            judged = next(one for one in told["methods"] if one["method"] == row["method"])
            for mine, theirs in zip(judged["attenuation_db"], row["attenuation_db"], strict=True):
                self.assertAlmostEqual(mine["db"], theirs["db"], places=6)

    def test_a_method_that_needs_a_log_of_other_options_carries_them(self):
        wide = self.folder / "a log.csv"
        write_log(wide, header="t,dq,tau,q")
        told = self.recommended("--unit", "dq=deg/s", "--unit", "q=deg", "--columns", "time,velocity,torque,position", log=wide.name)
        for line in told["take_commands"]:
            self.paste(line)
        self.paste(told["check"])

    def test_the_same_log_gives_the_same_bytes(self):
        self.assertEqual(self.run_tool("recommend", "log.csv", *GEAR).stdout, self.run_tool("recommend", "log.csv", *GEAR).stdout)


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

    def test_what_is_taken_is_within_the_limits_and_leaves_least(self):
        told = self.recommended("--max-delay", "5ms", "--min-attenuation", "10dB")
        first = told["methods"][0]
        self.assertLessEqual(first["longest_delay_ms"], 5.0)
        self.assertGreaterEqual(min(one["db"] for one in first["attenuation_db"]), 10.0)
        self.assertEqual(first["error_nm"], min(one["error_nm"] for one in told["methods"] if one["meets"]))

    def test_out_of_reach_says_what_fails_and_by_how_much(self):
        told = self.recommended("--min-attenuation", "80dB", "--max-delay", "1ms", code=1)
        self.assertEqual((told["finding"], told["take"]), ("out-of-reach", None))
        self.assertRegex(told["verdict"], r"^None fits: the nearest is \S+ at [\d.]+ dB of order \d \(asked: 80 dB\)\.$")
        self.assertTrue(all(not one["meets"] for one in told["methods"]))

    def test_a_target_limits_the_methods_to_what_it_holds(self):
        self.assertEqual({one["method"].split(",")[0] for one in self.recommended("--target", "c-header")["methods"]},
                         {"none", "tracking", "oscillator", "map", "switching", "lowpass"})
        self.assertEqual({one["method"].split(",")[0] for one in self.recommended("--target", "moteus,kt=0.1")["methods"]}, {"none", "map"})
        ended(2, self.run_tool("recommend", "log.csv", *GEAR, "--target", "c-heade"), "c-header")

    def test_the_export_of_a_target_can_be_pasted(self):
        for target in ("c-header", "moteus,kt=0.1"):
            for line in self.recommended("--target", target)["take_commands"]:
                self.paste(line)


class Honest(Recommended):
    def test_without_ripple_there_is_nothing_to_take(self):
        write_log(self.folder / "none.csv", ripple=0.0)
        told = self.recommended(log="none.csv")
        self.assertEqual((told["finding"], told["take"], told["conclusive"]), ("no-ripple", None, True))
        self.assertRegex(told["verdict"], "^No filter recommended: order 1: no ripple above 0.0[0-9]+ Nm at [0-9.]+ to [0-9.]+ deg/s")

    def test_where_the_stated_orders_are_not_there_and_others_are_it_names_those(self):
        told = self.recommended(gear=["--gear-ratio", "100", "--orders", "3"])
        self.assertEqual((told["finding"], told["take"], told["conclusive"]), ("cannot-tell", None, False))
        self.assertRegex(told["verdict"], r"order 3: no ripple above .*\. But identify finds 0\.[78][0-9]* Nm at order 1, 0\.[45][0-9]* Nm at order 2: --orders")

    def test_a_short_log_is_judged_in_the_windows_that_it_has(self):
        write_log(self.folder / "short.csv", seconds=1.2)
        told = self.recommended(log="short.csv")
        self.assertEqual((told["finding"], told["windows"]), ("recommended", 2))
        self.assertEqual([order["present"] for order in told["orders"]], [True, True])

    def test_a_method_that_learns_is_held_to_its_start(self):
        held = self.recommended("--max-start-error", "0.001", code=1)
        self.assertIn("at its start (asked: 0.001)", held["verdict"])
        for one in held["methods"]:
            self.assertEqual(one["meets"], one["start_ratio"] <= 0.001)

    def test_a_joint_at_rest_is_no_ground(self):
        write_log(self.folder / "rest.csv", seconds=5, speed=0.0)
        told = self.recommended(log="rest.csv")
        self.assertEqual((told["finding"], told["windows"], told["left_out"]), ("cannot-tell", 0, []))
        self.assertEqual([order["present"] for order in told["orders"]], [None, None])
        self.assertRegex(told["verdict"], "^Cannot tell: order 1: the joint nowhere turns four periods of it")

    def test_a_gear_that_nobody_states_is_found_in_the_first_part(self):
        told = self.recommended(gear=[])
        self.assertEqual(told["finding"], "recommended", told["verdict"])
        self.assertAlmostEqual(told["gear"]["ratio"] * told["gear"]["orders"][0] / 100, round(told["gear"]["ratio"] * told["gear"]["orders"][0] / 100),
                               delta=0.02)
        for line in [*told["take_commands"], told["check"]]:
            self.paste(line)

    def test_fewer_decibels_where_the_delay_costs_more(self):
        # A torque that moves fast makes each ms dear: the answer has no more delay than for a slow one.
        write_log(self.folder / "fast.csv", slow_nm=200.0)
        words = ("--target", "c-header")
        fast, slow = self.recommended(*words, log="fast.csv"), self.recommended(*words)
        self.assertGreater(fast["torque_rate_nm_s"], 10 * slow["torque_rate_nm_s"])
        self.assertLessEqual(fast["methods"][0]["longest_delay_ms"], slow["methods"][0]["longest_delay_ms"])

    def test_the_band_that_is_stated_decides(self):
        """A torque that is slow here and fast at work: the delay of an oscillator at 5 Hz is told, and held to the limit."""
        found, stated = self.recommended(), self.recommended("--torque-band", "0:10Hz")
        self.assertFalse(found["torque_band_hz"]["stated"])
        self.assertLess(found["torque_band_hz"]["to"], 1.0)
        self.assertEqual(stated["torque_band_hz"], {"from": 0, "to": 10, "stated": True, "at_rest": False})
        slow, fast = (next(one for one in told["methods"] if one["method"] == "oscillator,gear-ratio=100,orders=1:2") for told in (found, stated))
        self.assertLess(slow["longest_delay_ms"], 1.0)
        self.assertGreater(fast["longest_delay_ms"], 5.0)
        self.assertGreater(fast["within_band"]["largest_gain"], 1.1)
        held = self.recommended("--torque-band", "0:10Hz", "--max-delay", "3ms")
        self.assertFalse(next(one for one in held["methods"] if one["method"] == fast["method"])["meets"])
        self.assertEqual([one["error_nm"] for one in stated["methods"]], sorted(one["error_nm"] for one in stated["methods"]))
        for words in ("5Hz", "10Hz:5Hz", "0:5Nm"):
            self.assertEqual(self.run_tool("recommend", "log.csv", *GEAR, "--torque-band", words).returncode, 2)

    def test_a_method_that_cannot_run_at_the_rate_is_left_out_with_its_reason(self):
        lines = (self.folder / "log.csv").read_text().splitlines()
        (self.folder / "rare.csv").write_text("\n".join([lines[0], *lines[1::20]]) + "\n")
        told = self.recommended(log="rare.csv")
        self.assertTrue(any("quarter of the sample rate" in one for one in told["left_out"]), told["left_out"])
        self.assertNotIn("oscillator", {one["method"].split(",")[0] for one in told["methods"]} - {"map"})
        words = ("compare", "rare.csv", *GEAR, "--method", "oscillator")
        ended(0, self.run_tool(*words, "--method", "tracking"), "it is left out")
        self.assertEqual(self.run_tool(*words).returncode, 2)

    def test_standard_input_is_refused(self):
        for words, said in ((("-",), "name a file"), (("log.csv", "--train", "95"), "10 to 90")):
            ended(2, self.run_tool("recommend", *words, *GEAR), said)

    def test_what_was_assumed_is_listed(self):
        done = ended(0, self.run_tool("recommend", "log.csv", *GEAR))
        for part in ("Use ", "To use it:", "Assumed:", "gear ratio 100, as stated", "Not tried:"):
            self.assertIn(part, done.stdout)


class Robot(Recommended):
    @unittest.skipUnless((LOGS / "gpl3" / "panda_gaz_j1.csv").exists(), "SKIPPED: the folder of real logs is not here")
    def test_on_a_robot_it_beats_the_notch_that_one_would_have_taken(self):
        told = self.recommended("--max-delay", "10ms", "--min-attenuation", "12dB", log=LOGS / "gpl3" / "panda_gaz_j1.csv",
                                gear=["--gear-ratio", "120", "--orders", "1,2"])
        self.assertEqual(told["take"].split(",")[0], "oscillator")
        self.assertEqual(told["take"], "oscillator,map=map.json")
        self.assertTrue(all(one["db"] >= 12 for one in told["methods"][0]["attenuation_db"]))
