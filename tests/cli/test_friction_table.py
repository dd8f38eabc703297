# SPDX-License-Identifier: MIT
"""ripplenotch diagnose of a table of constant speeds and friction torques: values, intervals, refusals."""

import json
import math
import os
import random

from commands import Case, ended

TRUTH = {"coulomb": 0.6, "viscous": 0.01, "stribeck": 0.4, "speed": 8.0}
SPEEDS = [0.5, 1, 2, 3, 5, 8, 12, 18, 25, 40, 60, 90]


def friction(v, difference=0.0, stribeck=0.0, viscous_difference=0.0):
    size = TRUTH["coulomb"] + TRUTH["viscous"] * abs(v) + stribeck * math.exp(-(v / TRUTH["speed"]) ** 2)
    return math.copysign(size, v) + 0.5 * difference + 0.5 * viscous_difference * abs(v)


def table(speeds, chance, noise=0.01, **hidden):
    rows = "".join(f"{v:g},{friction(v, **hidden) + chance.gauss(0.0, noise):.5f}\n" for v in speeds)
    return "velocity_deg_s,torque_nm\n" + rows


def both_ways(speeds):
    return [-v for v in reversed(speeds)] + list(speeds)


class FrictionTable(Case):
    def table(self, text, *words, name="table.csv"):
        (self.folder / name).write_text(text)
        return self.run_tool("diagnose", name, *words)

    def found(self, text, *words):
        done = self.table(text, "--json", *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return json.loads(done.stdout)

    def parameters(self, found):
        return {(term["effect"], name): value for term in found["terms"] for name, value in term["parameters"].items()}

    def test_coulomb_viscous_stribeck_and_asymmetry_are_fitted_with_intervals_and_written_as_a_model(self):
        text = table(both_ways(SPEEDS), random.Random(5), difference=0.1, stribeck=TRUTH["stribeck"])
        found = self.found(text, "--improved-model", "model.json")
        self.assertEqual(found["schema"], "ripplenotch/friction-table/1")
        values = self.parameters(found)
        for key, truth in ((("coulomb-friction", "torque_nm"), 0.6), (("viscous-friction", "coefficient_nm_per_deg_s"), 0.01),
                           (("stribeck-friction", "torque_nm"), 0.4), (("stribeck-friction", "stribeck_speed_deg_s"), 8.0),
                           (("asymmetric-friction", "difference_nm"), 0.1)):
            low, high = values[key]["ci95"]
            self.assertLess(low, high)
            self.assertLess(abs(values[key]["value"] - truth), high - low, key)
        self.assertLess(found["noise_nm"], 0.02)
        self.assertEqual(found["ambiguous"][0]["effects"], ["asymmetric-friction", "offset"])
        model = json.loads((self.folder / "model.json").read_text())
        self.assertEqual(model["gear_ratio"], "unknown")
        ended(0, self.run_tool("simulate", "--model", "model.json", "--motion", "poly6,to=50deg,duration=2s", "--sample-rate",
                               "100Hz", "-o", "log.csv"))

    def test_viscous_friction_that_differs_by_direction_is_found_with_and_without_a_difference_of_the_level(self):
        key = ("asymmetric-viscous-friction", "difference_nm_per_deg_s")
        for seed in range(1, 4):
            for viscous_difference, difference in ((0.003, 0.0), (-0.003, 0.0), (0.003, -0.1), (0.0, 0.1), (0.0, 0.0)):
                with self.subTest(seed=seed, viscous_difference=viscous_difference, difference=difference):
                    found = self.found(table(both_ways(SPEEDS), random.Random(seed), difference=difference,
                                             viscous_difference=viscous_difference))
                    names = [term["effect"] for term in found["terms"]]
                    hidden = {"coulomb-friction", "viscous-friction"}
                    hidden |= {"asymmetric-viscous-friction"} if viscous_difference else set()
                    hidden |= {"asymmetric-friction"} if difference else set()
                    self.assertEqual(set(names), hidden)
                    if viscous_difference:
                        value = self.parameters(found)[key]
                        low, high = value["ci95"]
                        self.assertLess(abs(value["value"] - viscous_difference), high - low)

    def test_intervals_hold_the_truth_as_often_as_they_say(self):
        # RIPPLENOTCH_TABLES=500 RIPPLENOTCH_FIRST_TABLE=9000 is the study of docs/studies/friction-table.md.
        tables, first = int(os.environ.get("RIPPLENOTCH_TABLES", "60")), int(os.environ.get("RIPPLENOTCH_FIRST_TABLE", "1"))
        truth = {("coulomb-friction", "torque_nm"): 0.6, ("viscous-friction", "coefficient_nm_per_deg_s"): 0.01,
                 ("stribeck-friction", "torque_nm"): 0.4, ("stribeck-friction", "stribeck_speed_deg_s"): 8.0,
                 ("asymmetric-friction", "difference_nm"): 0.1}
        hits = dict.fromkeys(truth, 0)
        for seed in range(first, first + tables):
            values = self.parameters(self.found(table(both_ways(SPEEDS), random.Random(seed), 0.02, difference=0.1, stribeck=0.4)))
            for key, value in truth.items():
                low, high = values[key]["ci95"]
                hits[key] += low <= value <= high
        if tables > 60:
            print({f"{effect} {name}": f"{100 * hits[effect, name] / tables:.1f} %" for effect, name in hits})
        # Five standard deviations of chance below 95 %.
        least = 0.95 * tables - 5.0 * math.sqrt(0.95 * 0.05 * tables)
        for key, count in hits.items():
            self.assertGreater(count, least, key)
