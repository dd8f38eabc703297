# SPDX-License-Identifier: MIT
"""simulate: the logs of data/ byte for byte, seeds, formats, and what it refuses."""

import csv
import hashlib
import json
import math
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest

TOOL = os.environ["RIPPLENOTCH"]
SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])
DATA = SOURCE / "data"
JOINT = ["--gear-ratio", "100", "--ripple", "1:0.8Nm:30deg", "--inertia", "0.5kgm2"]
MOVE = ["--motion", "poly6,to=90deg,duration=1s", "--motion", "constant,speed=60deg/s,duration=0.5s",
        "--sample-rate", "1kHz"]


def simulate(*words, stdin=b""):
    return subprocess.run([TOOL, "simulate", *words], capture_output=True, input=stdin, timeout=60)


def rows(done):
    if done.returncode != 0:
        raise AssertionError(done.stderr.decode())
    return list(csv.DictReader(done.stdout.decode().splitlines()))


def column(done, name):
    return [float(row[name]) for row in rows(done)]


def peak_to_peak(values):
    return max(values) - min(values)


class Data(unittest.TestCase):
    def test_make_data_writes_the_committed_logs_byte_for_byte(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([SOURCE / "scripts" / "make-data", folder], capture_output=True, text=True,
                                  env=dict(os.environ, RIPPLENOTCH=TOOL), timeout=60)
            self.assertEqual(done.returncode, 0, done.stderr)
            made = {path.name: path.read_bytes() for path in pathlib.Path(folder).iterdir()}
        committed = {path.name: path.read_bytes() for path in DATA.glob("*.csv")}
        self.assertEqual(sorted(made), sorted(committed))
        self.assertEqual(len(made), 6)
        for name in made:
            self.assertEqual(made[name], committed[name], name)

    def test_the_logs_show_what_the_paper_shows(self):
        def log(name):
            with open(DATA / f"{name}.csv", encoding="ascii") as file:
                return {key: [float(v) for v in values]
                        for key, *values in zip(*csv.reader(file))}

        self.assertLess(peak_to_peak(log("paper_rest")["torque_nm"]), 0.3)
        for speed in (60, 90, 120, 180):
            run = log(f"paper_{speed}deg_s")
            self.assertEqual(set(run["velocity_deg_s"]), {float(speed)})
            self.assertEqual(len(run["time_s"]), 4000)
            # 1.96 Nm of ripple, widened by less than the noise's own span.
            self.assertGreater(peak_to_peak(run["torque_nm"]), 1.96)
            self.assertLess(peak_to_peak(run["torque_nm"]), 1.96 + 0.3)
            # The share of order 1 at f = 100 v / 360, from a plain Fourier sum over whole cycles.
            cycles = int(4 * 100 * speed / 360)
            n = round(1000 * cycles / (100 * speed / 360))
            turns = [2 * math.pi * 100 * speed / 360 * t for t in run["time_s"][:n]]
            for order, amplitude in ((1, 0.8), (2, 0.5), (3, 0.0)):
                real = sum(x * math.cos(order * a) for x, a in zip(run["torque_nm"], turns)) * 2 / n
                imaginary = sum(x * math.sin(order * a) for x, a in zip(run["torque_nm"], turns)) * 2 / n
                self.assertAlmostEqual(math.hypot(real, imaginary), amplitude, delta=0.006)
        move = log("paper_move_2s")
        self.assertEqual((move["position_deg"][0], move["position_deg"][-1]), (90.0, -90.0))
        self.assertEqual(max(abs(v) for v in move["velocity_deg_s"]), 168.75)
        self.assertLess(sum(path.stat().st_size for path in DATA.iterdir()), 1_500_000)


class Seeds(unittest.TestCase):
    def test_the_same_command_gives_the_same_bytes_and_another_seed_others(self):
        noisy = [*JOINT, *MOVE, "--noise", "0.05Nm"]
        self.assertEqual(simulate(*noisy, "--seed", "3").stdout, simulate(*noisy, "--seed", "3").stdout)
        self.assertNotEqual(simulate(*noisy, "--seed", "3").stdout, simulate(*noisy, "--seed", "4").stdout)

    def test_noise_on_one_column_leaves_every_other_as_it_was(self):
        plain, torque, both = (simulate(*JOINT, *MOVE, *noise) for noise in (
            [], ["--noise", "0.05Nm"], ["--noise", "0.05Nm", "--velocity-noise", "0.15deg/s"]))
        self.assertEqual(column(torque, "velocity_deg_s"), column(plain, "velocity_deg_s"))
        self.assertEqual(column(both, "torque_nm"), column(torque, "torque_nm"))
        self.assertEqual(column(both, "position_deg"), column(plain, "position_deg"))
        self.assertNotEqual(column(both, "velocity_deg_s"), column(plain, "velocity_deg_s"))

    def test_noise_has_the_rms_asked_for(self):
        long = ["--gear-ratio", "1", "--motion", "rest,duration=40s", "--sample-rate", "1kHz"]
        done = simulate(*long, "--noise", "50mNm", "--velocity-noise", "0.15deg/s")
        for name, rms in (("torque_nm", 0.05), ("velocity_deg_s", 0.15)):
            values = column(done, name)
            self.assertAlmostEqual(math.sqrt(sum(x * x for x in values) / len(values)) / rms, 1.0, delta=0.018)

    def test_a_noisy_log_is_the_clean_one_plus_noise_of_its_seed_whatever_the_model(self):
        rest = ["--motion", "rest,duration=0.1s", "--sample-rate", "1kHz", "--noise", "0.05Nm"]
        alone = column(simulate("--gear-ratio", "100", *rest), "torque_nm")
        shifted = column(simulate("--gear-ratio", "100", "--effect", "offset,torque_nm=2", *rest), "torque_nm")
        for a, b in zip(alone, shifted):
            self.assertAlmostEqual(b - a, 2.0, delta=1e-14)


class Logs(unittest.TestCase):
    def test_columns_rows_and_time_are_exact(self):
        done = simulate(*JOINT, *MOVE)
        lines = done.stdout.decode().splitlines()
        self.assertEqual(lines[0], "time_s,velocity_deg_s,torque_nm,position_deg")
        self.assertEqual(len(lines), 1501)
        self.assertEqual([row["time_s"] for row in rows(done)], [repr(k / 1000) if k % 1000 else str(k // 1000)
                                                                  for k in range(1500)])
        self.assertEqual(done.stderr, b"")

    def test_no_position_leaves_out_the_column_and_nothing_else(self):
        with_position = simulate(*JOINT, *MOVE).stdout.decode().splitlines()
        without = simulate(*JOINT, *MOVE, "--no-position").stdout.decode().splitlines()
        self.assertEqual(without, [line.rpartition(",")[0] for line in with_position])

    def test_decimals_round_every_column_but_time(self):
        exact = rows(simulate(*JOINT, "--motion", "constant,speed=-7deg/s,duration=1s", "--sample-rate", "3kHz"))
        rounded = rows(simulate(*JOINT, "--motion", "constant,speed=-7deg/s,duration=1s", "--sample-rate", "3kHz",
                                "--decimals", "3"))
        self.assertEqual([row["time_s"] for row in exact], [row["time_s"] for row in rounded])
        for a, b in zip(exact, rounded):
            for name in ("velocity_deg_s", "torque_nm", "position_deg"):
                self.assertLessEqual(abs(float(a[name]) - float(b[name])), 0.0005 + 1e-12)
                self.assertLessEqual(len(b[name].partition(".")[2]), 3)
                self.assertNotEqual(b[name], "-0")

    def test_npy_holds_the_same_numbers_as_csv(self):
        if "FORMAT(npy)" not in (SOURCE / "src" / "log" / "formats" / "formats.def").read_text():
            self.skipTest("npy is not listed")
        text = rows(simulate(*JOINT, *MOVE, "--noise", "0.05Nm"))
        binary = simulate(*JOINT, *MOVE, "--noise", "0.05Nm", "--format", "npy").stdout
        self.assertEqual(binary[:6], b"\x93NUMPY")
        size = 1500 * 4 * 8
        numbers = struct.unpack(f"<{1500 * 4}d", binary[-size:])
        expected = [float(row[name]) for row in text for name in row]
        self.assertEqual(list(numbers), expected)

    def test_a_model_file_and_its_options_give_the_same_bytes(self):
        by_file = simulate("--model", str(DATA / "paper_model.json"), *MOVE)
        by_pipe = simulate("--model", "-", *MOVE, stdin=(DATA / "paper_model.json").read_bytes())
        by_options = simulate("--gear-ratio", "100", "--inertia", "0.992kgm2", "--ripple", "1:0.8Nm:0deg",
                              "--ripple", "2:500mNm", *MOVE)
        self.assertEqual(by_file.returncode, 0, by_file.stderr)
        self.assertEqual(by_file.stdout, by_options.stdout)
        self.assertEqual(by_file.stdout, by_pipe.stdout)

    def test_effects_add_to_a_model(self):
        model = ["--model", str(DATA / "paper_model.json")]
        plain = column(simulate(*model, *MOVE), "torque_nm")
        more = column(simulate(*model, "--effect", "viscous-friction,coefficient_nm_per_deg_s=0.005", *MOVE), "torque_nm")
        speed = column(simulate(*model, *MOVE), "velocity_deg_s")
        for a, b, v in zip(plain, more, speed):
            self.assertAlmostEqual(b - a, 0.005 * v, delta=1e-12)

    def test_the_move_there_and_back_mirrors_inertia_and_repeats_ripple(self):
        def torque(first, second):
            return column(simulate("--gear-ratio", "100", *first, "--motion", f"poly6,from={second}deg,"
                                   f"to={-second}deg,duration=1s", "--sample-rate", "1kHz"), "torque_nm")

        for a, b in zip(torque(["--inertia", "1"], 45), torque(["--inertia", "1"], -45)):
            self.assertAlmostEqual(a, -b, delta=1e-12)
        # A cosine of the position is the same at q and -q.
        for a, b in zip(torque(["--ripple", "1:1Nm"], 45), torque(["--ripple", "1:1Nm"], -45)):
            self.assertAlmostEqual(a, b, delta=1e-9)


    def test_the_clean_torque_of_the_papers_move_is_what_paper_and_pencil_say(self):
        done = simulate("--model", str(DATA / "paper_model.json"), "--motion", "rest,duration=0.5s,from=90deg",
                        "--motion", "poly6,to=-90deg,duration=2s", "--motion", "rest,duration=0.5s",
                        "--sample-rate", "1kHz")
        for k, row in enumerate(rows(done)):
            u = min(max((k - 500) / 2000, 0.0), 1.0)
            position = 90 - 180 * (10 * u**3 - 15 * u**4 + 6 * u**5)
            acceleration = -180 * (60 * u - 180 * u**2 + 120 * u**3) / 4
            motor = math.radians(100 * position)
            torque = 0.992 * math.radians(acceleration) + 0.8 * math.cos(motor) + 0.5 * math.cos(2 * motor)
            self.assertAlmostEqual(float(row["position_deg"]), position, delta=1e-12)
            self.assertAlmostEqual(float(row["torque_nm"]), torque, delta=1e-10)


class Summary(unittest.TestCase):
    def test_json_describes_the_log_that_was_written(self):
        with tempfile.TemporaryDirectory() as folder:
            log = str(pathlib.Path(folder, "log.csv"))
            done = simulate(*JOINT, *MOVE, "--noise", "0.05Nm", "--seed", "9", "-o", log, "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            summary = json.loads(done.stdout)
            written = pathlib.Path(log).read_bytes()
        self.assertEqual(summary["schema"], "ripplenotch/simulation/1")
        self.assertEqual(summary["rows"], 1500)
        self.assertEqual(summary["sample_rate_hz"], 1000)
        self.assertEqual(summary["duration_s"], 1.5)
        self.assertEqual(summary["seed"], 9)
        self.assertEqual(summary["noise_rms_nm"], 0.05)
        self.assertEqual(summary["output"]["sha256"], hashlib.sha256(written).hexdigest())
        table = list(csv.DictReader(written.decode().splitlines()))
        self.assertEqual(summary["columns"], list(table[0]))
        torque = [float(row["torque_nm"]) for row in table]
        self.assertEqual(summary["torque_nm"], {"min": min(torque), "max": max(torque)})
        speed = [abs(float(row["velocity_deg_s"])) for row in table]
        self.assertEqual(summary["speed_deg_s"], {"min": min(speed), "max": max(speed)})
        self.assertEqual([effect["effect"] for effect in summary["model"]["effects"]], ["inertia", "ripple"])
        self.assertIn("--seed 9", summary["command"])
        self.assertNotIn(folder, summary["command"])

    def test_the_models_of_summaries_run_again(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "log.csv")
            summary = json.loads(simulate(*JOINT, *MOVE, "-o", str(log), "--json").stdout)
            model = dict(summary["model"], schema="ripplenotch/model/1")
            again = simulate("--model", "-", *MOVE, stdin=json.dumps(model).encode())
            self.assertEqual(again.stdout, log.read_bytes())


class Refusals(unittest.TestCase):
    def refused(self, code, expected, *words, stdin=b""):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "log.csv")
            done = simulate(*words, "-o", str(log), stdin=stdin)
            message = done.stderr.decode()
            self.assertEqual(done.returncode, code, message)
            self.assertEqual(done.stdout, b"")
            self.assertEqual(len(message.splitlines()), 1, message)
            for part in expected:
                self.assertIn(part, message)
            self.assertEqual(list(pathlib.Path(folder).iterdir()), [])

    def test_a_wrong_request_is_exit_code_2_with_one_line_and_no_file(self):
        self.refused(2, ["--gear-ratio is missing", "--model"], *MOVE)
        self.refused(2, ["--motion is missing", "for example"], "--gear-ratio", "100", "--sample-rate", "1kHz")
        self.refused(2, ["--sample-rate is missing"], "--gear-ratio", "100", "--motion", "rest,duration=1s")
        self.refused(2, ["--gear-ratio: -1"], "--gear-ratio", "-1", *MOVE)
        self.refused(2, ["--gear-ratio", "states the gear ratio"], "--gear-ratio", "100", "--model",
                     str(DATA / "paper_model.json"), *MOVE)
        self.refused(2, ["--ripple", "'0.8Nm'", "1:0.8Nm:0deg"], "--gear-ratio", "100", "--ripple", "0.8Nm", *MOVE)
        self.refused(2, ["--ripple", "'1:2:3:4'"], "--gear-ratio", "100", "--ripple", "1:2:3:4", *MOVE)
        self.refused(2, ["ripple, order", "0 is not between"], "--gear-ratio", "100", "--ripple", "0:1Nm", *MOVE)
        self.refused(2, ["inertia", "-1"], "--gear-ratio", "100", "--inertia", "-1", *MOVE)
        self.refused(2, ["--ripple", "'1:'"], "--gear-ratio", "100", "--ripple", "1:", *MOVE)
        self.refused(2, ["amplitude_nm", "'2deg'"], "--gear-ratio", "100", "--ripple", "1:2deg", *MOVE)
        self.refused(2, ["did you mean constant?"], *JOINT, "--motion", "constnat,speed=1", "--sample-rate", "1kHz")
        self.refused(2, ["--noise", "-1"], *JOINT, *MOVE, "--noise", "-1")
        self.refused(2, ["--velocity-noise", "-1"], *JOINT, *MOVE, "--velocity-noise", "-1")
        self.refused(2, ["--decimals", "2.5"], *JOINT, *MOVE, "--decimals", "2.5")
        self.refused(2, ["--sample-rate", "0"], *JOINT, "--motion", "rest,duration=1s", "--sample-rate", "0Hz")
        self.refused(2, ["more than 100000000 samples"], *JOINT, "--motion", "rest,duration=1000000s",
                     "--sample-rate", "1kHz")
        self.refused(2, ["xyz"], *JOINT, *MOVE, "--format", "xyz")

    def test_a_model_with_values_to_be_fitted_is_refused_by_name(self):
        model = b'{"schema":"ripplenotch/model/1","gear_ratio":100,"effects":[{"effect":"inertia"},' \
                b'{"effect":"ripple","order":1}]}'
        self.refused(2, ["effects[0].inertia_kgm2 of inertia", "effects[1].amplitude_nm of ripple", "fit"],
                     "--model", "-", *MOVE, stdin=model)

    def test_a_wrong_model_is_exit_code_3_and_a_missing_one_4(self):
        self.refused(3, ["standard input", "schema"], "--model", "-", *MOVE, stdin=b"{}")
        self.refused(3, ["standard input:1:", "not JSON"], "--model", "-", *MOVE, stdin=b'{"schema": ')
        self.refused(3, ["ripplenotch/joint/1", "ripplenotch/model/1"], "--model", "-", *MOVE,
                     stdin=b'{"schema":"ripplenotch/joint/1"}')
        self.refused(4, ["no-such-model.json"], "--model", "no-such-model.json", *MOVE)

    def test_an_existing_log_is_not_overwritten_unasked(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "log.csv")
            log.write_text("precious")
            self.assertEqual(simulate(*JOINT, *MOVE, "-o", str(log)).returncode, 4)
            self.assertEqual(log.read_text(), "precious")
            self.assertEqual(simulate(*JOINT, *MOVE, "-o", str(log), "--force").returncode, 0)
            self.assertTrue(log.read_text().startswith("time_s,"))

    def test_a_summary_and_a_log_cannot_share_standard_output(self):
        done = simulate(*JOINT, *MOVE, "--json")
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"-o FILE", done.stderr)


if __name__ == "__main__":
    unittest.main()
