# SPDX-License-Identifier: MIT
"""One answer to how large the ripple is: identify, features, recommend, track and spectrum agree on lines and amplitudes."""

import json
import math
import unittest

from commands import DATA, LOGS, ended
from test_one_gear import Case

CASES = LOGS.parent / "cases"
# Where identify names no gear, the law is asked at these ratios: of data sheets, or as the logs were simulated.
REAL = [("gpl3/panda_gaz_all.csv", f"panda_joint{j}", ratio) for j, ratio in zip(range(1, 7), (120, 120, 120, 120, 80, 80))]
REAL += [("kuka_kr300_trajA_all.csv", f"j{j}", ratio)
         for j, ratio in zip(range(1, 7), (256.857, 267.429, 252.333, 221, 239.619, 154.323))]
REAL += [("ur10_unisa_exciting_all.csv", joint, 101) for joint in ("shoulder_pan_joint", "elbow_joint", "wrist_1_joint")]
REAL += [("neura_lara8_j3.csv", None, 101)]
SIMULATED = [("st_kg30_travel60.csv.gz", None, 30), ("st_kg50_travel60.csv.gz", None, 50), ("kg6.csv.gz", None, 6),
             ("kg16.csv.gz", None, 16)]
ONE_LINE = 1.5 / 8.0  # motor orders: resolution of the estimate, within which lines of identify are one


def bound_at(searched, order_output):
    """What identify would have found at an order of its range."""
    return [bound["detectable_nm"] for bound in searched["bounds"] if bound["from_order"] <= order_output][-1]


class Law(Case):
    def told(self, *words):
        done = ended(0, self.run_tool(*words))
        return json.loads(done.stdout.splitlines()[0] if words[0] == "features" else done.stdout)

    def lines_of(self, result, ratio, order):
        """Amplitude at a motor order and its error: of all lines that the resolution of the estimate does not separate."""
        near = [line for line in result["lines"] if line.get("order_output") and
                abs(line["order_output"] / ratio - order) < ONE_LINE]
        return (math.hypot(*(line["amplitude_nm"] for line in near)),
                math.hypot(*(line["amplitude_nm"] / line["snr"] for line in near)))

    def feature(self, features, order, what):
        """ripple_N_what of the order N, which lines of the second comb have with decimals."""
        named = {key: float(key.split("_")[1]) for key in features if key.startswith("ripple_") and key.endswith("_" + what)}
        return features[min(named, key=lambda key: abs(named[key] - order))]

    def agree(self, a, b, what, share=0.05):
        self.assertLessEqual(abs(a[0] - b[0]), max(3.0 * math.hypot(a[1], b[1]), share * max(a[0], b[0])), what)

    def check(self, path, joint, ratio):
        where = [path, *([] if joint is None else ["--joint", joint])]
        found = self.told("identify", *where, "--gear-ratio", ratio, "--json")
        gear = found["gear"] or {"ratio": ratio, "orders": [1, 2]}
        ratio, orders = gear["ratio"], gear["orders"][:6]
        stated = ["--gear-ratio", ratio, "--orders", ",".join(map(str, orders))]
        features = self.told("features", *where, *stated)
        recommended = {one["order"]: one for one in self.told("recommend", *where, *stated, "--json")["orders"]}
        ripple = self.tracked(where, stated)
        spectrum = self.run_tool("spectrum", *where, "--domain", "order", "--json")
        spectrum = json.loads(spectrum.stdout) if spectrum.returncode == 0 else None
        for order in orders:
            one = recommended[order]
            value = self.feature(features, order, "amplitude_nm")
            self.assertEqual(value is not None, bool(one["present"]), order)
            if not one["cycles"]:
                continue  # nobody can say
            if order in ripple:
                self.agree((ripple[order]["amplitude_nm"], ripple[order]["standard_error_nm"]),
                           (one["amplitude_nm"], one["standard_error_nm"]), f"track, order {order}")
                self.assertEqual(ripple[order]["present"], one["present"])
            if value is not None:
                low, high = self.feature(features, order, "amplitude_ci95_nm")
                self.agree((value, (high - low) / 3.92), (one["amplitude_nm"], one["standard_error_nm"]), f"features, order {order}")
            searched = found["searched"]
            if searched is None or not searched["lowest_order"] <= order * ratio <= searched["highest_order"]:
                continue
            for command, result in ("identify", found), ("spectrum", spectrum):
                line = self.lines_of(result, ratio, order)
                if line[0] - 3.0 * line[1] > one["detectable_nm"]:  # as sure as agree() asks
                    self.assertTrue(one["present"], f"{command} names order {order}")
                if line[0] > 0.0 and one["present"]:
                    self.agree(line, (one["amplitude_nm"], one["standard_error_nm"]), f"{command}, order {order}",
                               0.01 if command == "identify" else 0.05)
                if found["finding"] == "nothing":
                    least = one["amplitude_nm"] - 3 * one["standard_error_nm"] if one["present"] else 0.0
                    self.assertLess(least, bound_at(searched, order * ratio), f"identify says that there is none at order {order}")

    def test_a_map_has_the_same_ripple_as_the_estimate(self):
        """Its windows are shorter: half a per cent of another size is theirs; constant amplitudes, so that no weights count."""
        joint = ["--gear-ratio", 100, "--ripple", "1:0.3Nm:30deg", "--ripple", "2:0.8Nm", "--effect", "gravity,amplitude_nm=8,phase_deg=20", "--noise", "0.1Nm"]
        logs = sorted(DATA.glob("paper_*deg_s.csv"))
        for seed, motion in enumerate(("constant,speed=60deg/s,duration=8s", "multisine,frequency=0.15Hz,amplitude=60deg,duration=8s")):
            logs.append(self.folder / f"{seed}.csv")
            ended(0, self.run_tool("simulate", *joint, "--motion", motion, "--sample-rate", "1kHz", "--seed", 1100 + seed, "-o", logs[-1]))
        for log in logs:
            with self.subTest(log=log.name):
                stated = ["--gear-ratio", 100, "--orders", "1,2"]
                features = self.told("features", log, *stated)
                result = self.told("map", log, *stated, "--json")
                for one in result["left_out"]:
                    low, high = self.feature(features, one["order"], "amplitude_ci95_nm")
                    ripple = math.sqrt(one["ripple_nm"] ** 2 - one["noise_nm"] ** 2)
                    self.agree((self.feature(features, one["order"], "amplitude_nm"), (high - low) / 3.92),
                               (ripple, one["noise_nm"] / math.sqrt(result["windows"])), f"order {one['order']}", 0.005)

    def test_at_one_speed_a_line_of_a_frequency_is_as_large_as_its_order(self):
        for log in sorted(DATA.glob("paper_*deg_s.csv")):
            features = self.told("features", log, "--gear-ratio", 100, "--orders", "1,2")
            speed = float(log.name.split("_")[1].removesuffix("deg"))
            for segment in (), ("--segment", "1s"):
                peaks = self.told("spectrum", log, *segment, "--json")["spectra"][0]["peaks"]
                for order in 1, 2:
                    with self.subTest(log=log.name, segment=segment, order=order):
                        peak = min(peaks, key=lambda peak: abs(peak["hz"] - order * 100 * speed / 360))
                        low, high = self.feature(features, order, "amplitude_ci95_nm")
                        self.agree((self.feature(features, order, "amplitude_nm"), (high - low) / 3.92),
                                   (peak["amplitude_nm"], peak["floor_nm"] / math.sqrt(2)), f"{log.name}, order {order}", 0.005)

    def tracked(self, where, stated):
        done = self.run_tool("spectrum", "--track", *where, *stated, "--json")
        if done.returncode == 3:  # no row could be measured
            return {}
        self.assertEqual(done.returncode, 0, done.stderr)
        ripple = {}
        for line in json.loads(done.stdout)["lines"]:
            one = ripple[line["order"]] = line["ripple"]
            if one["present"]:
                self.assertLessEqual(line["least_nm"], 1.05 * one["amplitude_nm"])
                self.assertGreaterEqual(line["greatest_nm"], 0.95 * one["amplitude_nm"])
        return ripple

    def check_all(self, folder, logs):
        for name, joint, ratio in logs:
            with self.subTest(log=name, joint=joint):
                self.check(folder / name, joint, ratio)

    def test_on_the_logs_of_the_project(self):
        self.check_all(DATA, [(path.name, None, 100) for path in sorted(DATA.glob("paper_*.csv"))])

    @unittest.skipUnless(LOGS.is_dir(), "no logs of real robots here (RIPPLENOTCH_LOGS)")
    def test_on_logs_of_real_robots(self):
        self.check_all(LOGS, REAL)

    @unittest.skipUnless(CASES.is_dir(), "no cases beside the logs of real robots (RIPPLENOTCH_LOGS)")
    def test_on_short_travel_and_low_ratios(self):
        self.check_all(CASES, SIMULATED)
