# SPDX-License-Identifier: MIT
"""ripplenotch compare as users meet it: the paper's figures on steps and ramps, logs, the low-pass of equal ripple."""

import json
import math
import os
import pathlib
import unittest

from commands import DATA, Case, ended, run
from test_wrapped import on_terminal

LOG = str(DATA / "paper_90deg_s.csv")

SIGNALS = ["--step", "10Nm", "--ramp", "20Nm/s", "--speed", "90deg/s", "--sample-rate", "1kHz"]
RIPPLE = ["--gear-ratio", "100", "--orders", "1,2"]
NOTCHES = "fixed,centers=25Hz:50Hz,q=0.25"
MISLABELLED = "lowpass,cutoff=13rad/s,order=1"
AS_PRINTED = "lowpass,cutoff=13Hz,order=1"


def methods(*names):
    return [word for name in names for word in ("--method", name)]


def synthetic_log(seconds=20, speed=80.0, rate=1000, ratio=100.0):
    """CSV with 0.8 Nm of order 1 and 0.5 Nm of order 2 at a constant speed."""
    rows = ["time_s,velocity_deg_s,torque_nm"]
    for k in range(seconds * rate):
        angle = math.radians(ratio * speed * k / rate)
        rows.append(f"{k / rate:.3f},{speed},{4 + 0.8 * math.sin(angle) + 0.5 * math.cos(2 * angle):.9f}")
    return "\n".join(rows) + "\n"


class Comparison(Case):
    def compare(self, *words, **more):
        done = ended(0, run("compare", *words, "--json", **more))
        result = json.loads(done.stdout)
        self.assertEqual(result["schema"], "ripplenotch/comparison/1")
        return result, {row["method"]: row for row in result["methods"]}


class Signals(Comparison):
    def test_the_papers_figures_hold(self):
        result, rows = self.compare(*SIGNALS, *RIPPLE, *methods(NOTCHES, MISLABELLED, AS_PRINTED))
        self.assertEqual([row["method"] for row in result["methods"]], ["none", NOTCHES, MISLABELLED, AS_PRINTED])
        self.assertAlmostEqual(rows[NOTCHES]["settle_ms"]["0.5"], 147, delta=1)
        self.assertAlmostEqual(rows[NOTCHES]["ramp_delay_ms"], 38.0, delta=0.1)
        self.assertAlmostEqual(rows[MISLABELLED]["settle_ms"]["0.5"], 408, delta=1)
        self.assertAlmostEqual(rows[MISLABELLED]["ramp_delay_ms"], 76.9, delta=0.1)
        self.assertAlmostEqual(rows[AS_PRINTED]["settle_ms"]["0.5"], 65, delta=1)
        self.assertAlmostEqual(rows[AS_PRINTED]["ramp_delay_ms"], 12.2, delta=0.1)

    def test_the_control_is_shown_unasked_and_costs_nothing(self):
        _, rows = self.compare(*SIGNALS, *RIPPLE, *methods(NOTCHES))
        self.assertEqual(rows["none"]["settle_ms"], {"0.5": 0, "1": 0, "2": 0, "5": 0})
        self.assertEqual((rows["none"]["ramp_delay_ms"], rows["none"]["dc_delay_ms"]), (0, 0))
        for entry in rows["none"]["attenuation_db"]:
            self.assertAlmostEqual(entry["db"], 0, places=9)
        result, _ = self.compare(*SIGNALS, *methods(NOTCHES, "none"))
        self.assertEqual([row["method"] for row in result["methods"]], [NOTCHES, "none"])

    def test_every_method_has_the_promised_fields_and_null_where_nothing_was_asked(self):
        _, rows = self.compare("--ramp", "20Nm/s", "--sample-rate", "1kHz", *methods(NOTCHES))
        self.assertEqual(list(rows[NOTCHES]), [
            "method", "settle_ms", "overshoot_percent", "undershoot_percent", "ramp_overshoot_nm", "ramp_delay_ms", "dc_delay_ms",
            "phase_lag_deg", "crossover_db", "attenuation_db", "ripple_rms_nm", "residual_rms_nm", "residual_peak_to_peak_nm",
            "error_nm", "distortion_nm", "added_nm", "start_ratio", "switches", "largest_jump_nm", "error_rms_nm", "note", "within_max_delay_from_deg_s", "ledger",
            "switch_ledger"])
        for name in ("settle_ms", "overshoot_percent", "ripple_rms_nm", "residual_rms_nm", "switches"):
            self.assertIsNone(rows[NOTCHES][name])
        self.assertEqual(rows[NOTCHES]["attenuation_db"], [])

    def test_ramp_delay_and_dc_delay_agree(self):
        _, rows = self.compare(*SIGNALS, *methods(NOTCHES, MISLABELLED, "fixed,centers=8Hz,q=3", "lowpass,cutoff=4Hz,order=5"))
        for row in rows.values():
            self.assertAlmostEqual(row["ramp_delay_ms"], row["dc_delay_ms"], delta=1e-4)

    def test_the_height_of_a_step_and_the_slope_of_a_ramp_do_not_matter(self):
        _, rows = self.compare(*SIGNALS, *methods(NOTCHES))
        _, others = self.compare("--step", "-250mNm", "--ramp", "-3Nm/s", "--speed", "90deg/s", "--sample-rate", "1kHz",
                                 *methods(NOTCHES))
        self.assertEqual(rows[NOTCHES]["settle_ms"], others[NOTCHES]["settle_ms"])
        self.assertAlmostEqual(rows[NOTCHES]["ramp_delay_ms"], others[NOTCHES]["ramp_delay_ms"], places=6)

    def test_the_text_begins_with_a_verdict_in_numbers_and_shows_a_row_per_method(self):
        done = run("compare", *SIGNALS, *RIPPLE, *methods(NOTCHES, MISLABELLED))
        verdict, _, rest = done.stdout.partition("\n\n")
        lines = rest.split("\n")
        self.assertEqual(verdict, f"{NOTCHES} settles 2.8 times faster than {MISLABELLED} (147 against 408 ms to 0.5 %), "
                                   "lags 38.9 ms less (38.0 against 76.9 ms). It attenuates its weakest line "
                                   "by more than 200 dB against 21.7 dB.")
        for name in ("none", NOTCHES, MISLABELLED):
            self.assertEqual(sum(line.startswith(name + "  ") for line in lines), 2)  # costs, and what is left

    def test_no_line_is_wider_than_a_hundred_columns_but_what_is_there_to_be_copied(self):
        fixed = [f"oscillator,gear-ratio=100,orders=1:2,amplitudes={a}:0.5,phases={a}12345:0.012345678" for a in (0.7, 0.8)]
        move = str(DATA / "paper_move_2s.csv")
        text = on_terminal(100, "compare", move, *RIPPLE, "--truth", move, "--crossover", "12Hz", "--max-delay", "40ms",
                           *methods(*fixed, MISLABELLED, NOTCHES, "lowpass,cutoff=1.894387654321Hz,order=1"), code=1)
        self.assertNotIn("-0.0 ", text)
        told = [line for line in text.split("\n") if " is --method " not in line]
        self.assertLessEqual(max(map(len, told)), 100, text)
        for letter, method in zip("AB", fixed):
            self.assertIn(f"\noscillator {letter} is --method {method}\n", text)
            self.assertIn(f"\noscillator {letter}  ", text)
        for figure in ("to 0.5 %", "lag at 12 Hz", "order 2", "residual", "error"):
            self.assertIn(figure, text)

    def test_switching_uses_the_band_of_the_speed(self):
        run("design", *RIPPLE, "--sample-rate", "1kHz", "--speed", "18:180:18", "-o", "table.json", cwd=self.folder)
        name = "switching,table=table.json"
        result, rows = self.compare(*SIGNALS, *methods(name), cwd=self.folder)
        band = json.loads((self.folder / "table.json").read_text())["bands"][3]
        self.assertEqual(result["orders"], [1, 2])
        self.assertEqual(result["inputs"][0]["name"], "table.json")
        self.assertAlmostEqual(rows[name]["dc_delay_ms"], band["dc_delay_ms"], places=6)  # nine digits
        self.assertAlmostEqual(rows[name]["settle_ms"]["0.5"], band["settle_ms"], places=6)
        self.assertIn("band 4", rows[name]["note"])


class Logs(Comparison):
    def test_attenuation_is_measured_on_the_log_itself(self):
        _, rows = self.compare("-", *RIPPLE, *methods(MISLABELLED), stdin=synthetic_log())
        for entry, hz in zip(rows[MISLABELLED]["attenuation_db"], (80 / 3.6, 2 * 80 / 3.6)):
            self.assertAlmostEqual(entry["hz"], hz, places=3)
            expected = 10 * math.log10(1 + (math.tan(math.pi * hz / 1000) / math.tan(13 / 2 / 1000)) ** 2)
            self.assertAlmostEqual(entry["db"], expected, delta=0.5)
        self.assertAlmostEqual(rows["none"]["ripple_rms_nm"], math.hypot(0.8, 0.5) / math.sqrt(2), places=3)

    def test_the_papers_log_loses_its_ripple_in_the_notches(self):
        result, rows = self.compare(LOG, *RIPPLE, *methods(NOTCHES, MISLABELLED))
        self.assertAlmostEqual(result["speed_deg_s"], 90, places=6)
        self.assertGreater(rows["none"]["residual_peak_to_peak_nm"], 1.5)
        self.assertLess(rows[NOTCHES]["residual_peak_to_peak_nm"], 0.3)
        self.assertLess(rows[NOTCHES]["residual_rms_nm"], rows["none"]["residual_rms_nm"] / 10)
        self.assertAlmostEqual(rows[NOTCHES]["settle_ms"]["0.5"], 147, delta=1)

    def test_a_file_and_a_pipe_give_the_same_figures(self):
        words = [*RIPPLE, *methods(NOTCHES)]
        from_file, _ = self.compare(LOG, *words)
        from_pipe, _ = self.compare("-", *words, stdin=pathlib.Path(LOG).read_text())
        self.assertEqual(from_file["methods"], from_pipe["methods"])
        self.assertEqual(from_file["verdict"], from_pipe["verdict"])

    def test_switches_are_counted_where_a_method_switches(self):
        table = os.path.join(self.folder, "table.json")
        run("design", *RIPPLE, "--sample-rate", "1kHz", "--speed", "18:180:18", "-o", table)
        name = f"switching,table={table}"
        _, rows = self.compare(str(DATA / "paper_move_2s.csv"), *methods(name, MISLABELLED))
        self.assertGreaterEqual(rows[name]["switches"], 16)
        self.assertIsNone(rows["none"]["switches"])
        self.assertIsNone(rows[MISLABELLED]["switches"])

    def test_a_table_for_another_rate_is_refused(self):
        table = os.path.join(self.folder, "table.json")
        run("design", *RIPPLE, "--sample-rate", "500Hz", "--speed", "18:180:18", "-o", table)
        ended(3, run("compare", LOG, *methods(f"switching,table={table}")), "the log runs at 1000 Hz, the table was designed for 500 Hz")

    def test_without_gear_ratio_the_delays_still_come_with_a_warning(self):
        done = ended(0, run("compare", LOG, *methods(NOTCHES), "--json"), "no line is known, so no ripple was measured")
        row = json.loads(done.stdout)["methods"][1]
        self.assertIsNone(row["residual_rms_nm"])
        self.assertAlmostEqual(row["ramp_delay_ms"], 38.0, delta=0.1)

    def test_a_log_at_rest_has_no_ripple_to_measure_and_says_why(self):
        done = ended(0, run("compare", str(DATA / "paper_rest.csv"), *RIPPLE, *methods(NOTCHES), "--json"))
        result = json.loads(done.stdout)
        self.assertEqual(result["windows"], 0)
        self.assertIsNone(result["methods"][0]["ripple_rms_nm"])
        self.assertIn("cannot be measured on this log", done.stderr)


class Best(Comparison):
    """The first sentence is recommend's, about the stated methods."""

    MOVE = str(DATA / "paper_move_2s.csv")
    TRACKING, OSCILLATOR = (f"{name},gear-ratio=100,orders=1:2" for name in ("tracking", "oscillator"))

    def told(self, *words, code=0):
        """The document, and the first sentence of the text, which is its reason."""
        done = ended(code, run("compare", *words, "--json"))
        result = json.loads(done.stdout)
        rows = {row["method"]: row for row in result["methods"]}
        text = run("compare", *words).stdout
        sentence = text.split("\n")[0]
        self.assertTrue(result["verdict"].startswith(sentence + " "), sentence)
        if result["best"]:
            self.assertEqual(result["best"]["reason"], sentence)
        return result, rows, sentence

    def limited(self, delay):
        return self.told(self.MOVE, *RIPPLE, *methods("oscillator", "tracking"), "--max-delay", delay, code=1)

    def test_it_is_the_method_of_the_smallest_error(self):
        result, rows, sentence = self.told(self.MOVE, *RIPPLE, *methods("oscillator", "tracking"))
        best = result["best"]
        self.assertEqual((best["method"], best["meets"]), (self.OSCILLATOR, True))
        self.assertEqual(best["error_nm"], min(row["error_nm"] for row in rows.values()))
        self.assertEqual(best["ripple_rms_nm"], rows[self.OSCILLATOR]["ripple_rms_nm"])
        self.assertRegex(sentence, r"^Use an oscillator \(oscillator\): order 1 down \d\d dB, order 2 down \d\d dB, at most \d\.\d ms delay; "
                                   r"0\.00\d+ Nm of 0\.67 Nm rms is left\.")

    def test_the_page_has_its_figures_at_the_top(self):
        run("compare", self.MOVE, *RIPPLE, *methods("oscillator", "tracking"), "-o", "c.json", cwd=self.folder)
        ended(0, run("report", "c.json", "-o", "c.html", "-q", cwd=self.folder))
        page = (self.folder / "c.html").read_text()
        self.assertIn("oscillator: remaining ripple (rms)", page)
        self.assertNotIn("tracking: remaining ripple (rms)", page)

    def test_limits_exclude_what_breaks_them(self):
        result, _, sentence = self.limited("5ms")
        self.assertEqual(result["best"]["method"], self.OSCILLATOR)
        self.assertTrue(sentence.startswith("Use an oscillator (oscillator): "), sentence)
        result, _, sentence = self.limited("1us")
        self.assertIsNone(result["best"])
        self.assertRegex(sentence, r"^None fits: the nearest is oscillator at \d\.\d ms of delay \(asked: 0\.001 ms\)\.$")

    def test_where_a_filter_does_more_harm_than_the_ripple_nothing_is_better_than_none(self):
        result, _, sentence = self.told(self.MOVE, *RIPPLE, *methods("lowpass,cutoff=0.05Hz,order=1"))
        self.assertEqual(result["best"]["method"], "none")
        self.assertRegex(sentence, r"^Leave the torque as it is: each filter tried errs by more than its ripple\. The best, lowpass,\S+: "
                                   r"error [\d.]+ instead of 0\.97 Nm rms\.$")

    def test_what_cannot_be_told_says_why(self):
        for words, why in (((str(DATA / "paper_rest.csv"), *RIPPLE), "Cannot tell: order 1: the joint nowhere turns"),
                           ((self.MOVE, "--gear-ratio", "100", "--orders", "7"), "No filter recommended: order 7: no ripple above ")):
            with self.subTest(why):
                result, _, sentence = self.told(*words, *methods(NOTCHES))
                self.assertIsNone(result["best"])
                self.assertTrue(sentence.startswith(why), sentence)

    def test_without_a_log_there_is_no_torque_to_be_in_error_about(self):
        result, _ = self.compare(*SIGNALS, *RIPPLE, *methods(NOTCHES))
        self.assertIsNone(result["best"])
        self.assertNotIn("best", result["verdict"])

    def test_of_several_joints_each_has_its_own(self):
        with open(self.MOVE) as log:
            rows = [line.strip().split(",") for line in log]
        columns = [rows[0].index(name) for name in ("time_s", "velocity_deg_s", "torque_nm")]
        wide = ["time_s,j1_velocity_deg_s,j1_torque_nm,j2_velocity_deg_s,j2_torque_nm"]
        for row in rows[1:]:
            t, v, nm = (row[c] for c in columns)
            wide.append(",".join((t, v, nm, v, nm)))
        (self.folder / "wide.csv").write_text("\n".join(wide) + "\n")
        text = run("compare", "wide.csv", *RIPPLE, *methods("tracking"), cwd=self.folder).stdout
        for joint in ("j1", "j2"):
            self.assertRegex(text, rf"(?m)^{joint}: Use tracking notches ")


REAL = pathlib.Path(os.environ.get("RIPPLENOTCH_LOGS", "")) / "gpl3"


@unittest.skipUnless(REAL.is_dir(), "the real logs are not here")
class RealLogs(Comparison):
    def test_a_slow_low_pass_takes_the_ripple_of_a_franka_panda(self):
        for name in ("panda_gaz_j1.csv", "panda_gaz_j4.csv"):
            result, rows = self.compare(str(REAL / name), "--gear-ratio", "120", "--orders", "1,2",
                                        *methods("fixed,centers=20Hz:40Hz,q=0.5", MISLABELLED))
            self.assertGreater(result["windows"], 20)
            self.assertGreater(rows["none"]["residual_peak_to_peak_nm"], 1.0)
            for entry in rows[MISLABELLED]["attenuation_db"]:
                self.assertGreater(entry["db"], 5)


class Refusals(unittest.TestCase):
    def refused(self, words, *parts, code=2):
        done = run("compare", *words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(done.stdout, "")
        for part in parts:
            self.assertIn(part, done.stderr)

    def test_what_is_missing_is_named(self):
        self.refused(SIGNALS, "--method")
        self.refused([*methods(NOTCHES), "--sample-rate", "1kHz"], "--step 10Nm")
        self.refused([*methods(NOTCHES), "--step", "10Nm"], "--sample-rate")
        self.refused([*methods(NOTCHES), "--step", "10Nm", "--sample-rate", "1kHz", *RIPPLE], "--speed")
        self.refused([*SIGNALS, *methods(NOTCHES), "--orders", "1"], "give --gear-ratio")
        self.refused([*SIGNALS, *methods("switching")], "table")

    def test_what_makes_no_sense_is_named(self):
        self.refused([*SIGNALS, *methods("fixd,centers=25Hz")], "fixed")
        self.refused([*SIGNALS, *methods("fixed,centers=600Hz")], "half the sample rate")
        self.refused([*SIGNALS, *methods("lowpass,cutoff=-1Hz")], "cutoff")
        self.refused(["--step", "0Nm", "--sample-rate", "1kHz", *methods(NOTCHES)], "no step")
        self.refused(["--ramp", "0Nm/s", "--sample-rate", "1kHz", *methods(NOTCHES)], "no ramp")

    def test_files_that_cannot_be_used(self):
        self.refused(["no-such.csv", *methods(NOTCHES)], "no-such.csv", code=4)
        self.refused([*SIGNALS, *methods("switching,table=no-such.json")], "no-such.json", code=4)


class Truth(Comparison):
    JOINT = ["--gear-ratio", "100", "--motion", "ramp,to-speed=170deg/s,duration=3s", "--sample-rate", "1kHz"]

    def setUp(self):
        super().setUp()
        for name, more in (("true.csv", []), ("log.csv", ["--ripple", "1:0.8Nm:0deg", "--noise", "0.05Nm"])):
            ended(0, run("simulate", *self.JOINT, "--effect", "offset,torque_nm=4", *more, "-o", name, cwd=self.folder))
        ended(0, run("design", *RIPPLE, "--sample-rate", "1kHz", "--speed", "18:180:18", "-o", "table.json",
                     cwd=self.folder))

    def torque(self, name):
        lines = (self.folder / name).read_text().splitlines()[1:]
        return [float(line.split(",")[2]) for line in lines]

    def test_the_error_is_the_rms_difference_from_the_true_torque(self):
        switching = "switching,table=table.json,transition=parallel"
        _, rows = self.compare("log.csv", "--truth", "true.csv", *RIPPLE, *methods(switching), cwd=self.folder)
        for method, row in rows.items():
            done = run("filter", "--method", method, "log.csv", "-o", "out.csv", "--force", "--json",
                       cwd=self.folder)
            out, truth = self.torque("out.csv"), self.torque("true.csv")
            expected = math.sqrt(sum((a - b) ** 2 for a, b in zip(out, truth)) / len(out))
            self.assertAlmostEqual(row["error_rms_nm"], expected, places=9)
            jumps = [abs(s["jump_nm"]) for s in json.loads(done.stdout)["switches"]]
            self.assertEqual(row["largest_jump_nm"], max(jumps) if method == switching else None)

    def test_each_switch_has_its_own_peak_error_and_settling_in_the_ledger(self):
        method = "switching,table=table.json"
        words = ["log.csv", *RIPPLE, *methods(method)]
        _, rows = self.compare(*words, "--truth", "true.csv", "-v", cwd=self.folder)
        done = run("filter", "--method", method, "log.csv", "-o", "out.csv", "--force", "--json", cwd=self.folder)
        out, truth = self.torque("out.csv"), self.torque("true.csv")
        errors = [abs(a - b) for a, b in zip(out, truth)]
        scale = max(truth) - min(truth)
        ledger, switches = rows[method]["switch_ledger"], json.loads(done.stdout)["switches"]
        self.assertGreater(len(switches), 5)
        ends = [s["sample"] for s in switches[1:]] + [len(out)]
        for entry, switch, end in zip(ledger, switches, ends, strict=True):
            self.assertEqual({key: entry[key] for key in switch}, switch)
            start = switch["sample"]
            stretch = errors[start:end]
            self.assertAlmostEqual(entry["stretch_ms"], len(stretch) - 1, places=6)
            self.assertAlmostEqual(entry["error_before_nm"], errors[start - 1], places=9)
            self.assertAlmostEqual(entry["peak_error_nm"], max(stretch), places=9)
            self.assertAlmostEqual(entry["peak_after_ms"], stretch.index(max(stretch)), places=6)
            for percent, settled in entry["settle_ms"].items():
                outside = [k for k, error in enumerate(stretch) if error > 0.01 * float(percent) * scale]
                after = outside[-1] + 1 if outside else 0
                if after == len(stretch):
                    self.assertIsNone(settled)
                else:
                    self.assertAlmostEqual(settled, after, places=6)
        self.assertEqual(rows["none"]["switch_ledger"], [])
        _, plain = self.compare(*words, "--truth", "true.csv", cwd=self.folder)
        self.assertEqual(plain[method]["switch_ledger"], [])
        _, unknown = self.compare(*words, "-v", cwd=self.folder)
        for entry, switch in zip(unknown[method]["switch_ledger"], switches, strict=True):
            self.assertEqual(entry["jump_nm"], switch["jump_nm"])
            self.assertIsNone(entry["peak_error_nm"])
            self.assertEqual(set(entry["settle_ms"].values()), {None})

    def test_a_truth_that_cannot_be_held_against_the_log_is_refused(self):
        words = ["compare", "log.csv", *methods("none")]
        short = self.folder / "short.csv"
        lines = (self.folder / "true.csv").read_text().splitlines()
        pathlib.Path(short).write_text("\n".join(lines[:-5]) + "\n")
        ended(3, run(*words, *RIPPLE, "--truth", "short.csv", cwd=self.folder), "short.csv has 2995 rows, log.csv has 3000")
        ended(2, run(*words, "--truth", "true.csv", cwd=self.folder), "--gear-ratio")
        ended(2, run("compare", *SIGNALS, *methods("none"), "--truth", "true.csv", cwd=self.folder), "--truth goes with a LOG")
