# SPDX-License-Identifier: MIT
"""The generator and the tool's catalogue are two programs; each draws every effect of the other."""

import dataclasses
import json
import subprocess
import unittest

import prove  # first: it skips without numpy
import numpy as np
from prove_diagnose import cases, joint, motion, sensor
from prove_diagnose.physics import rough


class Agreement(unittest.TestCase):
    def test_every_effect_of_the_catalogue_is_drawn(self):
        listed = subprocess.run([prove.TOOL, "diagnose", "--effects", "--json"], capture_output=True, check=True, timeout=60).stdout
        names = {effect["effect"] for effect in json.loads(listed)["effects"]}
        rng = np.random.default_rng(1)
        always = {effect["effect"] for effect in joint.base_joint(rng)}
        with_simulation = {"simulation-scale"}  # nothing without a simulation, which these logs do not have
        drawn = {joint.draw(rng, label)["effect"] for label in (*joint.HIDDEN, *joint.FURTHER, *joint.RARER)}
        self.assertEqual(names - drawn - always - with_simulation, set(), "formula and strength are missing: scripts/prove_diagnose/joint.py")
        self.assertEqual((drawn | always) - names, set(), "drawn by scripts/prove_diagnose/joint.py, and no effect")


class Motion(unittest.TestCase):
    def test_speed_and_acceleration_are_the_derivatives_of_the_angle(self):
        travel = motion.rich(np.random.default_rng(1), 10.0, 40.0)
        time = np.linspace(0.0, travel.duration_s, 40001)[1:-1]
        (before, v0, _), (q, v, a), (after, v1, _) = (travel.at(time + d) for d in (-1e-5, 0.0, 1e-5))
        self.assertLess(np.max(np.abs((after - before) / 2e-5 - v)), 0.02)
        self.assertLess(np.median(np.abs((v1 - v0) / 2e-5 - a)), 1e-3)

    def test_a_rich_motion_passes_25_and_178_deg_s_both_ways_and_takes_40_s(self):
        for seed in range(20):
            travel = motion.rich(np.random.default_rng(seed), 0.0, 40.0)
            speeds = travel.at(np.arange(40000) / 1000.0)[1]
            self.assertAlmostEqual(travel.duration_s, 40.0, delta=1.0)
            for speed in (-178.0, -25.0, 25.0, 178.0):
                self.assertGreater(np.sum(np.abs(speeds - speed) < 1e-6), 900, (seed, speed))


class RoughLogs(unittest.TestCase):
    def test_stamps_jitter_and_rows_are_lost_in_about_half_of_the_logs_and_time_never_runs_back(self):
        count, rate = 4000, 500
        clean = {"time_s": np.arange(count) / rate, "velocity_deg_s": np.where(np.arange(count) < 2000, 0.0, 30.0)}
        jittered, lost, rises = 0, 0, []
        for seed in range(40):
            log = rough.recorded(np.random.default_rng(seed), clean, rate)
            steps = np.diff(log["time_s"])
            self.assertGreater(np.min(steps), 0.0)
            jittered += np.std(np.mod(log["time_s"] * rate + 0.5, 1.0)) > 1e-3
            lost += len(log["time_s"]) < 0.995 * count
            rises.append(np.max(np.diff(log["velocity_deg_s"])))
        self.assertTrue(10 < jittered < 30 and 10 < lost < 30, (jittered, lost))
        self.assertLess(np.max(rises), 30.0 * (1 - np.exp(-2 * np.pi * 300.0 * 6 / rate)), "the velocity is not filtered")


class Sensor(unittest.TestCase):
    def test_noise_has_the_rms_and_the_memory_that_it_is_named_for(self):
        for kind, memory in (("white", 0.0), ("ar0.5", 0.5), ("ar0.9", 0.9), ("ar0.98", 0.98), ("t4", 0.0)):
            values = sensor.noise(np.random.default_rng(3), kind, 200000, 0.06)
            self.assertAlmostEqual(np.std(values), 0.06, delta=0.002)
            self.assertAlmostEqual(np.mean(values[1:] * values[:-1]) / np.var(values), memory, delta=0.02)

    def test_pink_noise_has_the_same_power_in_each_octave(self):
        powers = np.zeros(10)
        for seed in range(20):
            values = sensor.noise(np.random.default_rng(seed), "pink", 40000, 0.06)
            self.assertLess(abs(np.std(values) - 0.06), 0.03)
            spectrum = np.abs(np.fft.rfft(values * np.hanning(len(values)))) ** 2
            powers += [np.sum(spectrum[16 * 2**k : 32 * 2**k]) for k in range(10)]
        self.assertLess(np.max(powers) / np.min(powers), 1.3)

    def test_a_mixture_has_heavier_tails_and_more_memory_than_white_noise(self):
        memory, tails = [], []
        for seed in range(40):
            values = sensor.noise(np.random.default_rng(seed), "mixture", 20000, 0.06)
            self.assertAlmostEqual(np.std(values), 0.06, delta=0.03)
            memory.append(np.mean(values[1:] * values[:-1]) / np.var(values))
            tails.append(np.mean((values - values.mean()) ** 4) / np.var(values) ** 2)
        self.assertGreater(np.median(memory), 0.2)
        self.assertGreater(np.mean(tails), 3.1)

    def test_a_case_is_the_same_log_every_time_and_another_for_each_purpose(self):
        case = cases.studies("pair", 1)[0]
        first, again, other = case.log("train"), case.log("train"), case.log("validate")
        self.assertTrue(np.array_equal(first.torque_nm, again.torque_nm))
        self.assertFalse(np.array_equal(first.torque_nm[:1000], other.torque_nm[:1000]))

    def test_every_effect_that_can_be_drawn_changes_the_log(self):
        for study in ("single", "rarer"):
            for case in cases.studies(study, 1):
                log, plain = case.log("train"), dataclasses.replace(case, hidden=()).log("train")
                changed = [np.max(np.abs(a - b)) for a, b in ((log.torque_nm, plain.torque_nm),
                                                              (log.velocity_deg_s, plain.velocity_deg_s))]
                self.assertGreater(max(changed), 0.015, case.label)

    def test_a_lag_delays_a_slow_torque_by_its_time_constant(self):
        time = np.arange(80000) / 8000.0
        slow = joint.first_order(np.sin(time), 1.0 / 8000.0, 0.01)
        self.assertAlmostEqual(float(slow[40000]), float(np.sin(5.0 - 0.01)), delta=1e-4)
