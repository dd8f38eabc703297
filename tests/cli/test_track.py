# SPDX-License-Identifier: MIT
"""ripplenotch spectrum --track as users meet it: columns, speed, refusals."""

import csv
import io
import json
import pathlib
import unittest

from commands import DATA, LOGS, Case, ended, run

MOVE = str(DATA / "paper_move_2s.csv")
ORDERS = ["--orders", "1,2", "--gear-ratio", "100"]


def rows_of(text):
    table = list(csv.reader(io.StringIO(text)))
    return table[0], [[float(cell) for cell in row] for row in table[1:]]


class Track(Case):
    def track(self, *words, **more):
        done = ended(0, run("spectrum", "--track", *words, **more))
        return rows_of(done.stdout)


class Columns(Track):
    def test_the_amplitudes_are_those_that_the_move_was_made_with(self):
        header, rows = self.track(MOVE, *ORDERS)
        self.assertEqual(header, ["time_s", "speed_deg_s",
                                  "order_1_amplitude_nm", "order_1_phase_deg", "order_1_standard_error_nm",
                                  "order_2_amplitude_nm", "order_2_phase_deg", "order_2_standard_error_nm"])
        self.assertGreater(len(rows), 15)
        for row in rows:
            for column, truth in (2, 0.8), (5, 0.5):
                # 4 standard errors of up to 0.007 Nm
                self.assertAlmostEqual(row[column], truth, delta=0.028, msg=f"{row}")
                self.assertAlmostEqual(row[column + 1], 0.0, delta=4.0)

    def test_against_speed_has_one_row_a_range_slowest_first(self):
        header, rows = self.track(MOVE, *ORDERS, "--against", "speed")
        self.assertEqual(header[:5], ["speed_deg_s", "rows", "order_1_amplitude_nm", "order_1_phase_deg",
                                      "order_1_spread_nm"])
        self.assertEqual(rows, sorted(rows))
        _, one = self.track(str(DATA / "paper_90deg_s.csv"), *ORDERS, "--against", "speed")
        self.assertEqual(len(one), 1)
        self.assertAlmostEqual(one[0][0], 90.0, places=6)

    def test_output_orders_are_motor_orders_times_the_ratio(self):
        _, motor = self.track(MOVE, *ORDERS, "--window-turns", "8")
        header, output = self.track(MOVE, "--output-orders", "100,200", "--window-turns", "0.08")
        self.assertEqual(header[2], "order_output_100_amplitude_nm")
        self.assertEqual(len(motor), len(output))
        for a, b in zip(motor, output):
            for x, y in zip(a, b):
                self.assertAlmostEqual(x, y, delta=2e-4 * max(1.0, abs(x)))

    def test_beside_other_lines_there_are_no_orders_by_default(self):
        words = (MOVE, "--output-orders", "100,200")
        alone, _ = self.track(*words, "--window-turns", "0.08")
        with_ratio, _ = self.track(*words, "--gear-ratio", "100", "--window-turns", "8")
        self.assertEqual(with_ratio, alone)
        self.assertNotIn("order_1_amplitude_nm", alone)

    def test_a_tone_beside_the_orders_changes_neither(self):
        header, rows = self.track(MOVE, *ORDERS, "--tones", "120Hz")
        self.assertEqual(header[8], "tone_120hz_amplitude_nm")
        for row in rows:
            self.assertAlmostEqual(row[2], 0.8, delta=0.03)
            self.assertLess(row[8], 0.03)

    def test_the_same_bytes_twice_from_a_file_and_from_a_pipe_and_as_npy(self):
        first = run("spectrum", "--track", MOVE, *ORDERS).stdout
        self.assertEqual(first, run("spectrum", "--track", "-", *ORDERS, stdin=pathlib.Path(MOVE).read_text()).stdout)
        path = self.folder / "track.npy"
        done = run("spectrum", "--track", MOVE, *ORDERS, "-o", str(path))
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        self.assertEqual(path.read_bytes()[:6], b"\x93NUMPY")

    def test_without_position_amplitudes_stand_and_a_warning_says_what_phases_mean(self):
        lines = pathlib.Path(MOVE).read_text().splitlines()
        text = "\n".join(line.rsplit(",", 1)[0] for line in lines) + "\n"
        done = ended(0, run("spectrum", "--track", "-", *ORDERS, stdin=text), "count from the first sample")
        for row in rows_of(done.stdout)[1]:
            self.assertAlmostEqual(row[2], 0.8, delta=0.03)


class Json(Case):
    def test_the_verdict_and_the_columns_agree(self):
        done = ended(0, run("spectrum", "--track", MOVE, *ORDERS, "--json"))
        result = json.loads(done.stdout)
        self.assertEqual(result["schema"], "ripplenotch/track/1")
        self.assertIn("order 1: 0.8 +/- 0.002 Nm zero to peak", result["verdict"])
        ripple = result["lines"][0]["ripple"]
        self.assertTrue(ripple["present"])
        self.assertLess(abs(result["lines"][0]["median_nm"] - ripple["amplitude_nm"]), 3 * ripple["standard_error_nm"])
        measured = [x for x in result["columns"]["order_1_amplitude_nm"] if x is not None]
        self.assertEqual(result["lines"][0]["rows_measured"], len(measured))
        self.assertAlmostEqual(result["lines"][0]["greatest_nm"], max(measured), delta=1e-5)

    def test_a_joint_file_says_ratio_and_orders(self):
        joint = ended(0, run("identify", str(DATA / "paper_60deg_s.csv"), str(DATA / "paper_120deg_s.csv"), "--json"))
        path = self.folder / "joint.json"
        path.write_text(joint.stdout)
        done = ended(0, run("spectrum", "--track", MOVE, "--joint-file", str(path), "--json"))
        self.assertEqual([line["order"] for line in json.loads(done.stdout)["lines"]], [1.0, 2.0])


class RealLogs(unittest.TestCase):
    def test_the_panda_s_second_order_is_its_strongest(self):
        # An order spectrum of the whole log, made independently, shows 0.17, 0.41 and 0.24 Nm for orders 1, 2, 4.
        log = LOGS / "gpl3" / "panda_gaz_j4.csv"
        if not log.is_file():
            self.skipTest(f"{log} is not there")
        done = ended(0, run("spectrum", "--track", str(log), "--orders", "1,2,4", "--gear-ratio", "120", "--json"))
        first, second, fourth = (line["median_nm"] for line in json.loads(done.stdout)["lines"])
        self.assertTrue(0.08 < first < 0.25 and 0.2 < second < 0.5 and 0.1 < fourth < 0.4, f"{first} {second} {fourth}")
        self.assertGreater(second, 1.5 * first)


class Refusals(unittest.TestCase):
    def refused(self, code, words, *parts):
        done = ended(code, run("spectrum", "--track", *words))
        self.assertEqual(done.stdout, "")
        for part in parts:
            self.assertIn(part, done.stderr)

    def test_requests_that_make_no_sense_name_the_remedy(self):
        self.refused(2, [MOVE], "nothing to track")
        self.refused(2, [MOVE, "--orders", "1"], "--gear-ratio")
        self.refused(2, [MOVE, "--orders", "0", "--gear-ratio", "100"], "above 0")
        self.refused(2, [MOVE, "--orders", "1,1", "--gear-ratio", "100"], "listed twice")
        self.refused(2, [MOVE, "--orders", "1", "--gear-ratio", "-3"], "--gear-ratio -3 is not above 0")
        self.refused(2, [MOVE, "--tones", "50Hz"], "--window")

    def test_its_options_and_those_of_the_spectra_are_kept_apart(self):
        self.refused(2, [MOVE, *ORDERS, "--bins"], "--track goes with neither")
        self.refused(2, [MOVE, *ORDERS, "--speed-step", "40deg/s"], "--against speed")
        for words in ["--tones", "50Hz"], ["--against", "speed"], ["--window", "1s"]:
            done = run("spectrum", MOVE, *words)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("belong to --track", done.stderr)

    def test_a_log_at_rest_has_nothing_to_track(self):
        self.refused(3, [str(DATA / "paper_rest.csv"), *ORDERS], "no row could be measured")
