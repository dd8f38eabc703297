# SPDX-License-Identifier: MIT
"""ripplenotch identify and spectrum as users meet them: the paper's logs, real logs, pipes, files, refusals."""

import json
import math
import pathlib
import random
import tempfile
import unittest

from commands import DATA, LOGS, Case, ended, run

PAPER = [str(DATA / f"paper_{name}.csv") for name in ("rest", "60deg_s", "120deg_s", "180deg_s")]


def identified(*words):
    done = run("identify", "--json", "-q", *words)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def orders(found, kinds=("order",)):
    return [line["order_output"] for line in found["lines"] if line["kind"] in kinds]


def log_text(speed, ripple_nm, seconds=4.0, rate=500.0, seed=1):
    noise = random.Random(seed)
    rows = ["time_s,velocity_deg_s,torque_nm"]
    for k in range(int(seconds * rate)):
        t = k / rate
        torque = 5.0 + ripple_nm * math.sin(2 * math.pi * 100 * speed / 360 * t) + noise.gauss(0, 0.05)
        rows.append(f"{t:.4f},{speed},{torque:.6f}")
    return "\n".join(rows) + "\n"


class ThePapersLogs(Case):
    def test_ratio_orders_and_silence_at_rest(self):
        found = identified(*PAPER)
        self.assertEqual(found["schema"], "ripplenotch/joint/1")
        self.assertAlmostEqual(found["gear_ratio"]["value"], 100.0, delta=0.2)
        low, high = found["gear_ratio"]["ci95"]
        self.assertLessEqual(low, 100.0)
        self.assertGreaterEqual(high, 100.0)
        self.assertEqual(sorted(line["order"] for line in found["lines"]), [1, 2])
        self.assertTrue(found["verdict"].endswith("No line at rest."), found["verdict"])
        self.assertTrue(found["conclusive"])
        self.assertEqual(len(found["inputs"]), 4)
        for line in found["lines"]:
            self.assertEqual(line["kind"], "order")
            self.assertEqual(len(line["amplitude_by_speed"]), 3)
            for at in line["amplitude_by_speed"]:
                self.assertAlmostEqual(at["hz"], line["order"] * 100 * at["speed_deg_s"] / 360, delta=0.02)

    def test_amplitude_by_speed_and_direction(self):
        found = identified(*PAPER)
        rows = found["amplitude_by_speed_and_direction"]
        self.assertEqual([(row["order"], round(row["speed_deg_s"]), row["direction"]) for row in rows],
                         [(n, speed, 1) for n in (1, 2) for speed in (60, 120, 180)])
        for row in rows:
            low, high = row["ci95_nm"]
            planted = {1: 0.8, 2: 0.5}[row["order"]]  # within three standard errors: one of six is outside two, at times
            self.assertAlmostEqual(row["amplitude_nm"], planted, delta=0.77 * (high - low))
            self.assertGreaterEqual(row["segments"], 6)
            self.assertLess(row["false_alarm"], 1e-6)
        text = run("identify", *PAPER).stdout
        self.assertIn("amplitude by speed and direction", text)
        self.assertEqual(identified(PAPER[0])["amplitude_by_speed_and_direction"], [])

    def test_a_stated_ratio_without_lines_gives_what_would_have_been_found(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "flat.csv"
            log.write_text(log_text(60, 0.0))
            found = identified(str(log), "--gear-ratio", "100")
            self.assertIsNone(found["gear_ratio"]["value"])
            self.assertEqual({row["order"] for row in found["amplitude_by_speed_and_direction"]}, {1, 2})
            self.assertIn("none above", run("identify", log, "--gear-ratio", "100").stdout)

    def test_rest_alone_cannot_tell(self):
        found = identified(PAPER[0])
        self.assertIsNone(found["gear_ratio"]["value"])
        self.assertEqual(found["lines"], [])
        self.assertIn("Cannot tell", found["verdict"])

    def test_the_move_alone(self):
        found = identified(str(DATA / "paper_move_2s.csv"))
        self.assertAlmostEqual(found["gear_ratio"]["value"], 100.0, delta=0.05)
        self.assertEqual(found["evidence"], "order spectrum")

    def test_same_input_same_bytes(self):
        self.assertEqual(run("identify", "--json", *PAPER).stdout, run("identify", "--json", *PAPER).stdout)

    def test_the_file_is_json_and_the_terminal_gets_the_report(self):
        done = ended(0, run("identify", *PAPER, "-o", "joint.json", cwd=self.folder))
        self.assertEqual(done.stderr, "")
        stored = json.loads((self.folder / "joint.json").read_text())
        self.assertEqual(done.stdout.splitlines()[0], stored["verdict"])
        ended(4, run("identify", *PAPER, "-o", "joint.json", cwd=self.folder))
        self.assertEqual(run("design", "joint.json", "-q", cwd=self.folder).returncode, 0)


class Answers(Case):
    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return str(path)

    def test_one_speed_is_not_conclusive_and_exits_5_on_request(self):
        path = self.write("one.csv", log_text(83.0, 0.5))
        self.assertEqual(run("identify", path).returncode, 0)
        done = ended(5, run("identify", path, "--require-conclusive"))
        self.assertIn("ecord another speed to decide", done.stdout)

    def test_the_sentence_is_as_sure_as_the_table(self):
        several, one = identified(*PAPER), identified(str(DATA / "paper_90deg_s.csv"))
        self.assertEqual({line["kind"] for line in several["lines"]}, {"order"})
        self.assertTrue(several["verdict"].startswith("Ripple at orders 1 and 2 of the motor: "))
        self.assertEqual({line["kind"] for line in one["lines"]}, {"unknown"})
        self.assertTrue(one["verdict"].startswith("Lines that may be ripple at orders 1 and 2 of the motor: "))

    def test_no_ripple_is_a_conclusive_answer(self):
        paths = [self.write(f"{v}.csv", log_text(v, 0.0, seed=v)) for v in (40, 80)]
        done = ended(0, run("identify", *paths, "--require-conclusive"))
        self.assertTrue(done.stdout.startswith("No ripple: no line above"), done.stdout)

    def test_a_stated_ratio_is_kept_and_that_the_lines_contradict_it_is_told(self):
        done = run("identify", *PAPER, "--gear-ratio", "130", "--json", "--require-conclusive")
        self.assertEqual(done.returncode, 5, done.stdout)
        found = json.loads(done.stdout)
        self.assertEqual(found["gear_ratio"]["value"], 130)
        self.assertFalse(found["conclusive"])
        self.assertIn("They contradict the stated gear ratio 130: probable are 100.00 (", found["verdict"])
        self.assertEqual([line["order"] for line in found["lines"]], [None, None])

    def test_equal_speeds_in_other_units_give_the_same_ratio(self):
        def in_unit(text, unit, factor):
            rows = text.splitlines()
            out = [f"time_s,velocity_{unit},torque_nm"]
            for row in rows[1:]:
                t, v, x = row.split(",")
                out.append(f"{t},{float(v) * factor!r},{x}")
            return "\n".join(out) + "\n"

        values = []
        for unit, factor in (("deg_s", 1.0), ("rad_s", math.pi / 180), ("rpm", 1 / 6)):
            paths = [self.write(f"{unit}{v}.csv", in_unit(log_text(v, 0.5), unit, factor)) for v in (30, 60)]
            values.append(identified(*paths)["gear_ratio"]["value"])
        self.assertAlmostEqual(values[0], values[1], places=6)
        self.assertAlmostEqual(values[0], values[2], places=6)

    def test_bad_requests_exit_2_and_short_logs_exit_3(self):
        self.assertEqual(run("identify", *PAPER, "--evidence", "magic").returncode, 2)
        self.assertEqual(run("identify", *PAPER, "--gear-ratio", "-3").returncode, 2)
        self.assertEqual(run("identify").returncode, 2)
        ended(3, run("identify", "-", stdin=log_text(60, 0.5, seconds=0.1)), "at least 64")


class Doubts(Case):
    """Logs that a sure answer would be wrong about."""

    def log(self, name, seconds=6.0, rate=500.0, speed=36.0, ripple_nm=0.0, tones=(), clock=1.0, position=True,
            seed=1):
        noise = random.Random(seed)
        rows = ["time_s,velocity_deg_s,torque_nm" + (",position_deg" if position else "")]
        for k in range(int(seconds * rate)):
            t = k / rate
            torque = 5.0 + ripple_nm * math.sin(math.radians(100 * speed * t)) + noise.gauss(0, 0.05)
            torque += sum(nm * math.sin(2 * math.pi * hz * t) for hz, nm in tones)
            rows.append(f"{t / clock:.6f},{speed},{torque:.6f}" + (f",{speed * t:.6f}" if position else ""))
        path = self.folder / name
        path.write_text("\n".join(rows) + "\n")
        return str(path)

    # As a UR5e writes them: current at multiples of about 10 Hz, and stamps that run 1.475 times too fast.
    TONES = [(hz / 1.475, 0.3) for hz in (20.06, 30.0, 40.05, 50.02)]

    def test_a_wrong_clock_comes_first_and_no_order_is_named(self):
        logs = [self.log(f"{v}.csv", speed=v, tones=self.TONES, clock=1.475, seed=v) for v in (36, 48)]
        done = run("identify", *logs, "--require-conclusive", "-q")
        self.assertEqual(done.returncode, 5, done.stdout)
        self.assertTrue(done.stdout.startswith("Cannot tell: "), done.stdout)
        self.assertIn("the position changes 1.475 times as much as velocity and time imply", done.stdout)
        self.assertEqual(run("identify", *logs, "-q").returncode, 0)
        found = identified(*logs)
        self.assertEqual([doubt["reason"] for doubt in found["doubts"]], ["clock", "clock"])
        self.assertIsNone(found["gear_ratio"]["value"])
        self.assertEqual(orders(found, ("order", "unknown")), [])

    def test_two_ratios_that_explain_the_lines_about_as_well(self):
        run("simulate", "--gear-ratio", "80", "--ripple", "2:0.8Nm", "--ripple", "4:0.5Nm", "--motion",
            "constant,speed=40deg/s,duration=5s", "--motion", "constant,speed=70deg/s,duration=5s", "--sample-rate", "1kHz",
            "--noise", "0.05Nm", "-o", "log.csv", cwd=self.folder)
        done = run("identify", "log.csv", "-o", "joint.json", "--require-conclusive", "-q", cwd=self.folder)
        self.assertEqual(done.returncode, 5, done.stdout)
        self.assertRegex(done.stdout, r"The ratio has a probability of 0\.[0-9]+: 160\.[0-9]+ \(0\.[0-9]+\), 80\.[0-9]+ \(0\.[0-9]+\)")
        found = json.loads((self.folder / "joint.json").read_text())
        self.assertEqual([round(one["value"]) for one in found["gear_ratio"]["candidates"][:2]], [160, 80])
        # Where none is more probable than all others together there is no value, and design takes the lines as they are.
        found["gear_ratio"] |= {"value": None, "stderr": None, "ci95": None}
        for one in found["gear_ratio"]["candidates"][:2]:
            one["score"] = 0.4
        (self.folder / "joint.json").write_text(json.dumps(found))
        table = json.loads(run("design", "joint.json", "--json", "-q", cwd=self.folder).stdout)
        self.assertEqual((table["gear_ratio"], [round(order) for order in table["orders"]]), (None, [160, 320]))
        refused = ended(3, run("design", "joint.json", "--orders", "1", "-q", cwd=self.folder), "give --gear-ratio")
        self.assertRegex(refused.stderr, r"identify could not decide between 160\S* or 80")

    def test_a_motor_in_radians_without_a_unit_is_asked_for_its_unit(self):
        noise = random.Random(5)
        rows, angle = ["Time,Position,Velocity,Iq"], 0.0
        for k in range(9000):
            speed = (25.0, 32.0, 40.0)[k // 3000]
            angle += speed / 1000
            current = 0.4 * math.sin(12 * angle) + 0.3 * math.sin(18 * angle) + noise.gauss(0, 0.02)
            rows.append(f"{k / 1000:.3f},{angle:.5f},{speed},{current:.5f}")
        path = self.folder / "motor.csv"
        path.write_text("\n".join(rows) + "\n")
        done = run("identify", str(path), "--require-conclusive", "-q")
        self.assertEqual(done.returncode, 5, done.stdout)
        self.assertTrue(done.stdout.startswith("Cannot tell: if it is deg/s and deg, as assumed, "), done.stdout)
        self.assertIn("Ripple at 12 (0.4 A), 18 (0.3 A) cycles per turn of the motor", done.stdout)
        self.assertIn("--unit velocity=rad/s --side motor settles it", done.stdout)
        found = identified(str(path))
        self.assertEqual([doubt["reason"] for doubt in found["doubts"]], ["unit"])
        self.assertIsNone(found["gear_ratio"]["value"])

    def test_a_unit_that_nobody_states_is_asked_for_by_every_command_about_orders(self):
        rows = ["time,velocity,torque,position"]
        noise = random.Random(3)
        for k in range(6000):
            t = k / 1000
            angle = 150 / 0.9 * (1 - math.cos(0.9 * t))
            torque = 0.8 * math.sin(math.radians(100 * angle)) + 0.5 * math.sin(math.radians(200 * angle)) + noise.gauss(0, 0.05)
            rows.append(f"{t:.3f},{150 * math.sin(0.9 * t):.5f},{torque:.5f},{angle:.5f}")
        path = self.folder / "log.csv"
        path.write_text("\n".join(rows) + "\n")
        asked = "--unit velocity=deg/s,position=deg or --unit velocity=rad/s --side motor settles it"
        done = run("identify", str(path), "--require-conclusive", "-q")
        self.assertEqual(done.returncode, 5, done.stdout)
        self.assertIn(asked, done.stdout)
        spectrum = run("spectrum", str(path), "--domain", "order", "--json", "-q")
        self.assertIn(asked, json.loads(spectrum.stdout)["doubt"])
        self.assertIn(asked, run("features", str(path), "-q").stdout)
        self.assertIn(asked, " ".join(run("recommend", str(path), "-q").stdout.split()))
        # Of other orders nothing says under which reading they are; 1 and 2 of this ratio show in degrees alone.
        track = ["spectrum", str(path), "--track", "--gear-ratio", "100", "--json", "-q"]
        self.assertIn(asked, json.loads(run(*track, "--orders", "3").stdout)["verdict"])
        self.assertNotIn("Cannot tell", json.loads(run(*track, "--orders", "1,2").stdout)["verdict"])
        stated = run("identify", str(path), "--unit", "velocity=deg/s,position=deg", "--require-conclusive", "-q")
        self.assertEqual(stated.returncode, 0, stated.stdout)
        joint = run("identify", str(path), "--unit", "velocity=deg/s,position=deg", "--side", "joint", "--gear-ratio", "1", "-q")
        self.assertNotIn("--gear-ratio settles", joint.stdout)

    def test_speeds_of_a_motor_are_those_of_its_log(self):
        logs = [self.log(f"{v}.csv", speed=v, ripple_nm=0.0, tones=[(2 * v / 360, 0.4)], seed=v) for v in (2400, 3600)]
        found = identified(*logs, "--side", "motor")
        fastest = max(line["speed_range_deg_s"][1] for line in found["lines"])
        self.assertAlmostEqual(fastest, 3600, delta=1)

    def test_mains_have_one_frequency(self):
        logs = [self.log(f"{v}.csv", speed=v, tones=[(50, 0.3), (100, 0.3), (180, 0.2)], seed=v) for v in (36, 47)]
        notes = " ".join(line["note"] for line in identified(*logs)["lines"])
        self.assertIn("mains 50 Hz", notes)
        self.assertIn("2 times mains 50 Hz", notes)
        self.assertNotIn("mains 60 Hz", notes)

    def test_the_family_without_the_position(self):
        logs = [self.log(f"{v}.csv", speed=v, tones=self.TONES, clock=1.475, position=False, seed=v)
                for v in (36, 48)]
        found = identified(*logs)
        # Of one size at 30 Hz, and at 40 Hz at a speed higher by a third: an order there would leave the 30 Hz of one log and the 40 Hz of
        # the other to two tones, which explain all four.
        self.assertEqual(orders(found), [])
        self.assertIsNone(found["gear_ratio"]["value"])
        self.assertEqual(sorted(round(line["hz"], -1) for line in found["lines"]), [20, 30, 40, 50])

    def test_a_joint_that_wears_is_told_log_by_log(self):
        wear = (0.38, 0.52, 0.74, 0.96)
        logs = [self.log(f"{i}_{v}.csv", speed=v, ripple_nm=nm, seed=10 * i + v)
                for i, nm in enumerate(wear) for v in (40, 70)]
        done = run("identify", *logs, "-q")
        self.assertIn("The recordings disagree", done.stdout.splitlines()[0])
        self.assertIn("0_40.csv", done.stdout)
        one = identified(*logs)["disagreements"][0]
        self.assertEqual(one["about"], "amplitude")
        values = [value["value"] for value in one["values"]]
        self.assertEqual(len(values), len(wear))
        for value, nm in zip(values, wear):
            self.assertAlmostEqual(value, nm, delta=0.05 * nm)


class FixedTones(Case):
    """The shortest sweep of this motion has 2.7 cycles of the first order, which its smooth part takes some of."""

    def found_of(self, *more):
        log = str(self.folder / "log.csv")
        ended(0, run("simulate", "--gear-ratio", "100", "--inertia", "0.992kgm2", "--ripple", "1:0.8Nm:30deg", "--ripple",
                     "2:0.5Nm", "--motion", "multisine,amplitude=60deg,frequency=0.2Hz,duration=20s", "--sample-rate", "1kHz",
                     "--noise", "0.05Nm", *more, "-o", log, "--force"))
        return identified(log)

    def test_ripple_where_the_speed_has_an_extremum_is_no_tone_and_a_tone_is_one(self):
        for seed in ("1", "2", "3"):
            found = self.found_of("--seed", seed)
            self.assertEqual([line["order"] for line in found["lines"]], [1, 2], found["verdict"])
            tone = "tone,frequency_hz=31.7,amplitude_nm=0.05,phase_deg=0"
            both = self.found_of("--seed", seed, "--effect", tone)
            self.assertEqual([line["kind"] for line in both["lines"]], ["order", "order", "tone"], both["verdict"])
            self.assertAlmostEqual(both["lines"][2]["hz"], 31.7, delta=0.1)


class Spectra(unittest.TestCase):
    def test_a_pipe_ends_in_json_with_peaks_floor_window_and_resolution(self):
        done = ended(0, run("spectrum", "-", "--json", stdin=log_text(72.0, 0.5)))
        found = json.loads(done.stdout)
        self.assertEqual((found["window"], found["domain"]), ("hann", "frequency"))
        one = found["spectra"][0]
        self.assertAlmostEqual(one["peaks"][0]["hz"], 20.0, delta=0.01)
        self.assertAlmostEqual(one["peaks"][0]["amplitude_nm"], 0.5, delta=0.01)
        self.assertAlmostEqual(one["resolution_hz"], 1.5 / 4.0, delta=1e-6)
        self.assertGreater(one["noise_floor_nm"], 0.0)

    def test_csv_has_one_row_a_bin(self):
        rows = run("spectrum", "-", "--bins", stdin=log_text(72.0, 0.5)).stdout.splitlines()
        self.assertEqual(rows[0], "frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm")
        self.assertEqual(len(rows), 1 + 1001)
        strongest = max(rows[1:], key=lambda row: float(row.split(",")[1]))
        self.assertAlmostEqual(float(strongest.split(",")[0]), 20.0, delta=0.26)

    def test_the_lines_are_printed_and_the_bins_where_they_are_asked_for(self):
        log = str(DATA / "paper_90deg_s.csv")
        with tempfile.TemporaryDirectory() as folder:
            for words in ([], ["--domain", "order"], ["--segment", "1s"]):
                with self.subTest(words):
                    text = run("spectrum", log, *words).stdout
                    self.assertRegex(text, r"(?m)^2 lines in .*resolution .*, floor ")
                    self.assertRegex(text, r"SNR\n")
                    bins = run("spectrum", log, *words, "--bins").stdout
                    self.assertRegex(bins.splitlines()[0], r"^[a-z0-9_]+(,[a-z0-9_]+)+$")
                    for name, written in (("a.csv", bins), ("a.txt", text)):
                        self.assertEqual(run("spectrum", log, *words, "-o", f"{folder}/{name}", "--force").returncode, 0)
                        self.assertEqual(pathlib.Path(folder, name).read_text(), written)
        for words in (["--json"], ["--map", "campbell"], ["--track", "--gear-ratio", "100"]):
            done = run("spectrum", log, "--bins", *words)
            self.assertEqual((done.returncode, done.stdout), (2, ""), words)
            self.assertIn("--bins", done.stderr)

    def test_orders_of_a_move(self):
        found = json.loads(run("spectrum", str(DATA / "paper_move_2s.csv"), "--domain", "order", "--json").stdout)
        self.assertEqual([round(line["order_output"]) for line in found["lines"]], [100, 200])
        ended(3, run("spectrum", str(DATA / "paper_rest.csv"), "--domain", "order"), "nowhere moves")


class AnyTravelAnyRatio(Case):
    """Lines from four cycles per sweep, or once per output turn, on, and a bound for what was searched."""

    def simulated(self, ratio, *motions, rate="1kHz", ripple=("1:0.8Nm:30deg", "2:0.5Nm"), noise="0.05Nm", seed=1):
        words = [word for motion in motions for word in ("--motion", motion)] + [word for one in ripple for word in ("--ripple", one)]
        path = str(self.folder / "log.csv")
        ended(0, run("simulate", "--gear-ratio", str(ratio), *words, "--sample-rate", rate, "--noise", noise, "--seed", str(seed), "-o", path, "--force"))
        return path

    def to_and_fro(self, degrees, seconds, times=5):
        return [f"poly6,to={angle}deg,duration={seconds}s" for _ in range(times) for angle in (degrees, 0)]

    def test_low_ratios_over_short_travel(self):
        for ratio, travel in ((30, 60), (50, 60), (40, 115), (100, 38)):
            found = identified(self.simulated(ratio, *self.to_and_fro(travel, travel / 30)))
            lines = {round(line["order_output"] / ratio): line["amplitude_nm"] for line in found["lines"] if line["order_output"]}
            self.assertAlmostEqual(lines.get(1, 0.0), 0.8, delta=0.05, msg=(ratio, travel, found["verdict"]))
            self.assertAlmostEqual(lines.get(2, 0.0), 0.5, delta=0.05, msg=(ratio, travel, found["verdict"]))

    def test_ratios_below_twenty(self):
        for ratio in (6, 9, 16):
            found = identified(self.simulated(ratio, "constant,speed=300deg/s,duration=4s", "constant,speed=200deg/s,duration=4s",
                                              "constant,speed=100deg/s,duration=6s"))
            seen = sorted(line["order_output"] for line in found["lines"] if line["kind"] == "order")
            self.assertEqual(len(seen), 2, found["verdict"])
            self.assertAlmostEqual(seen[0], ratio, delta=0.05)
            self.assertAlmostEqual(seen[1], 2 * ratio, delta=0.05)
            value = found["gear_ratio"]["value"]
            self.assertTrue(value is None or abs(value - ratio) < 0.05, found["verdict"])
            self.assertTrue(value is not None or not found["conclusive"])

    def test_a_bound_names_its_range_and_holds_there(self):
        motions = self.to_and_fro(200, 1.0, 10)
        found = identified(self.simulated(100, *motions, rate="154Hz", ripple=(), noise="0.1Nm"))
        self.assertEqual((found["finding"], found["lines"]), ("nothing", []))
        searched = found["searched"]
        # 154 rows a sweep, 20 sweeps: least squares of one amplitude has a standard error of 0.1 Nm sqrt(2 / 3080).
        self.assertGreater(searched["detectable_nm"], 3 * 0.1 * math.sqrt(2 / 3080))
        self.assertLess(searched["detectable_nm"], 0.1)
        self.assertLess(searched["lowest_order"], searched["highest_order"])
        self.assertIn(f"to {searched['highest_order']:.4g} cycles per output turn", found["verdict"])
        self.assertEqual([bound["detectable_nm"] for bound in searched["bounds"]],
                         sorted((bound["detectable_nm"] for bound in searched["bounds"]), reverse=True))
        middle = math.sqrt(searched["lowest_order"] * searched["highest_order"])
        path = self.simulated(middle, *motions, rate="154Hz", ripple=(f"1:{2 * searched['detectable_nm']:.4g}Nm",), noise="0.1Nm")
        lines = [line["order_output"] for line in identified(path)["lines"] if line["kind"] in ("order", "unknown")]
        self.assertTrue(any(abs(order - middle) < 2.0 for order in lines), lines)

    def test_a_bound_above_the_noise_itself_is_no_claim(self):
        path = self.simulated(100, *self.to_and_fro(200, 1.0, times=2), rate="77Hz", ripple=(), noise="0.1Nm")
        done = run("identify", path, "--json", "--require-conclusive")
        self.assertEqual(done.returncode, 5, done.stdout)
        found = json.loads(done.stdout)
        self.assertEqual((found["finding"], found["conclusive"], found["lines"]), ("too noisy", False, []))
        self.assertRegex(found["verdict"], r"^Cannot tell: too noisy or too short: a line of 0\.\d+ Nm at .* would be missed")

    def test_a_joint_that_hardly_moves_allows_no_claim(self):
        found = identified(self.simulated(100, "poly6,to=2deg,duration=1s", ripple=()))
        self.assertIsNone(found["searched"])
        self.assertFalse(found["conclusive"])
        self.assertTrue(found["verdict"].startswith("Cannot tell"), found["verdict"])


@unittest.skipUnless((LOGS / "README.md").is_file(), "the real logs are not here")
class RealLogs(unittest.TestCase):
    def near(self, values, expected, share):
        self.assertTrue(any(abs(v - expected) <= share * expected for v in values), f"{expected} not in {values}")

    def test_panda(self):
        for name, expected in (("panda_gaz_j1", (120, 240)), ("panda_gaz_j4", (240, 480))):
            found = identified(str(LOGS / "gpl3" / f"{name}.csv"))
            for order in expected:
                self.near(orders(found), order, 0.01)
            ratio = found["gear_ratio"]
            if ratio["value"] is None:
                self.assertIn("cannot tell which of", found["verdict"])
                self.assertFalse(found["conclusive"])
            else:
                self.assertAlmostEqual(ratio["value"], 120.0, delta=1.2)
            self.near([one["value"] for one in ratio["candidates"]], 120.0, 0.01)

    def test_panda_clock_makes_no_lines_of_the_slow_torque(self):
        # The model's torque is smooth; read at the log's stumbling stamps it showed 0.81 Nm at 59.7 Hz.
        log = str(LOGS / "gpl3" / "panda_gaz_all.csv")
        done = ended(0, run("spectrum", log, "--bins", "--columns", "time=time_s,velocity=panda_joint2_velocity_rad_s,torque=panda_joint2_model_torque_Nm"))
        for row in done.stdout.splitlines()[1:]:
            hz, amplitude = map(float, row.split(",")[:2])
            if 59.0 < hz < 61.0:
                self.assertLess(amplitude, 0.1)

    def test_lara_says_that_one_speed_dominates(self):
        """One sweep, in which torque of the motion is all around the line of 0.6 Nm: an order or a tone, or a bound above it."""
        found = identified(str(LOGS / "neura_lara8_j3.csv"))
        self.assertEqual(orders(found), [])
        if orders(found, ("unknown",)):
            self.assertIn("Only one speed", found["verdict"])
            self.assertFalse(found["conclusive"])
        else:
            searched = found["searched"]
            self.assertTrue(searched["detectable_nm"] > 0.6 or searched["lowest_order"] > 202, searched)

    def test_kuka_ratios_by_either_hint_in_each_log_and_in_both_together(self):
        logs = [str(LOGS / f"kuka_kr300_traj{name}_all.csv") for name in "AB"]
        for joint, ratio in (("j4", 221.0), ("j5", 239.62), ("j6", 154.32)):
            for words in ([logs[0]], [logs[1]], logs):
                for hint in (("--gear-ratio", str(ratio)), ("--order-hint", "8")):
                    found = identified(*words, "--joint", joint, *hint)
                    self.assertIsNotNone(found["gear_ratio"]["value"], (joint, words, hint))
                    self.assertAlmostEqual(found["gear_ratio"]["value"], ratio, delta=0.003 * ratio)
                    self.assertIn(8, [line["order"] for line in found["lines"]])

    def test_short_ur3e_log_and_its_folded_order(self):
        log = str(LOGS / "ur3e_rad_L1L2_j345.csv")
        # Lines of 0.05 to 0.03 Nm in a single sweep of 65 rows: found, or below what would have been found.
        for joint, order, amplitude_nm in (("j3", 201.0, 0.051), ("j4", 201.0, 0.042), ("j5", 49.5, 0.03)):
            found = identified(log, "--joint", joint)
            if found["lines"]:
                self.near(orders(found, ("order", "unknown")), order, 0.02)
            else:
                self.assertGreater(found["searched"]["detectable_nm"], amplitude_nm)

    def test_ur10_has_nothing_on_any_joint(self):
        found = identified(str(LOGS / "ur10_unisa_exciting_all.csv"), "--joint", "all")
        self.assertEqual(found["schema"], "ripplenotch/joints/1")
        self.assertEqual(len(found["joints"]), 6)
        for joint in found["joints"]:
            self.assertEqual(orders(joint), [], joint["joint"])
            self.assertTrue(joint["verdict"].startswith("No ripple"), joint["verdict"])

    def test_kuka_lines_at_eight_per_motor_turn(self):
        # The ratios are documented by the source of the logs; the lines stand at 8 times them on every joint.
        ratios = {"j1": 1798 / 7, "j2": 1872 / 7, "j3": 757 / 3, "j4": 221.0, "j5": 5032 / 21, "j6": 206793 / 1340}
        for log in ("kuka_kr300_trajA_all", "kuka_kr300_trajB_all"):
            for joint in identified(str(LOGS / f"{log}.csv"), "--joint", "all")["joints"]:
                self.near(orders(joint), 8 * ratios[joint["joint"]], 0.003)
        hinted = identified(str(LOGS / "kuka_kr300_trajB_all.csv"), "--joint", "j4", "--gear-ratio", "221")
        self.assertAlmostEqual(hinted["gear_ratio"]["value"], 221.0, delta=0.003 * 221)
        self.assertIn(8, [line["order"] for line in hinted["lines"]])
