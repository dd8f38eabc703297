# SPDX-License-Identifier: MIT
"""ripplenotch features: a line for each log and joint, and files of lines put together."""

import csv
import json
import pathlib

import commands
from commands import ended, run

GEAR = ["--gear-ratio", "100", "--orders", "1,2"]
JOINT = ["--gear-ratio", "100", "--inertia", "1.2", "--ripple", "1:0.5Nm:30deg", "--ripple", "2:0.8Nm:10deg",
         "--effect", "gravity,amplitude_nm=8,phase_deg=20", "--effect", "offset,torque_nm=0.3",
         "--effect", "viscous-friction,coefficient_nm_per_deg_s=0.03", "--effect", "load-friction,torque_nm=0.05,exponent=1,width_deg_s=0.2"]
WINDING = ["--effect", "hysteresis,torque_nm=2,width_deg=0.2,initial_state=0"]
SHARP = ["--effect", "coulomb-friction,torque_nm=2,width_deg_s=0.2"]
MOTION = ["--motion", "multisine,frequency=0.15Hz,amplitude=60deg,duration=8s"]


class Case(commands.Case):
    def log(self, name="log.csv", joint=JOINT, friction=WINDING, motion=MOTION, seed=1, rate="500Hz"):
        path = self.folder / name
        ended(0, run("simulate", *joint, *friction, *motion, "--sample-rate", rate, "--noise", "0.05Nm", "--seed", seed, "-o", path))
        return path

    def line(self, *words, code=0):
        done = ended(code, run("features", *words))
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual(len(lines), 1)
        return lines[0]


class Values(Case):
    def test_a_log_gives_what_it_was_made_with_within_its_intervals(self):
        line = self.line(self.log(), *GEAR)
        truth = {"gear_ratio": 100, "ripple_1_amplitude_nm": 0.5, "ripple_1_phase_deg": 30, "ripple_2_amplitude_nm": 0.8,
                 "ripple_2_phase_deg": 10, "coulomb_friction_nm": 2, "viscous_friction_nm_per_deg_s": 0.03, "load_friction_nm_per_nm": 0.05,
                 "lost_motion_deg": 0.2, "inertia_kgm2": 1.2, "gravity_nm": 8, "sensor_zero_nm": 0.3}
        for name, value in truth.items():
            low, high = next(line[key] for key in line if "_ci95" in key and key.replace("_ci95", "") == name)
            self.assertLess(low, line[name], name)
            self.assertLess(abs(line[name] - value), 2.5 * 0.5 * (high - low) + 1e-9, name)
            self.assertLess(high - low, 0.3 * abs(value), name)
        self.assertAlmostEqual(line["noise_floor_nm"], 0.05, delta=0.005)

    def test_the_motion_and_the_load_of_a_line_are_those_of_the_log(self):
        path = self.log()
        line = self.line(path, *GEAR)
        rows = [[float(cell) for cell in row] for row in list(csv.reader(path.read_text().splitlines()))[1:]]
        speed, torque, position = ([row[column] for row in rows] for column in (1, 2, 3))

        def rms(values):
            mean = sum(values) / len(values)
            return (sum((value - mean) ** 2 for value in values) / len(values)) ** 0.5

        self.assertAlmostEqual(line["travel_deg"], max(position) - min(position), delta=0.05)
        self.assertAlmostEqual(line["torque_rms_nm"] / rms(torque), 1, delta=0.01)
        moving = sorted(abs(one) for one in speed if abs(one) > 1)
        self.assertAlmostEqual(line["speed_p50_deg_s"] / moving[len(moving) // 2], 1, delta=0.03)
        self.assertAlmostEqual(line["forward_share"], sum(one > 1 for one in speed) / len(moving), delta=0.02)
        load = self.log("load.csv", joint=["--gear-ratio", "100", "--inertia", "1.2", "--effect", "gravity,amplitude_nm=8,phase_deg=20"], friction=[])
        carried = [float(row[2]) for row in list(csv.reader(load.read_text().splitlines()))[1:]]
        self.assertAlmostEqual(line["load_rms_nm"] / (sum(one * one for one in carried) / len(carried)) ** 0.5, 1, delta=0.03)

    def test_sharp_friction_has_no_lost_motion_and_the_same_size(self):
        line = self.line(self.log(friction=SHARP), *GEAR)
        self.assertAlmostEqual(line["coulomb_friction_nm"], 2, delta=0.05)
        self.assertIsNone(line["lost_motion_deg"])

    def test_every_null_has_its_reason_and_nothing_else_has_one(self):
        motions = {"one way": ["--motion", "constant,speed=60deg/s,duration=8s"], "rest": ["--motion", "rest,duration=8s"],
                   "both ways": MOTION, "one speed": ["--motion", "ramp,from-speed=60deg/s,to-speed=61deg/s,duration=8s"]}
        for words, motion in motions.items():
            line = self.line(self.log(f"{words[:6].strip()}.csv", motion=motion), *GEAR)
            nulls = {name for name, value in line.items() if value is None}
            self.assertEqual(nulls, set(line["not_told"]), words)
            self.assertTrue(all(line["not_told"].values()), words)
            if words != "both ways":
                self.assertIsNone(line["coulomb_friction_nm"], words)
                self.assertIsNone(line["lost_motion_deg"], words)

    def test_a_log_without_position_has_no_phase(self):
        path = self.log()
        cut = self.folder / "cut.csv"
        cut.write_text("\n".join(",".join(row.split(",")[:3]) for row in path.read_text().splitlines()) + "\n")
        line = self.line(cut, *GEAR)
        self.assertIn("no position", line["not_told"]["ripple_1_phase_deg"])
        self.assertAlmostEqual(line["ripple_2_amplitude_nm"], 0.8, delta=0.1)

    def test_units_that_a_log_does_not_say_are_no_features(self):
        rows = self.log(motion=["--motion", "multisine,frequency=0.15Hz,amplitude=2deg,duration=8s"]).read_text().splitlines()
        bare = self.folder / "bare.csv"
        bare.write_text("\n".join(["time_s,speed,torque_nm"] + [",".join(row.split(",")[:3]) for row in rows[1:]]) + "\n")
        line = self.line(bare, *GEAR, code=3)
        self.assertIn("--unit", line["error"])
        self.line(bare, *GEAR, "--unit", "velocity=deg/s")

    def test_the_ratio_is_found_where_nobody_states_it(self):
        line = self.line(self.log())
        self.assertAlmostEqual(line["gear_ratio"], 100, delta=0.05)
        self.assertAlmostEqual(line["ripple_2_amplitude_nm"], 0.8, delta=0.02)


class Conditions(Case):
    def test_date_and_robot_come_from_the_name(self):
        path = self.log("R7_2026-03-09.csv")
        line = self.line(path, *GEAR, "--date-from-name", "{robot}_%Y-%m-%d.csv")
        self.assertEqual((line["robot"], line["date"], line["date_source"]), ("R7", "2026-03-09T00:00:00Z", "name"))
        line = self.line(path, *GEAR, "--date-from-name", "{robot}_%Y%m%d.csv")
        self.assertIsNone(line["date"])
        self.assertIn("does not fit", line["not_told"]["date"])

    def test_a_day_that_no_month_has_is_no_date(self):
        line = self.line(self.log("R7_2026-02-30.csv"), *GEAR, "--date-from-name", "{robot}_%Y-%m-%d.csv")
        self.assertIsNone(line["date"])

    def test_stamps_that_count_from_1970_tell_the_day(self):
        rows = self.log().read_text().splitlines()
        stamped = self.folder / "stamped.csv"
        lines = [rows[0]] + [f"{1767225600 + float(row.split(',')[0]):.3f},{row.split(',', 1)[1]}" for row in rows[1:]]
        stamped.write_text("\n".join(lines) + "\n")
        line = self.line(stamped, *GEAR)
        self.assertEqual((line["date"], line["date_source"]), ("2026-01-01T00:00:00Z", "log"))

    def test_temperature_is_a_number_or_the_mean_of_a_column(self):
        path = self.log()
        self.assertEqual(self.line(path, *GEAR, "--temperature", "31.5")["temperature_degc"], 31.5)
        rows = path.read_text().splitlines()
        warm = self.folder / "warm.csv"
        warm.write_text("\n".join([rows[0] + ",motor_temp"] + [f"{row},{30 + k % 2}" for k, row in enumerate(rows[1:])]) + "\n")
        line = self.line(warm, *GEAR, "--temperature", "motor_temp")
        self.assertAlmostEqual(line["temperature_degc"], 30.5, delta=0.01)
        self.assertEqual(line["temperature_source"], "column motor_temp")
        cold = self.line(path, *GEAR, "--temperature", "no_such", code=3)
        self.assertIn("no_such", cold["error"])

    def test_patterns_that_are_none_are_refused(self):
        for pattern, word in (("%Y-%m.csv", "%d"), ("%Y%Y%m%d", "twice"), ("%Y%m%d%q", "Y m d")):
            ended(2, run("features", "x.csv", "--date-from-name", pattern), word)


class ManyLogs(Case):
    def test_a_failed_log_is_a_line_and_the_others_are_done(self):
        good, bad = self.log(), self.folder / "bad.csv"
        bad.write_text("time_s,velocity_deg_s,torque_nm\n0,1,x\n")
        done = ended(3, run("features", bad, good, self.folder / "none.csv", *GEAR))
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual([pathlib.Path(line["log"]).name for line in lines], ["bad.csv", "log.csv", "none.csv"])
        self.assertEqual(["error" in line for line in lines], [True, False, True])
        self.assertEqual([line.get("error_code") for line in lines], [3, None, 4])

    def test_each_joint_of_a_log_has_its_line(self):
        rows = self.log().read_text().splitlines()
        two = self.folder / "two.csv"
        head = "time_s,j1_velocity_deg_s,j1_torque_nm,j1_position_deg,j2_velocity_deg_s,j2_torque_nm,j2_position_deg"
        two.write_text("\n".join([head] + [row + "," + row.split(",", 1)[1] for row in rows[1:]]) + "\n")
        done = run("features", two, *GEAR)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual(len({line["joint"] for line in lines}), 2, done.stdout + done.stderr)
        self.assertEqual(lines[0]["coulomb_friction_nm"], lines[1]["coulomb_friction_nm"])

    def test_files_of_lines_are_put_together_and_read_once(self):
        first, second = self.log("R1_2026-03-09.csv", seed=1), self.log("R2_2026-03-09.csv", seed=2)
        words = [*GEAR, "--date-from-name", "{robot}_%Y-%m-%d.csv"]
        whole = run("features", first, second, *words).stdout
        for path in (first, second):
            run("features", path, *words, "-o", path.with_suffix(".ndjson"))
        lines = [path.with_suffix(".ndjson") for path in (first, second)]
        done = run("features", "--merge", *lines)
        self.assertEqual((done.returncode, done.stdout), (0, whole), done.stderr)
        done = run("features", "--merge", *lines, lines[0])
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("already", done.stderr)
        ended(3, run("features", "--merge", first), "line 1")
