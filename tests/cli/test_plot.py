# SPDX-License-Identifier: MIT
"""--plot as users meet it: pictures, the terminal, figures as data, and what happens without gnuplot."""

import json
import os
import shutil
import time
import unittest
import xml.dom.minidom

from commands import DATA, Case, ended, run

LOG = str(DATA / "paper_90deg_s.csv")
MOVE = str(DATA / "paper_move_2s.csv")
TABLE = ["--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "18:180:18"]
SIGNALS = ["--step", "10Nm", "--ramp", "20Nm/s", "--speed", "90deg/s", "--sample-rate", "1kHz", "--gear-ratio", "100",
           "--orders", "1,2"]
HOSTILE = "<script>alert(1)</script> \"q\" 'x' `touch pwned` $(touch pwned) @m _a^b{c} ]]> é \x1b[2J.csv"

needs_gnuplot = unittest.skipUnless(shutil.which("gnuplot"), "SKIPPED: there is no gnuplot here")


COMMANDS = {
    "spectrum": ["spectrum", LOG],
    "order-spectrum": ["spectrum", MOVE, "--domain", "order"],
    "campbell": ["spectrum", MOVE, "--map", "campbell", "--gear-ratio", "100"],
    "order-map": ["spectrum", MOVE, "--map", "order", "--gear-ratio", "100", "--highest", "6"],
    "line-frequency": ["identify", *(str(DATA / f"paper_{v}deg_s.csv") for v in (60, 90, 120, 180))],
    "motor-matrix": ["identify", str(DATA / "arm/three_joints.csv")],
    "track": ["spectrum", MOVE, "--track", "--orders", "1,2", "--gear-ratio", "100"],
    "ripple-map": ["map", MOVE, "--orders", "1,2", "--gear-ratio", "100"],
    "candidate-table": ["design", *TABLE],
    "torque": ["filter", LOG, "--method", "lowpass,cutoff=13rad/s,order=1"],
    "comparison": ["compare", *SIGNALS, "--method", "fixed,centers=25Hz:50Hz,q=0.25", "--method",
                   "lowpass,cutoff=13rad/s,order=1"],
}


class Plots(Case):
    def plot(self, words, name, **environment):
        return run(*words, "-o", self.folder / "result", "--plot", self.folder / name, "--force", cwd=self.folder,
                   environment=environment)

    def test_every_figure_is_data_with_labels_and_units(self):
        for name, words in COMMANDS.items():
            ended(0, self.plot(words, "figure.json"))
            figure = json.loads((self.folder / "figure.json").read_text())
            self.assertEqual((figure["schema"], figure["name"]), ("ripplenotch/figure/1", name))
            for panel in figure["panels"]:
                self.assertTrue(panel["x"]["label"] and panel["y"]["label"], name)
                self.assertLess(panel["x"]["from"], panel["x"]["to"])
                for curve in panel["curves"]:
                    self.assertEqual(len(curve["x"]), len(curve["y"]))

    def test_a_diagnosis_shows_the_gap_fall_and_the_residual_before_and_after(self):
        (self.folder / "model.json").write_text(json.dumps(
            {"schema": "ripplenotch/model/1", "gear_ratio": 100,
             "effects": [{"effect": "inertia"}, {"effect": "ripple", "order": 1}]}))
        done = ended(0, run("diagnose", MOVE, "--model", "model.json", "--plot", "d.json", "--json", cwd=self.folder))
        diagnosis, figure = json.loads(done.stdout), json.loads((self.folder / "d.json").read_text())
        self.assertEqual(figure["name"], "diagnosis")
        gap, residual, before, after = figure["panels"]
        self.assertEqual(len(gap["curves"][0]["y"]), 1 + len(diagnosis["rounds"]))
        self.assertAlmostEqual(gap["curves"][0]["y"][0], diagnosis["gap"]["before_nm"], places=6)
        self.assertIn(diagnosis["rounds"][0]["effect"], gap["lines"][0]["name"])
        highest = [max(filter(None, panel["map"]["cells"])) for panel in (before, after)]
        self.assertGreater(highest[0], 2.0 * highest[1])
        self.assertEqual(before["map"]["highest"], after["map"]["highest"])
        self.assertEqual([curve["name"] for curve in residual["curves"]], ["before", "after"])
        refused = run("diagnose", MOVE, "--model", "model.json", "--plot", "-", "--json", cwd=self.folder)
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))

    @needs_gnuplot
    def test_every_figure_is_drawn_in_every_form(self):
        for name, words in COMMANDS.items():
            forms = (("svg", b"<?xml"), ("png", b"\x89PNG"), ("pdf", b"%PDF"))
            for form, magic in forms if name in ("campbell", "torque") else forms[:1]:
                done = self.plot(words, f"{name}.{form}")
                self.assertEqual((done.returncode, done.stderr), (0, ""), name)
                self.assertTrue((self.folder / f"{name}.{form}").read_bytes().startswith(magic))
            figure = json.loads((self.plot(words, "figure.json"), (self.folder / "figure.json").read_text())[1])
            text = xml.dom.minidom.parse(str(self.folder / f"{name}.svg")).documentElement
            written = " ".join(node.firstChild.data for node in text.getElementsByTagName("text")
                               if node.firstChild)
            for panel in figure["panels"]:
                for axis in ("x", "y"):
                    self.assertIn(panel[axis]["label"], written, name)
                for line in panel["lines"]:
                    self.assertIn(line["name"][:30], written, name)

    @needs_gnuplot
    def test_the_same_input_gives_the_same_bytes(self):
        for form in ("svg", "png", "pdf", "json"):
            self.plot(COMMANDS["campbell"], f"a.{form}")
            if form == "pdf":
                time.sleep(1.1)  # a clock in it would be another one
            self.plot(COMMANDS["campbell"], f"b.{form}", LC_ALL="de_DE.UTF-8", TZ="Asia/Tokyo", GNUTERM="dumb")
            self.assertEqual((self.folder / f"a.{form}").read_bytes(), (self.folder / f"b.{form}").read_bytes(), form)

    @needs_gnuplot
    def test_the_terminal_gets_eighty_columns_of_text(self):
        for name, words in COMMANDS.items():
            done = ended(0, run(*words, "--plot", "-"))
            text = done.stdout
            self.assertNotIn("\x1b", text)
            if name in ("spectrum", "campbell", "torque"):
                self.assertLessEqual(max(map(len, text.splitlines())), 80, name)
        drawn = run(*COMMANDS["spectrum"], "--plot", "-").stdout
        for part in ("amplitude, zero to peak, Nm", "frequency, Hz", "A 25 Hz, 0.8 Nm", "B 50 Hz, 0.5", "noise floor"):
            self.assertIn(part, drawn)

    @needs_gnuplot
    def test_hostile_names_show_as_text_and_run_nothing(self):
        os.symlink(LOG, self.folder / "log.csv")
        hostile = HOSTILE.replace("/", "∕")
        os.symlink(LOG, self.folder / hostile)
        ended(0, run("spectrum", hostile, "-o", "out.csv", "--plot", "page.svg", cwd=self.folder))
        svg = (self.folder / "page.svg").read_bytes()
        self.assertNotIn(b"<script", svg)
        self.assertNotIn(b"\x1b", svg)
        page = xml.dom.minidom.parseString(svg).documentElement
        written = " ".join(node.firstChild.data for node in page.getElementsByTagName("text") if node.firstChild)
        self.assertIn("<script>alert(1)<∕script> \"q\" 'x' `touch pwned` $(touch pwned) @m _a^b{c} ]]> é \\x1b[2J",
                      written)
        drawn = run("spectrum", hostile, "--plot", "-", cwd=self.folder)
        self.assertIn("`touch pwned`", drawn.stdout)
        self.assertNotIn("\x1b", drawn.stdout)
        self.assertFalse((self.folder / "pwned").exists())

    def test_a_picture_s_name_is_never_run(self):
        name = "a`touch pwned`;$(touch pwned)'\".svg"
        done = run(*COMMANDS["candidate-table"], "-o", "out", "--plot", name, cwd=self.folder)
        if shutil.which("gnuplot"):
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((self.folder / name).is_file())
        self.assertFalse((self.folder / "pwned").exists())
