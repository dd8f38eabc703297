# SPDX-License-Identifier: MIT
"""The pictures of the documentation show what the tool shows today: compared by their data, not by their pixels."""

import csv
import importlib.machinery
import importlib.util
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import unittest

from commands import SOURCE, TOOL, ended, run, Case

FIGURES = SOURCE / "docs" / "figures"


def alike(kept, made, path=""):
    """Where two documents differ, or None. Numbers may differ in their last digits: another compiler, another cosine."""
    if isinstance(kept, dict) and isinstance(made, dict):
        if kept.keys() != made.keys():
            return f"{path}: fields {sorted(kept)} and {sorted(made)}"
        return next(filter(None, (alike(kept[k], made[k], f"{path}.{k}") for k in kept)), None)
    if isinstance(kept, list) and isinstance(made, list):
        if len(kept) != len(made):
            return f"{path}: {len(kept)} and {len(made)} entries"
        return next(filter(None, (alike(a, b, f"{path}[{i}]") for i, (a, b) in enumerate(zip(kept, made)))), None)
    number = (int, float)
    if isinstance(kept, number) and isinstance(made, number) and not isinstance(kept, bool):
        return None if math.isclose(kept, made, rel_tol=1e-5, abs_tol=1e-6) else f"{path}: {kept} and {made}"
    return None if kept == made else f"{path}: {kept!r} and {made!r}"


class Figures(Case):
    def test_every_picture_shows_what_its_command_shows_today(self):
        ended(0, subprocess.run([SOURCE / "scripts" / "make-figures", self.folder], capture_output=True, timeout=120,
                                env=dict(os.environ, ONLY_DATA="1")))
        made = {path.name: json.loads(path.read_text()) for path in self.folder.glob("*.json")}
        kept = {path.name: json.loads(path.read_text()) for path in FIGURES.glob("*.json")}
        self.assertEqual(sorted(kept), sorted(made))
        for name in kept:
            kept[name].pop("version"), made[name].pop("version")
            self.assertIsNone(alike(kept[name], made[name], name), "run scripts/make-figures and look at the pictures")

    def test_every_picture_on_a_page_is_there_with_its_data(self):
        for page in (FIGURES / "README.md", SOURCE / "README.md"):
            names = re.findall(r"!\[[^]]+\]\(([^)]+\.png)\)", page.read_text())
            self.assertTrue(names, page)
            for name in names:
                picture = page.parent / name
                self.assertTrue(picture.with_suffix(".json").is_file(), name)
                self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n", name)

    def test_every_listed_figure_is_on_the_page_and_in_its_command_s_help(self):
        listed = re.findall(r'^FIGURE\("([\w-]+)", "(\w+)"\)', (SOURCE / "src" / "figure" / "figures.def").read_text(), re.M)
        shown = re.findall(r"!\[[^]]+\]\(([^)]+)\.png\)", (FIGURES / "README.md").read_text())
        names = [json.loads((FIGURES / f"{name}.json").read_text())["name"] for name in shown]
        for name, command in listed:
            self.assertIn(name, names, f"docs/figures/README.md has no picture of figure {name}")
            help_text = run(command, "--help-all").stdout
            self.assertRegex(help_text, rf"as a picture \([^)]*\b{name}\b", command)
        self.assertEqual(set(names), {name for name, _ in listed}, "src/figure/figures.def")

    def test_pictures_are_small(self):
        for path in FIGURES.glob("*.png"):
            self.assertLess(path.stat().st_size, 300_000, path.name)


# docs/paper.md: made again by scripts/reproduce-paper and compared, and what the figures must show.
SCRIPT = SOURCE / "scripts" / "reproduce-paper"
PAPER = SOURCE / "docs" / "paper"


def rows(name):
    with open(PAPER / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def script():
    loader = importlib.machinery.SourceFileLoader("reproduce_paper", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("reproduce_paper", loader))
    loader.exec_module(module)
    return module


class Page(unittest.TestCase):
    def test_every_table_and_every_plot_file_is_what_the_tool_makes(self):
        ended(0, subprocess.run([sys.executable, "-B", SCRIPT, "--check"], capture_output=True, text=True, timeout=300))

    def test_every_plot_file_is_named_by_the_page_and_there_is_no_other(self):
        page = (SOURCE / "docs" / "paper.md").read_text(encoding="utf-8")
        for path in PAPER.iterdir():
            self.assertIn(f"(paper/{path.name})", page)

    def test_a_number_may_differ_by_two_units_of_its_last_digit_and_a_word_not_at_all(self):
        same = script().same
        self.assertTrue(same("a 0.123 b", "a 0.125 b"))
        self.assertFalse(same("a 0.123 b", "a 0.126 b"))
        self.assertFalse(same("a 0.123 b", "a 0.12 b"))
        self.assertFalse(same("a 0.123 b", "a 0.123 c"))
        self.assertFalse(same("1\n2\n", "1\n"))


class PaperFigures(unittest.TestCase):
    def test_lines_lie_where_the_paper_read_them_off_its_plots(self):
        for row in rows("figure2.csv"):
            if row["speed_deg_s"] == "0":
                self.assertEqual(row["measured_hz"], "")
            else:
                self.assertAlmostEqual(float(row["measured_hz"]), float(row["predicted_hz"]), delta=0.002)

    def test_only_a_low_pass_at_13_radians_a_second_lags_78_and_settles_in_400_milliseconds(self):
        fits = [row["method"] for row in rows("low_passes.csv")
                if abs(float(row["ramp_delay_ms"]) - 78.0) < 2.0 and abs(float(row["settle_ms"]) - 400.0) < 20.0]
        self.assertEqual(fits, ["lowpass,cutoff=13rad/s,order=1"])

    def test_no_polynomial_has_both_peaks_of_the_paper(self):
        for row in rows("polynomial.csv"):
            self.assertFalse(abs(float(row["greatest_speed_deg_s"]) - 171.0) < 1.0
                             and abs(float(row["greatest_acceleration_deg_s2"]) - 260.0) < 2.0)


class Move(unittest.TestCase):
    def setUp(self):
        self.errors = {row.pop("method"): {key: float(value) for key, value in row.items()}
                       for row in rows("move_errors.csv")}

    def at_90_degrees(self, method):
        row = self.errors[method]
        return max(row["error_phases_90_position_nm"], row["error_phases_90_velocity_nm"])

    def test_limits_that_are_promised_hold_on_the_move(self):
        self.assertAlmostEqual(self.at_90_degrees("raw"), 0.65, delta=0.01)
        self.assertAlmostEqual(self.at_90_degrees("Table 1, parallel"), 0.57, delta=0.02)
        self.assertLessEqual(self.at_90_degrees("oscillator, cold"), 0.20)
        for phases in ("90", "0"):
            for angle in ("position", "velocity"):
                for start in ("oscillator, warm",
                              "oscillator, warm from identify at 60, 120, 180 deg/s"):
                    self.assertLessEqual(self.errors[start][f"error_phases_{phases}_{angle}_nm"], 0.05)
        self.assertLessEqual(abs(self.errors["oscillator, warm"]["delay_ms"]), 1.0)

    def test_told_that_the_arm_rests_unloaded_the_cold_oscillator_stays_below_a_fifth_at_any_phase(self):
        for row in rows("cold_phases.csv"):
            self.assertLessEqual(float(row["cold_rest_nm"]), 0.20)
            self.assertLessEqual(float(row["cold_after_400_ms_nm"]), 0.02)

    def test_through_zero_every_causal_notch_leaves_a_newton_metre_and_what_knows_the_angle_does_not(self):
        for row in rows("reversal.csv"):
            left = float(row["reversal_nm"])
            if row["method"].startswith("oscillator"):
                self.assertLess(left, 0.15)
            else:
                self.assertGreater(left, 1.0)

    def test_hysteresis_gives_back_the_switches_that_a_noisy_speed_adds(self):
        for row in rows("transitions.csv"):
            if row["speed_noise"] == "none" or row["guard"] in ("hysteresis=2deg/s", "dwell=0.1s"):
                self.assertEqual(row["switches"], "16")
            elif not row["guard"]:
                self.assertGreater(int(row["switches"]), 100)


# docs/certificate.md is what scripts/certify measures today, and it quotes README.
PYTHONS = [python for python in (sys.executable, "/usr/bin/python3")
           if pathlib.Path(python).exists() and not subprocess.run([python, "-c", "import scipy"], capture_output=True).returncode]


class Certificate(unittest.TestCase):
    @unittest.skipUnless(PYTHONS, "no SciPy")
    def test_the_page_is_not_stale(self):
        """Rows whose oracle is not there are skipped; certify names them."""
        done = subprocess.run([PYTHONS[0], SOURCE / "scripts/certify", "--check"], env={"RIPPLENOTCH": TOOL, "PATH": "/usr/bin:/bin"},
                              capture_output=True, text=True)
        print(*(line for line in done.stderr.splitlines() if "SKIPPED" in line), sep="\n")
        self.assertEqual(done.returncode, 0, done.stderr)
