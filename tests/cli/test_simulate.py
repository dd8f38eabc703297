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
import unittest

from commands import DATA, SOURCE, TOOL, Case, ended, run

JOINT = ["--gear-ratio", "100", "--ripple", "1:0.8Nm:30deg", "--inertia", "0.5kgm2"]
MOVE = ["--motion", "poly6,to=90deg,duration=1s", "--motion", "constant,speed=60deg/s,duration=0.5s",
        "--sample-rate", "1kHz"]


def simulate(*words, stdin=None):
    return run("simulate", *words, stdin=stdin, text=False)


def rows(done):
    if done.returncode != 0:
        raise AssertionError(done.stderr.decode())
    return list(csv.DictReader(done.stdout.decode().splitlines()))


def column(done, name):
    return [float(row[name]) for row in rows(done)]


def peak_to_peak(values):
    return max(values) - min(values)


class Data(Case):
    def test_make_data_writes_the_committed_logs_byte_for_byte(self):
        ended(0, subprocess.run([SOURCE / "scripts" / "make-data", self.folder], capture_output=True, text=True,
                                env=dict(os.environ, RIPPLENOTCH=TOOL), timeout=60))
        made = {path.name: path.read_bytes() for path in self.folder.iterdir()}
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
            logged = log(f"paper_{speed}deg_s")
            self.assertEqual(set(logged["velocity_deg_s"]), {float(speed)})
            self.assertEqual(len(logged["time_s"]), 4000)
            # 1.96 Nm of ripple, widened by less than the noise's own span.
            self.assertGreater(peak_to_peak(logged["torque_nm"]), 1.96)
            self.assertLess(peak_to_peak(logged["torque_nm"]), 1.96 + 0.3)
            # The share of order 1 at f = 100 v / 360, from a plain Fourier sum over whole cycles.
            cycles = int(4 * 100 * speed / 360)
            n = round(1000 * cycles / (100 * speed / 360))
            turns = [2 * math.pi * 100 * speed / 360 * t for t in logged["time_s"][:n]]
            for order, amplitude in ((1, 0.8), (2, 0.5), (3, 0.0)):
                real = sum(x * math.cos(order * a) for x, a in zip(logged["torque_nm"], turns)) * 2 / n
                imaginary = sum(x * math.sin(order * a) for x, a in zip(logged["torque_nm"], turns)) * 2 / n
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


class Summary(Case):
    def test_json_describes_the_log_that_was_written(self):
        log = str(self.folder / "log.csv")
        done = ended(0, simulate(*JOINT, *MOVE, "--noise", "0.05Nm", "--seed", "9", "-o", log, "--json"))
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
        self.assertNotIn(str(self.folder), summary["command"])

    def test_the_models_of_summaries_run_again(self):
        log = self.folder / "log.csv"
        summary = json.loads(simulate(*JOINT, *MOVE, "-o", str(log), "--json").stdout)
        model = dict(summary["model"], schema="ripplenotch/model/1")
        again = simulate("--model", "-", *MOVE, stdin=json.dumps(model).encode())
        self.assertEqual(again.stdout, log.read_bytes())


class AlongLogs(Case):
    """simulate LOG: the model along the motion that a log measured."""

    JOINT = ["--gear-ratio", "100", "--inertia", "0.5kgm2", "--ripple", "1:0.8Nm:30deg", "--effect",
             "viscous-friction,coefficient_nm_per_deg_s=0.005"]
    MOVES = ["--motion", "rest,duration=0.3s", "--motion", "poly6,to=120deg,duration=1s", "--motion",
             "rest,duration=0.3s", "--motion", "poly6,to=-20deg,duration=1.5s", "--motion", "rest,duration=0.3s",
             "--sample-rate", "1kHz"]

    def log(self, *words, moves=None):
        path = str(self.folder / "log.csv")
        ended(0, simulate(*self.JOINT, *(moves or self.MOVES), *words, "-o", path, "--force"))
        return path

    def test_the_right_model_leaves_the_noise_and_a_wrong_one_more(self):
        log = self.log("--noise", "0.06Nm", "--velocity-noise", "0.15deg/s")
        out = str(self.folder / "out.csv")
        done = ended(0, simulate(*self.JOINT, log, "-o", out, "--json"))
        summary = json.loads(done.stdout)
        # By the velocity alone its noise would come in through the acceleration: 0.15 deg/s * 1 kHz *
        # sqrt(75 / 51^3) = 3.6 deg/s2, 0.03 Nm, 0.067 Nm in all. The position is surer.
        self.assertGreater(summary["along_log"]["residual_rms_nm"], 0.057)
        self.assertLess(summary["along_log"]["residual_rms_nm"], 0.064)
        self.assertEqual(summary["along_log"]["smoothing_s"], 0.05)
        self.assertEqual(summary["motions"], [])
        self.assertEqual(summary["sample_rate_hz"], 1000)
        self.assertEqual([record["rows"] for record in summary["inputs"]], [3400])
        # The residual printed is that of the columns written.
        with open(out) as made, open(log) as measured:
            pairs = list(zip(csv.DictReader(made), csv.DictReader(measured)))
        for a, b in pairs:
            for name in ("time_s", "velocity_deg_s", "position_deg"):
                self.assertEqual(a[name], b[name])
        residual = [float(b["torque_nm"]) - float(a["torque_nm"]) for a, b in pairs]
        self.assertAlmostEqual(math.sqrt(sum(r * r for r in residual) / len(residual)),
                               summary["along_log"]["residual_rms_nm"], delta=5.1e-11)  # nine digits
        wrong = json.loads(simulate("--gear-ratio", "101", *self.JOINT[2:], log, "-o", out, "--force", "--json").stdout)
        self.assertGreater(wrong["along_log"]["residual_rms_nm"], 0.3)

    def test_a_log_without_position_gives_one_without_position(self):
        log = self.log("--no-position")
        done = simulate(*self.JOINT, log)
        self.assertEqual(list(rows(done)[0]), ["time_s", "velocity_deg_s", "torque_nm"])
        with open(log) as measured:
            truth = [float(row["torque_nm"]) for row in csv.DictReader(measured)]
        # The moves begin with a kink of the acceleration, which the smoothing rounds.
        for a, b in zip(column(done, "torque_nm"), truth):
            self.assertAlmostEqual(a, b, delta=0.2)
        sharp = column(simulate(*self.JOINT, "--smoothing", "6ms", log), "torque_nm")
        for a, b in zip(sharp, truth):
            self.assertAlmostEqual(a, b, delta=0.02)

    def test_units_joints_and_pipes_are_read_as_every_command_does(self):
        log = pathlib.Path(self.log())
        done = simulate(*self.JOINT, str(log))
        lines = log.read_text().splitlines()
        odd = [lines[0].replace("velocity_deg_s", "j4_velocity [rad/s]").replace("torque_nm", "j4_torque [Nm]")
               .replace("position_deg", "j4_position [deg]")]
        for line in lines[1:]:
            cells = line.split(",")
            cells[1] = repr(math.radians(float(cells[1])))
            odd.append(",".join(cells))
        piped = simulate(*self.JOINT, "--joint", "j4", "-", stdin="\n".join(odd).encode())
        for a, b in zip(column(piped, "torque_nm"), column(done, "torque_nm")):
            self.assertAlmostEqual(a, b, delta=1e-9)

    def test_spikes_of_a_model_are_left_out_of_a_prediction_unless_asked_for(self):
        log = self.log()
        spiky = [*self.JOINT, "--effect", "spikes,rate_percent=1,size_nm=50"]
        plain = column(simulate(*self.JOINT, log), "torque_nm")
        self.assertEqual(column(simulate(*spiky, log), "torque_nm"), plain)
        with_spikes = column(simulate(*spiky, "--faults", log), "torque_nm")
        self.assertGreater(sum(abs(a - b) > 40 for a, b in zip(with_spikes, plain)), 10)
        made = column(simulate(*spiky, *self.MOVES), "torque_nm")
        self.assertGreater(max(made), 40)

    def test_correlated_noise_has_its_rms_and_its_correlation(self):
        long = ["--gear-ratio", "1", "--motion", "rest,duration=40s", "--sample-rate", "1kHz", "--noise", "50mNm"]
        values = column(simulate(*long, "--noise-correlation", "0.9"), "torque_nm")
        power = sum(x * x for x in values) / len(values)
        # 40000 values of correlation 0.9 are worth about 2100 independent ones.
        self.assertAlmostEqual(math.sqrt(power) / 0.05, 1.0, delta=0.06)
        self.assertAlmostEqual(sum(a * b for a, b in zip(values, values[1:])) / len(values) / power, 0.9, delta=0.01)
        self.assertEqual(simulate(*long, "--noise-correlation", "0").stdout, simulate(*long).stdout)


class Refusals(Case):
    def refused(self, code, expected, *words, stdin=b""):
        log = self.folder / "log.csv"
        done = simulate(*words, "-o", str(log), stdin=stdin)
        message = done.stderr.decode()
        self.assertEqual(done.returncode, code, message)
        self.assertEqual(done.stdout, b"")
        self.assertEqual(len(message.splitlines()), 1, message)
        for part in expected:
            self.assertIn(part, message)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_wrong_request_is_exit_code_2_with_one_line_and_no_file(self):
        self.refused(2, ["--gear-ratio is missing", "--model"], *MOVE)
        self.refused(2, ["--motion is missing", "for example"], "--gear-ratio", "100", "--sample-rate", "1kHz")
        self.refused(2, ["--sample-rate is missing"], "--gear-ratio", "100", "--motion", "rest,duration=1s")
        self.refused(2, ["--gear-ratio -1 is not above 0"], "--gear-ratio", "-1", *MOVE)
        self.refused(2, ["--gear-ratio", "states the gear ratio"], "--gear-ratio", "100", "--model",
                     str(DATA / "paper_model.json"), *MOVE)
        self.refused(2, ["--ripple", "'0.8Nm'", "1:0.8Nm:0deg"], "--gear-ratio", "100", "--ripple", "0.8Nm", *MOVE)
        self.refused(2, ["--ripple", "'1:2:3:4'"], "--gear-ratio", "100", "--ripple", "1:2:3:4", *MOVE)
        self.refused(2, ["ripple, order", "0 is not between"], "--gear-ratio", "100", "--ripple", "0:1Nm", *MOVE)
        self.refused(2, ["inertia", "-1"], "--gear-ratio", "100", "--inertia", "-1", *MOVE)
        self.refused(2, ["--ripple", "'1:'"], "--gear-ratio", "100", "--ripple", "1:", *MOVE)
        self.refused(2, ["amplitude_nm", "'2deg'"], "--gear-ratio", "100", "--ripple", "1:2deg", *MOVE)
        self.refused(2, ["did you mean constant?"], *JOINT, "--motion", "constnat,speed=1", "--sample-rate", "1kHz")
        self.refused(2, ["--motion and a LOG", "give one"], *JOINT, *MOVE, "log.csv")
        self.refused(2, ["standard input holds one"], "--model", "-", "-")
        self.refused(2, ["--noise-correlation: 1"], *JOINT, *MOVE, "--noise-correlation", "1")
        self.refused(2, ["--smoothing: -1"], *JOINT, "--smoothing", "-1", "log.csv")
        self.refused(4, ["no-such.csv"], *JOINT, "no-such.csv")
        self.refused(3, ["3 rows", "at least 5"], *JOINT, "-", stdin=b"time_s,velocity_deg_s,torque_nm\n0,1,2\n1,1,2\n2,1,2\n")
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
        log = self.folder / "log.csv"
        log.write_text("precious")
        self.assertEqual(simulate(*JOINT, *MOVE, "-o", str(log)).returncode, 4)
        self.assertEqual(log.read_text(), "precious")
        self.assertEqual(simulate(*JOINT, *MOVE, "-o", str(log), "--force").returncode, 0)
        self.assertTrue(log.read_text().startswith("time_s,"))

    def test_a_summary_and_a_log_cannot_share_standard_output(self):
        ended(2, simulate(*JOINT, *MOVE, "--json"), b"-o FILE")
