# SPDX-License-Identifier: MIT
"""info as users meet it: the JSON fields, several joints, a wrong clock, logs that lack something, real robots' logs."""

import json
import math
import subprocess
import unittest

from commands import LOGS, SOURCE, TOOL, Case, ended, good, run


def info(*words, stdin=None):
    return json.loads(good("info", "--json", *words, stdin=stdin).stdout)


def swing(clock=1.0, rows=4000, torque=True):
    """A joint that swings by 100 deg, sampled at 500 Hz, its clock stretched by a factor."""
    lines = ["time_s,velocity_deg_s,position_deg" + (",torque_nm" if torque else "")]
    for k in range(rows):
        t = k / 500
        cells = [t * clock, 90 * math.cos(0.9 * t), 100 * math.sin(0.9 * t)]
        if torque:
            cells.append(3 * math.sin(2.1 * t))
        lines.append(",".join(f"{cell:.6f}" for cell in cells))
    return "\n".join(lines) + "\n"


class Fields(Case):
    def test_the_fields_that_other_tools_rely_on(self):
        got = info("-", stdin=swing())
        self.assertEqual(got["schema"], "ripplenotch/info/1")
        self.assertEqual(got["rows"], 4000)
        self.assertAlmostEqual(got["duration_s"], 7.998, places=9)
        self.assertAlmostEqual(got["sample_rate_hz"], 500.0, places=6)
        self.assertLess(got["jitter_ms"], 1e-6)
        self.assertEqual(got["gaps"], [])
        self.assertEqual(got["held_samples"], 0)
        self.assertAlmostEqual(got["clock_factor"], 1.0, places=4)
        self.assertEqual(got["format"], "csv")
        self.assertEqual([c["role"] for c in got["columns"]], ["time", "velocity", "position", "torque"])
        self.assertEqual([c["unit"] for c in got["columns"]], ["s", "deg/s", "deg", "Nm"])
        self.assertEqual([c["joint"] for c in got["columns"]], [None] * 4)
        self.assertAlmostEqual(got["speed_deg_s"]["max"], 90.0, places=3)
        self.assertEqual(got["warnings"], [])
        self.assertIn("--columns time=time_s,velocity=velocity_deg_s,torque=torque_nm", got["options"])
        self.assertTrue(all(use["possible"] for use in got["uses"]))

    def test_the_same_log_gives_the_same_bytes(self):
        self.assertEqual(run("info", "--json", "-", stdin=swing()).stdout, run("info", "--json", "-", stdin=swing()).stdout)

    def test_a_wrong_nominal_clock_is_a_warning_that_names_the_factor(self):
        got = info("-", stdin=swing(clock=1 / 1.47))
        self.assertAlmostEqual(got["clock_factor"], 1.47, delta=0.003)
        self.assertEqual(len(got["warnings"]), 1)
        self.assertIn("1.47", got["warnings"][0])
        self.assertIn("the sample rate is then 500 Hz, not 735 Hz", got["warnings"][0])
        text = run("info", "-", stdin=swing(clock=1 / 1.47)).stdout
        self.assertIn("1.47", text.split("warnings")[1])

    def test_a_stated_rate_is_checked_as_well(self):
        got = info("-", "--sample-rate", "735Hz", stdin=swing())
        self.assertEqual(got["sample_rate_hz"], 735)
        self.assertAlmostEqual(got["clock_factor"], 1.47, delta=0.003)

    def test_a_gap_is_listed_and_left_out_of_the_rate(self):
        rows = swing().splitlines()
        late = [f"{float(r.split(',')[0]) + 5:.6f}," + r.split(",", 1)[1] for r in rows[2001:]]
        got = info("-", stdin="\n".join(rows[:2001] + late) + "\n")
        self.assertEqual(len(got["gaps"]), 1)
        self.assertEqual(got["gaps"][0]["row"], 1999)
        self.assertAlmostEqual(got["gaps"][0]["to_s"] - got["gaps"][0]["from_s"], 5.002, places=6)
        self.assertAlmostEqual(got["sample_rate_hz"], 500.0, places=6)

    def test_several_logs_are_one_object(self):
        for name in ("a.csv", "b.csv"):
            (self.folder / name).write_text(swing())
        got = info(self.folder / "a.csv", self.folder / "b.csv")
        self.assertEqual([log["rows"] for log in got["logs"]], [4000, 4000])
        self.assertEqual(len(got["inputs"][0]["sha256"]), 64)


class Joints(Case):
    def test_all_joints_are_described_without_asking(self):
        got = info(SOURCE / "data/dialects/named_joints.csv")
        self.assertEqual([joint["joint"] for joint in got["joints"]], ["shoulder_pan_joint", "wrist_1_joint"])
        self.assertEqual([c["role"] for c in got["columns"]], ["time", "velocity", "torque", "velocity", "torque", "other"])
        self.assertEqual(got["speed_deg_s"], {"min": -60.5, "max": 60.5})
        self.assertEqual(run("info", "--joint", "wrist_2_joint", SOURCE / "data/dialects/named_joints.csv").returncode, 2)

    def test_one_joint_when_asked(self):
        got = info(SOURCE / "data/dialects/named_joints.csv", "--joint", "wrist_1_joint")
        self.assertEqual([joint["joint"] for joint in got["joints"]], ["wrist_1_joint"])


class Lacking(unittest.TestCase):
    def test_a_log_without_torque_is_described(self):
        got = info("-", stdin=swing(torque=False))
        self.assertAlmostEqual(got["clock_factor"], 1.0, places=4)
        self.assertIsNone(got["joints"][0]["torque_nm"])
        self.assertEqual({use["name"]: use["possible"] for use in got["uses"]},
                         {"spectrum": False, "identify": False, "filter": False, "clock-check": True})

    def test_a_log_of_unknown_columns_is_described_and_told_to_be_of_no_use_as_it_is(self):
        rows = "\n".join(f"{k},{0.37 * k % 5:.3f},{0.11 * k % 3:.3f}" for k in range(100)) + "\n"
        for data in ("a,b,c\n" + rows, rows):
            got = info("-", stdin=data)
            self.assertEqual({column["role"] for column in got["columns"]}, {"other"})
            self.assertEqual({use["possible"] for use in got["uses"]}, {False})
            self.assertIn("no command can use this log as it is", got["warnings"][0])
            self.assertIn("--columns time=NAME,velocity=NAME,torque=NAME", got["warnings"][0])
            text = run("info", "-", stdin=data).stdout
            self.assertIn("no column known as velocity, torque or position", text.split("\n")[0])
            named = info("-", "--columns", "time=1,velocity=2,torque=3", "--unit", "time=ms", stdin=data)
            self.assertEqual([column["role"] for column in named["columns"]], ["time", "velocity", "torque"])
            self.assertFalse([text for text in named["warnings"] if "no column is known" in text])

    def test_a_log_without_time_or_header_is_described(self):
        for name in ("no_time", "no_header"):
            got = info(SOURCE / f"data/dialects/{name}.csv")
            self.assertEqual(got["rows"], 12)
            self.assertIsNone(got["sample_rate_hz"])
            self.assertIn("--sample-rate", " ".join(got["warnings"]))
        got = info(SOURCE / "data/dialects/no_header.csv", "--columns", "time,velocity,torque")
        self.assertAlmostEqual(got["sample_rate_hz"], 100.0, places=6)


class Dialects(unittest.TestCase):
    def test_every_dialect_passes_the_filter_byte_for_byte(self):
        more = {"no_header": ["--columns", "time,velocity,torque"], "no_time": ["--sample-rate", "100Hz"],
                "libfranka_style": ["--joint", "0", "--unit", "time=ms"], "named_joints": ["--joint", "wrist_1_joint"]}
        for path in sorted((SOURCE / "data/dialects").glob("*.csv")):
            with self.subTest(path.name):
                done = ended(0, run("filter", path, "--method", "none", "-q", *more.get(path.stem, []), text=False))
                self.assertEqual(done.stdout, path.read_bytes())

    def test_the_option_line_of_verbose_forces_the_same_reading(self):
        path = SOURCE / "data/dialects/semicolon_decimal_comma_crlf.csv"
        line = run("info", "-v", path).stderr.split("read as if with ")[1].strip()
        again = ended(0, subprocess.run(f"'{TOOL}' info --json '{path}' {line}", shell=True, capture_output=True, timeout=60))
        self.assertEqual(json.loads(again.stdout)["options"], line)


@unittest.skipUnless(LOGS.is_dir(), "the folder of real logs is not here")
class RealLogs(unittest.TestCase):
    def test_every_real_log_is_understood(self):
        expected = {  # rows, rate, joints, joints whose clock can be checked
            "kuka_kr300_trajA_all.csv": (2501, 250.0, 6), "kuka_kr300_trajB_all.csv": (2501, 250.0, 6),
            "neura_lara8_j3.csv": (1832, 249.064, 1), "ur10_unisa_exciting_all.csv": (3441, 125.0, 6),
            "ur3e_rad_L1L2_j345.csv": (65, 25.0, 3), "gpl3/panda_gaz_j1.csv": (20544, 978.28, 1),
            "gpl3/panda_gaz_j4.csv": (20544, 978.28, 1), "raw/neura_lara8_0.5_original.csv": (216, 486.487, 6),
            "raw/neura_lara8_validate_original.csv": (1832, 249.064, 6),
        }
        for name, (rows, rate, joints) in expected.items():
            with self.subTest(name):
                got = info(LOGS / name)
                self.assertEqual(got["rows"], rows)
                self.assertAlmostEqual(got["mean_rate_hz"], rate, delta=0.01)
                self.assertEqual(got["sample_rate_hz"], {249.064: 250.0, 978.28: 1000.0}.get(rate, got["sample_rate_hz"]))
                self.assertEqual(len(got["joints"]), joints)
                self.assertAlmostEqual(got["clock_factor"], 1.0, delta=0.015)
                self.assertFalse([w for w in got["warnings"] if "clock is wrong" in w])

    def test_raw_logs_without_units_are_read_in_radians_and_the_reason_is_told(self):
        lara = info(LOGS / "raw/neura_lara8_validate_original.csv")
        self.assertIn("rad/s", " ".join(one["assumed"] for one in lara["recordings"][0]["assumptions"]))
        self.assertIn("no unit is stated", " ".join(lara["warnings"]))
