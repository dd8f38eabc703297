# SPDX-License-Identifier: MIT
"""ripplenotch design as users meet it: Table 1 of the paper in three forms, units, and what is refused."""

import csv
import io
import json
import unittest

from commands import DATA, Case, ended, run


PAPER = ["--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "18:180:18", "--q", "0.25"]
TABLE_1 = [
    # band, from, to (deg/s), centre 1, centre 2 (Hz), as printed in the paper
    (1, "18", "36", "7.5", "15"),
    (2, "36", "54", "12.5", "25"),
    (3, "54", "72", "17.5", "35"),
    (4, "72", "90", "22.5", "45"),
    (5, "90", "108", "27.5", "55"),
    (6, "108", "126", "32.5", "65"),
    (7, "126", "144", "37.5", "75"),
    (8, "144", "162", "42.5", "85"),
    (9, "162", "180", "47.5", "95"),
]


def design(*words, **more):
    return run("design", *words, **more)


def with_option(words, name, *values):
    """PAPER with one option replaced, or left out when no value is given."""
    at = words.index(name)
    return words[:at] + ([name, *values] if values else []) + words[at + 2:]


class Table1(Case):
    def test_text_has_the_papers_bands_and_centres(self):
        done = design(*PAPER)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        rows = [line.split() for line in done.stdout.split("\n") if line.strip()[:1].isdigit()]
        self.assertEqual([(int(r[0]), *r[1].split("-"), r[2], r[3]) for r in rows], TABLE_1)
        self.assertIn("At 18 deg/s and below the torque passes unfiltered; above 180 deg/s band 9 stays active.",
                      done.stdout)

    def test_csv_has_the_papers_bands_and_centres_under_stable_names(self):
        ended(0, design(*PAPER, "-o", "table.csv", cwd=self.folder))
        rows = list(csv.DictReader(io.StringIO((self.folder / "table.csv").read_text())))
        self.assertEqual(list(rows[0]), [
            "number", "speed_from_deg_s", "speed_to_deg_s", "center_1_hz", "center_2_hz", "q", "dc_delay_ms",
            "settle_ms", "overshoot_percent", "worst_attenuation_1_db", "worst_attenuation_2_db"])
        self.assertEqual([(int(r["number"]), r["speed_from_deg_s"], r["speed_to_deg_s"], r["center_1_hz"],
                           r["center_2_hz"]) for r in rows], TABLE_1)
        for row in rows:
            self.assertEqual(len(row), 11)
            for cell in row.values():
                float(cell)

    def test_json_has_the_papers_bands_and_centres_as_exact_numbers(self):
        table = json.loads(design(*PAPER, "--json").stdout)
        self.assertEqual(table["schema"], "ripplenotch/table/1")
        self.assertEqual(len(table["bands"]), 9)
        for band, row in zip(table["bands"], TABLE_1):
            self.assertEqual((band["number"], band["speed_from_deg_s"], band["speed_to_deg_s"],
                              band["notches"][0]["center_hz"], band["notches"][1]["center_hz"]),
                             (row[0], *map(float, row[1:])))
            self.assertEqual(band["settle_band_percent"], 0.5)

    def test_two_ways_to_say_the_same_bands_give_the_same_table(self):
        by_width = json.loads(design(*PAPER, "--json").stdout)["bands"]
        listed = with_option(PAPER, "--speed") + ["--bands", ",".join(f"{r[1]}:{r[2]}" for r in TABLE_1)]
        self.assertEqual(json.loads(design(*listed, "--json").stdout)["bands"], by_width)

    def test_the_same_request_gives_the_same_bytes_and_the_command_line_reproduces_it(self):
        first = design(*PAPER, "--json").stdout
        self.assertEqual(first, design(*PAPER, "--json").stdout)
        words = json.loads(first)["command"].split()
        self.assertEqual(words[:2], ["ripplenotch", "design"])
        self.assertEqual(design(*words[2:], "--json").stdout, first)

    def test_the_name_of_the_output_file_chooses_the_form(self):
        for name in ("table.json", "table.csv", "table.txt"):
            done = design(*PAPER, "-o", name, cwd=self.folder)
            self.assertEqual((done.returncode, done.stdout), (0, ""))
        read = {p.suffix: p.read_text() for p in self.folder.iterdir()}
        self.assertEqual(read[".json"], design(*PAPER, "--json").stdout)
        self.assertTrue(read[".csv"].startswith("number,speed_from_deg_s,"))
        self.assertEqual(read[".txt"], design(*PAPER).stdout)


def joint(ratio=100.0, orders=(1.0, 2.0), speeds=(58.6, 179.2), rate=1000.0, ci95=(99.8, 100.2)):
    """A joint.json with lines of equal strength, as identify writes it."""
    lines = [{"kind": "order", "order": order, "order_output": order * (ratio or 100.0), "order_output_stderr": 0.1,
              "hz": None, "amplitude_nm": 0.5, "phase_deg": None, "snr": 20.0, "speed_range_deg_s": list(speeds),
              "amplitude_by_speed": [], "note": ""} for order in orders]
    lines.append(dict(lines[0] if lines else {}, kind="tone", order=None, order_output=None, order_output_stderr=None,
                      hz=50.0, amplitude_nm=0.1, phase_deg=None, snr=9.0, speed_range_deg_s=[0.0, 500.0],
                      amplitude_by_speed=[], note="mains"))
    return json.dumps({
        "schema": "ripplenotch/joint/1", "tool": "ripplenotch", "version": "0", "command": "", "inputs": [],
        "verdict": "a joint", "conclusive": ratio is not None, "joint": "", "sample_rate_hz": rate,
        "evidence": "steady stretches",
        "gear_ratio": {"value": ratio, "stderr": 0.1, "ci95": list(ci95), "candidates": [], "residuals": []},
        "lines": lines, "notes": []})


class FromJoint(Case):
    def table(self, text, *words, stderr=""):
        done = ended(0, design("-", *words, "--json", stdin=text), stderr)
        return json.loads(done.stdout)

    def test_ratio_orders_and_rate_come_from_the_file(self):
        self.assertEqual(self.table(joint(ci95=(100.0, 100.0)), "--speed", "18:180:18")["bands"],
                         json.loads(design(*PAPER, "--amplitudes", "0.5,0.5", "--json").stdout)["bands"])

    def test_an_option_wins_over_the_file(self):
        table = self.table(joint(), "--speed", "18:180:18", "--orders", "2", "--gear-ratio", "50",
                           "--sample-rate", "2kHz")
        self.assertEqual((table["gear_ratio"], table["orders"], table["sample_rate_hz"]), (50, [2], 2000))

    def test_without_speeds_the_bands_cover_what_was_seen_five_hertz_apart(self):
        bands = self.table(joint())["bands"]
        self.assertEqual(bands[0]["speed_from_deg_s"], 58)
        self.assertGreaterEqual(bands[-1]["speed_to_deg_s"], 179.2)
        for before, after in zip(bands, bands[1:]):
            self.assertEqual(before["speed_to_deg_s"], after["speed_from_deg_s"])
            self.assertAlmostEqual(after["notches"][0]["center_hz"] - before["notches"][0]["center_hz"], 5.0, places=9)

    def test_an_uneven_ratio_gives_bands_of_a_round_width_all_the_same(self):
        for ratio, width in ((99.99998, 18), (120.57, 15), (1000 / 3, 5.4)):
            for band in self.table(joint(ratio=ratio))["bands"]:
                self.assertAlmostEqual(band["speed_to_deg_s"] - band["speed_from_deg_s"], width, places=9)

    def test_a_joint_seen_at_one_speed_gets_one_band_around_it(self):
        band, = self.table(joint(speeds=(90.0, 90.0)))["bands"]
        self.assertEqual((band["speed_from_deg_s"], band["speed_to_deg_s"]), (81, 99))
        self.assertEqual(band["notches"][0]["center_hz"], 25.0)

    def test_bands_seen_end_where_the_centre_reaches_half_the_sample_rate(self):
        table = self.table(joint(rate=125.0), stderr="is not below half the sample rate; the bands end at")
        centers = [n["center_hz"] for b in table["bands"] for n in b["notches"]]
        self.assertLess(max(centers), 62.5)

    def test_the_file_is_recorded_with_its_hash(self):
        (self.folder / "joint.json").write_text(joint())
        table = json.loads(design("joint.json", "--json", cwd=self.folder).stdout)
        self.assertEqual(table["inputs"][0]["name"], "joint.json")
        self.assertRegex(table["inputs"][0]["sha256"], "^[0-9a-f]{64}$")

    def test_another_ratio_keeps_the_frequencies_of_the_lines(self):
        found = self.table(joint(ratio=None, orders=(1.0, 2.0)), "--gear-ratio", "50.1", "--speed", "80:100:20")
        self.assertEqual(found["orders"], [2, 4])
        uneven = self.table(joint(), "--gear-ratio", "70", "--speed", "80:100:20")
        self.assertAlmostEqual(uneven["bands"][0]["notches"][0]["center_hz"], 25.0, places=9)

    def test_a_line_seen_at_one_speed_counts_when_the_ratio_rests_on_it(self):
        text = joint(speeds=(49.6, 49.8)).replace('"kind": "order"', '"kind": "unknown"')
        self.assertEqual(self.table(text)["orders"], [1, 2])

    def test_the_option_line_that_is_said_with_v_gives_the_same_bands(self):
        done = design("-", "--json", "-v", stdin=joint(ratio=100.03, ci95=(100.03, 100.03)))
        said = done.stderr.split("designed as if with ")[1].split()
        self.assertEqual(json.loads(design(*said, "--json").stdout)["bands"], json.loads(done.stdout)["bands"])

    def test_a_joint_without_a_ratio_asks_for_gear_ratio_and_is_exit_code_3(self):
        found = self.table(joint(ratio=None))  # nor is one needed: its lines turn with the joint
        self.assertIsNone(found["gear_ratio"])
        self.assertEqual(found["orders"], [100, 200])
        self.assertEqual(found["gear"]["ratio"], None)
        ended(3, design("-", stdin=joint(ratio=None, orders=())), "gear ratio is null", "--gear-ratio")
        self.assertEqual(self.table(joint(ratio=None), "--gear-ratio", "100")["gear_ratio"], 100)

    def test_a_joint_without_lines_asks_for_orders(self):
        ended(3, design("-", stdin=joint(orders=())), "no line that follows the motor; give --orders")

    def test_a_file_that_is_no_joint_is_exit_code_3_and_a_missing_one_4(self):
        ended(3, design("-", stdin="{\"schema\": \"ripplenotch/table/1\"}"), "ripplenotch/joint/1")
        self.assertEqual(design("-", stdin="rubbish").returncode, 3)
        self.assertEqual(design("no-such.json").returncode, 4)


class PapersChain(unittest.TestCase):
    def test_from_the_papers_logs_to_its_table(self):
        logs = [str(DATA / f"paper_{speed}deg_s.csv") for speed in (60, 120, 180)]
        found = run("identify", *logs, "--json")
        done = ended(0, design("-", "--speed", "18:180:18", stdin=found.stdout))
        rows = [line.split() for line in done.stdout.split("\n") if line.strip()[:1].isdigit()]
        self.assertEqual([(int(r[0]), *r[1].split("-"), r[2], r[3]) for r in rows], TABLE_1)


class Units(unittest.TestCase):
    def bands(self, *words):
        done = ended(0, design(*with_option(PAPER, "--speed"), *words, "--json"))
        return [(b["speed_from_deg_s"], b["speed_to_deg_s"]) for b in json.loads(done.stdout)["bands"]]

    def test_a_unit_on_the_last_number_holds_for_all(self):
        for text in ("0.3:0.6rad/s", "0.3rad/s:0.6rad/s"):
            (low, high), = self.bands("--bands", text)
            self.assertAlmostEqual(low, 17.188733853924695, places=9)
            self.assertAlmostEqual(high, 34.37746770784939, places=9)
        self.assertEqual(self.bands("--speed", "3:30:3rpm"), self.bands("--speed", "18:180:18"))

    def test_a_list_may_leave_holes_and_use_another_unit_in_each_band(self):
        self.assertEqual(self.bands("--bands", "18:36,10:20rpm"), [(18, 36), (60, 120)])

    def test_a_mixture_of_numbers_with_and_without_unit_is_refused(self):
        ended(2, design(*with_option(PAPER, "--speed"), "--speed", "0.3rad/s:3:0.3"), "mixes numbers with and without a unit")


class OneLetterNames(unittest.TestCase):
    def test_q_is_the_quality_and_minus_q_is_quiet(self):
        narrow = design(*with_option(PAPER, "--q", "2")).stdout
        self.assertNotEqual(narrow, design(*PAPER).stdout)
        for words in (["--q=2"], ["--quality", "2"], ["--quality=2"], ["-q", "--q", "2"], ["--q", "2", "-q"]):
            self.assertEqual(design(*with_option(PAPER, "--q"), *words).stdout, narrow, words)
        twice = design(*PAPER, "--quality", "1")
        self.assertEqual((twice.returncode, twice.stdout), (2, ""))
        self.assertIn("--quality is given more than once", twice.stderr)

    def test_after_two_dashes_q_is_a_file(self):
        ended(4, design(*with_option(PAPER, "--q"), "--", "--q=2"), "--q=2")


class Refusals(unittest.TestCase):
    def refused(self, words, *parts):
        done = design(*words)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)

    def test_a_centre_not_below_half_the_sample_rate(self):
        self.refused(with_option(PAPER, "--sample-rate", "190Hz"), "band 9 (162-180 deg/s)", "95 Hz",
                     "not below half the sample rate, 95 Hz")

    def test_q_of_zero_or_less_or_not_a_number(self):
        self.refused(with_option(PAPER, "--q", "0"), "Q 0 is not above 0")
        self.refused(with_option(PAPER, "--q", "-1"), "Q -1 is not above 0")
        self.refused(with_option(PAPER, "--q", "nan"), "nan")

    def test_bands_that_overlap_run_backward_or_are_empty(self):
        listed = with_option(PAPER, "--speed") + ["--bands"]
        self.refused(listed + ["18:36,30:60"], "band 2 (30-60 deg/s) overlaps band 1 (18-36 deg/s)")
        self.refused(listed + ["36:18"], "must end above its start")
        self.refused(listed + ["18:18"], "must end above its start")
        self.refused(listed + ["18"], "'18' is not FROM:TO")
        self.refused(listed + [""], "cannot read ''")

    def test_a_range_that_is_uneven_empty_or_negative(self):
        self.refused(with_option(PAPER, "--speed", "18:180:20"), "does not divide into whole bands", "18 deg/s gives 9")
        self.refused(with_option(PAPER, "--speed", "180:18:18"), "must end above its start")
        self.refused(with_option(PAPER, "--speed", "18:180:0"), "band width 0 deg/s")
        self.refused(with_option(PAPER, "--speed", "18:180"), "how wide a band is")
        self.refused(with_option(PAPER, "--speed", "18:180:18:5"), "is not FROM:TO:WIDTH")
        self.refused(PAPER + ["--bands", "18:36"], "cannot be combined")

    def test_whatever_is_missing_is_named_with_its_option(self):
        self.refused(with_option(PAPER, "--gear-ratio"), "--gear-ratio")
        self.refused(with_option(PAPER, "--sample-rate"), "--sample-rate")
        self.refused(with_option(PAPER, "--speed"), "--speed FROM:TO:WIDTH")

    def test_orders_and_ratio_that_make_no_sense(self):
        self.refused(with_option(PAPER, "--orders", "0,1"), "--orders: 0 is not above 0")
        self.refused(with_option(PAPER, "--orders", "1,1"), "--orders: 1 is listed twice")
        self.refused(with_option(PAPER, "--gear-ratio", "-100"), "--gear-ratio -100 is not above 0")


class Limits(unittest.TestCase):
    def test_a_limit_that_is_broken_is_exit_code_1_with_the_bands_named_and_the_table_written(self):
        done = ended(1, design(*PAPER, "--max-delay", "100ms", "--min-attenuation", "23dB"))
        self.assertEqual(done.stdout, design(*PAPER).stdout)
        self.assertIn("band 1 (18-36 deg/s) delays by 127.3 ms, more than --max-delay 100ms", done.stderr)
        self.assertIn("band 1 (18-36 deg/s) attenuates order 1 by as little as 18.9 dB", done.stderr)
        self.assertIn("attenuates order 2 by as little as 22.9 dB, less than --min-attenuation 23dB", done.stderr)
        self.assertNotIn("band 2", done.stderr)

    def test_a_limit_that_is_kept_is_exit_code_0(self):
        done = design(*PAPER, "--max-delay", "128ms", "--min-attenuation", "18dB")
        self.assertEqual((done.returncode, done.stderr), (0, ""))


GOAL = with_option(with_option(PAPER, "--q"), "--speed", "18:180")


class Goals(Case):
    """--min-attenuation and --max-delay: what is left open is chosen to hold them."""

    def table(self, *words, stdin=None):
        done = ended(0, design(*words, "--json", stdin=stdin))
        return json.loads(done.stdout)

    def test_every_band_holds_the_attenuation_and_the_delay(self):
        table = self.table(*GOAL, "--min-attenuation", "20dB", "--max-delay", "20ms")
        self.assertEqual((table["bands"][0]["speed_from_deg_s"], table["bands"][-1]["speed_to_deg_s"]), (18, 180))
        for before, band in zip([None, *table["bands"]], table["bands"]):
            self.assertGreaterEqual(min(band["worst_attenuation_db"]), 20)
            self.assertLessEqual(band["dc_delay_ms"], 20)
            if before:
                self.assertEqual(before["speed_to_deg_s"], band["speed_from_deg_s"])
        self.assertEqual(table["designed_for"]["min_attenuation_db"], 20)
        self.assertEqual(table["designed_for"]["max_delay_ms"], 20)

    def test_an_attenuation_alone_says_which_delay_it_took_and_why(self):
        done = design(*GOAL, "--min-attenuation", "20dB")
        self.assertRegex(done.stdout, r"Chosen: the fewest bands that hold 20 dB with notches that settle soonest at 18 deg/s")

    def test_stated_bands_keep_their_edges_and_a_stated_q_its_value(self):
        bands = self.table(*with_option(PAPER, "--q"), "--max-delay", "40ms")["bands"]
        self.assertEqual([b["speed_from_deg_s"] for b in bands], [float(r[1]) for r in TABLE_1])
        self.assertLessEqual(max(b["dc_delay_ms"] for b in bands), 40)
        for band in self.table(*GOAL, "--q", "1", "--min-attenuation", "20dB")["bands"]:
            self.assertEqual([n["q"] for n in band["notches"]], [1, 1])
            self.assertGreaterEqual(min(band["worst_attenuation_db"]), 20)

    def test_the_joints_amplitudes_and_interval_count(self):
        weak = json.loads(joint())
        weak["lines"][1]["amplitude_nm"] = 0.05
        table = self.table("-", "--speed", "18:180", "--min-attenuation", "20dB", "--max-delay", "20ms", stdin=json.dumps(weak))
        self.assertEqual(table["amplitude_nm"], [0.5, 0.05])
        self.assertEqual(table["gear_ratio_error_percent"], 0.2)
        for band in table["bands"]:
            self.assertGreaterEqual(band["held_attenuation_db"], 20)
            for left, amplitude, db in zip(band["predicted_residual_nm"], (0.5, 0.05), band["worst_attenuation_db"]):
                self.assertAlmostEqual(left, amplitude * 10 ** (-db / 20), places=9)

    def test_a_designed_table_is_one_that_filter_takes(self):
        design(*GOAL, "--min-attenuation", "20dB", "--max-delay", "20ms", "-o", "table.json", cwd=self.folder)
        done = self.run_tool("filter", DATA / "paper_move_2s.csv", "--method", "switching,table=table.json", "-o", "out.csv")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_same_goal_gives_the_same_bytes(self):
        words = (*GOAL, "--min-attenuation", "26dB", "--max-delay", "30ms", "--json")
        self.assertEqual(design(*words).stdout, design(*words).stdout)

    def test_what_cannot_be_held_is_exit_code_1_names_the_limit_and_writes_nothing(self):
        for words, parts in (
                (["--max-delay", "5ms"], ["--max-delay 5 ms cannot be met at 18 deg/s", "only from 34.36 deg/s on"]),
                (["--min-attenuation", "40dB", "--depth", "30dB"], ["--depth 30 dB"])):
            done = design(*GOAL, *words)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done.stderr)
            for part in parts:
                self.assertIn(part, done.stderr)

    def test_what_leaves_nothing_to_choose_or_makes_no_sense_is_exit_code_2(self):
        for words, part in (
                ([*with_option(GOAL, "--speed", "0:180"), "--max-delay", "20ms"], "standstill"),
                ([*GOAL, "--max-delay", "20ms", "--amplitudes", "0.5"], "1 ripple amplitudes for 2 orders")):
            done = design(*words)
            self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
            self.assertIn(part, done.stderr)


class Warnings(unittest.TestCase):
    def test_a_band_that_reaches_beyond_half_the_sample_rate_is_warned_of(self):
        ended(0, design(*with_option(PAPER, "--sample-rate", "191Hz")),
              "warning: band 9 (162-180 deg/s): order 2 passes half the sample rate at 171.9 deg/s")


class Hysteresis(unittest.TestCase):
    def table(self, *words, stdin=None):
        done = ended(0, design(*words, "--json", stdin=stdin))
        return json.loads(done.stdout)

    def test_a_band_is_rated_as_far_as_it_stays_in_force(self):
        words = ("--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--q", "0.25")
        table = self.table(*words, "--bands", "20:30,30:40", "--hysteresis", "2deg/s")
        self.assertEqual(table["hysteresis_deg_s"], 2)
        # The least attenuation is that of bands which reach as far, about the same centres.
        centre = table["bands"][0]["notches"][0]["center_hz"]
        wide = self.table(*words, "--bands", "18:32,32:38")
        self.assertAlmostEqual(wide["bands"][0]["notches"][0]["center_hz"], centre, places=9)
        for ours, theirs in zip(table["bands"][0]["worst_attenuation_db"], wide["bands"][0]["worst_attenuation_db"]):
            self.assertAlmostEqual(ours, theirs, places=6)
        self.assertNotIn("hysteresis_deg_s", self.table(*words, "--bands", "20:30,30:40"))

    def test_three_deviations_of_the_speeds_noise_unless_it_is_stated(self):
        noisy = json.loads(joint())
        noisy["velocity_noise_deg_s"] = 0.4
        text = json.dumps(noisy)
        self.assertEqual(self.table("-", "--speed", "18:90:18", stdin=text)["hysteresis_deg_s"], 1.2)
        self.assertEqual(self.table("-", "--speed", "18:90:18", "--hysteresis", "0.3deg/s", stdin=text)["hysteresis_deg_s"], 0.3)
        self.assertNotIn("hysteresis_deg_s", self.table("-", "--speed", "18:90:18", "--hysteresis", "0", stdin=text))

    def test_a_goal_holds_over_the_hysteresis_too(self):
        table = self.table("--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "20:120", "--min-attenuation",
                           "20dB", "--max-delay", "60ms", "--hysteresis", "1deg/s")
        for band in table["bands"]:
            self.assertGreaterEqual(min(band["worst_attenuation_db"]), 20)
