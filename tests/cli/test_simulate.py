# SPDX-License-Identifier: MIT
"""simulate: the logs of data/ byte for byte, and noise that is correlated."""

import csv
import math
import os
import subprocess
import unittest

from commands import DATA, SOURCE, TOOL, Case, ended, run


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


class Noise(unittest.TestCase):
    def test_correlated_noise_has_its_rms_and_its_correlation(self):
        long = ["--gear-ratio", "1", "--motion", "rest,duration=40s", "--sample-rate", "1kHz", "--noise", "50mNm"]
        values = column(simulate(*long, "--noise-correlation", "0.9"), "torque_nm")
        power = sum(x * x for x in values) / len(values)
        # 40000 values of correlation 0.9 are worth about 2100 independent ones.
        self.assertAlmostEqual(math.sqrt(power) / 0.05, 1.0, delta=0.06)
        self.assertAlmostEqual(sum(a * b for a, b in zip(values, values[1:])) / len(values) / power, 0.9, delta=0.01)
        self.assertEqual(simulate(*long, "--noise-correlation", "0").stdout, simulate(*long).stdout)
