# SPDX-License-Identifier: MIT
"""ripplenotch spectrum --response as users meet it: a frequency response with coherence, against SciPy and known filters."""

import csv
import json
import random

from commands import DATA, SOURCE, Case

REFERENCE = SOURCE / "tests" / "cli" / "data"
LOG = REFERENCE / "response_log.csv"


def table(path):
    with open(path) as file:
        return list(csv.DictReader(file))


class Responses(Case):
    def response(self, log, *words):
        return json.loads(self.good("spectrum", log, "--response", *words, "--json").stdout)

    def noise_log(self, rows=20000, seed=1, **columns):
        """torque_nm is noise; each further column is made of it by its function, which gets the noise so far."""
        dice = random.Random(seed)
        values = [dice.gauss(0, 1) for _ in range(rows)]
        more = {name: make(values, dice) for name, make in columns.items()}
        lines = [",".join(["time_s", "velocity_deg_s", "torque_nm", *more])]
        lines += [f"{k / 1000:.3f},90,{value:.6f}" + "".join(f",{column[k]:.6f}" for column in more.values())
                  for k, value in enumerate(values)]
        path = self.folder / "noise.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    def test_gain_phase_and_coherence_are_those_of_scipy(self):
        """scripts/make_response_reference.py made them."""
        expected = table(REFERENCE / "response_scipy.csv")
        for estimator in ("h1", "h2"):
            self.good("spectrum", LOG, "--response", "other/torque", "--segment", "0.2s", "--estimator", estimator,
                      "-o", "response.csv", "--force")
            measured = table(self.folder / "response.csv")
            self.assertEqual(len(measured), len(expected))
            compared = 0
            for mine, theirs in zip(measured, expected):
                self.assertAlmostEqual(float(mine["frequency_hz"]), float(theirs["frequency_hz"]), delta=1e-4)
                self.assertAlmostEqual(float(mine["coherence"]), float(theirs["coherence"]), delta=1e-5)
                if mine["gain_db"]:
                    compared += 1
                    self.assertAlmostEqual(float(mine["gain_db"]), float(theirs[f"{estimator}_db"]), delta=1e-3)
                    self.assertAlmostEqual(float(mine["phase_deg"]), float(theirs["phase_deg"]), delta=1e-3)
            self.assertGreater(compared, 20)

    def test_the_filter_of_a_log_is_measured_and_predicted(self):
        log = self.noise_log()
        method = "fixed,centers=50Hz:100Hz,q=1"
        self.good("filter", log, "--append", "--method", method, "-o", "filtered.csv")
        words = ["torque_filtered_nm/torque_nm", "--method", method, "--segment", "1s"]
        result = self.response("filtered.csv", *words)
        self.assertEqual(result["schema"], "ripplenotch/response/1")
        self.assertEqual(result["gain_unit"], "")
        self.assertEqual(result["predicted"]["method"], method)
        self.assertEqual(result["segments"], 39)
        columns = result["columns"]
        at = {hz: k for k, hz in enumerate(columns["frequency_hz"])}
        for hz, largest_db, largest_deg in ((20, 0.1, 1), (70, 0.2, 2), (200, 0.1, 1), (400, 0.05, 0.5)):
            self.assertAlmostEqual(columns["gain_db"][at[hz]], columns["predicted_db"][at[hz]], delta=largest_db)
            self.assertAlmostEqual(columns["phase_deg"][at[hz]], columns["predicted_deg"][at[hz]], delta=largest_deg)
        text = self.good("spectrum", "filtered.csv", "--response", *words).stdout
        self.assertEqual(text.splitlines()[0], result["verdict"])
        self.assertIn("predicts the response within", text)

    def test_the_speed_of_a_method_that_follows_the_joint_is_the_median_of_the_log(self):
        log = self.noise_log()
        method = ["--method", "tracking", "--gear-ratio", "100", "--orders", "2"]
        self.good("filter", log, "--append", *method, "-o", "filtered.csv")
        result = self.response("filtered.csv", "torque_filtered_nm/torque_nm", *method, "--segment", "2s")
        self.assertIn("at the median speed of 90 deg/s", result["predicted"]["filter"])
        self.assertLess(result["predicted"]["largest_deg"], 15)
        refused = self.run_tool("spectrum", "filtered.csv", "--response", "torque_filtered_nm/torque_nm", "--method",
                                "tracking,orders=2")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--gear-ratio", refused.stderr)

    def test_independent_signals_have_no_response(self):
        log = self.noise_log(seed=5, other=lambda values, dice: [dice.gauss(0, 1) for _ in values])
        result = self.response(log, "other/torque")
        self.assertEqual((result["ranges"], result["determined_bins"]), ([], 0))
        self.assertIn("gain not known", result["verdict"])
        self.assertEqual({row["determined"] for row in result["third_octaves"]}, {False})
        self.assertEqual({row["gain_db"] for row in result["third_octaves"]}, {None})
        below = sum(c <= result["coherence_limit"] for c in result["columns"]["coherence"])
        self.assertAlmostEqual(below / len(result["columns"]["coherence"]), 0.95, delta=0.03)

    def test_what_is_known_ends_where_the_noise_of_the_output_is_larger(self):
        def slow(values, dice):
            out, states = [], [0.0] * 4
            for value in values:
                for i in range(4):
                    value = states[i] = states[i] + 0.2 * (value - states[i])
                out.append(value + 0.02 * dice.gauss(0, 1))
            return out
        result = self.response(self.noise_log(out=slow), "out/torque_nm")
        self.assertLess(result["ranges"][0]["from_hz"], 3)
        self.assertLess(100, result["ranges"][-1]["to_hz"])
        self.assertLess(result["ranges"][-1]["to_hz"], 350)
        for row in result["third_octaves"]:
            if row["determined"]:
                self.assertLess(row["gain_low_db"], row["gain_db"])
                self.assertLess(row["gain_db"], row["gain_high_db"])

    def test_resolution_and_segment_are_two_ways_to_say_the_same(self):
        a = self.response(LOG, "other/torque", "--resolution", "7.5")
        b = self.response(LOG, "other/torque", "--segment", "0.2s")
        self.assertEqual(a["columns"], b["columns"])
        self.assertEqual(a["resolution_hz"], 7.5)

    def test_the_figure_has_gain_phase_and_coherence(self):
        self.good("spectrum", LOG, "--response", "other/torque", "--plot", "bode.json")
        figure = json.loads((self.folder / "bode.json").read_text())
        self.assertEqual(figure["name"], "response")
        self.assertEqual([panel["y"]["label"] for panel in figure["panels"]], ["gain", "phase", "coherence"])
        self.assertTrue(figure["panels"][0]["ribbons"])

    def test_the_page_answers_with_the_verdict(self):
        result = self.good("spectrum", LOG, "--response", "other/torque", "-o", "response.json")
        self.assertEqual(result.stdout, "")
        self.good("report", "response.json", "-o", "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertIn(json.loads((self.folder / "response.json").read_text())["verdict"], page)
        self.assertIn("Frequency response", page)

    def test_a_column_is_not_read_again_from_a_pipe(self):
        text = LOG.read_text()
        self.assertEqual(self.run_tool("spectrum", "-", "--response", "other/torque", stdin=text).returncode, 2)
        whole = self.good("spectrum", "-", "--response", "torque/torque", stdin=text).stdout
        self.assertIn("torque/torque: gain known", whole)

    def test_what_names_no_two_signals_is_refused_with_those_that_are_there(self):
        for text in ("torque", "none/torque", "torque/none", "/torque", "a/b/c"):
            done = self.run_tool("spectrum", LOG, "--response", text)
            self.assertEqual(done.returncode, 2, text)
            self.assertIn(f"read '{text}', expected OUT/IN", done.stderr)
            self.assertIn("time_s, velocity_deg_s, torque_nm, other", done.stderr)

    def test_options_that_do_not_go_together_are_refused(self):
        for words in (("--domain", "order"), ("--stretch", "all"), ("--peaks",), ("--map", "campbell"),
                      ("--segment", "1s", "--resolution", "1"), ("--gear-ratio", "100"), ("--highest", "10"),
                      ("--method", "switching,gear=1"), ("--method", "none,")):
            done = self.run_tool("spectrum", LOG, "--response", "other/torque", *words)
            self.assertEqual(done.returncode, 2, words)
        for words in (("--estimator", "h2"), ("--method", "none")):
            self.assertEqual(self.run_tool("spectrum", LOG, *words).returncode, 2, words)

    def test_a_log_without_torque_has_responses_of_its_columns(self):
        path = self.folder / "two.csv"
        dice = random.Random(3)
        values = [dice.gauss(0, 1) for _ in range(4000)]
        path.write_text("time_s,u,y\n" + "".join(f"{k / 1000:.3f},{v:.5f},{-2 * v:.5f}\n" for k, v in enumerate(values)))
        result = self.response(path, "y/u")
        self.assertAlmostEqual(result["columns"]["gain_db"][20], 6.0206, delta=1e-3)

    def test_too_few_segments_say_what_helps(self):
        done = self.run_tool("spectrum", LOG, "--response", "other/torque", "--segment", "1s")
        self.assertEqual(done.returncode, 3)
        self.assertIn("shorter --segment", done.stderr)
