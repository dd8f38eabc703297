# SPDX-License-Identifier: MIT
"""The ripple of one joint's motor in the torque of another joint."""

import itertools
import json
import math

import commands
from arm_log import write_arm_log
from commands import ended, run


def rows(path, joint):
    """Time, position of each joint and torque of one."""
    head, *lines = path.read_text().splitlines()
    names = head.split(",")
    table = [dict(zip(names, map(float, line.split(",")))) for line in lines]
    return table, [row[f"{joint}_torque_nm"] for row in table]


def amplitude(path, joint, motor, cycles):
    """Of a line over the angle of a motor's joint, where that is fast: by its correlation with sine and cosine, without the mean of
    the 0.1 s around each row."""
    table, torque = rows(path, joint)
    sines, count, half = [0.0, 0.0], 0, 20
    sums = [0.0, *itertools.accumulate(torque)]
    for k in range(half, len(torque) - half):
        if abs(table[k][f"{motor}_velocity_deg_s"]) < 40:
            continue
        nm = torque[k] - (sums[k + half + 1] - sums[k - half]) / (2 * half + 1)
        angle = math.radians(cycles * table[k][f"{motor}_position_deg"])
        sines[0] += nm * math.cos(angle)
        sines[1] += nm * math.sin(angle)
        count += 1
    return 2 * math.hypot(*sines) / count


class Case(commands.Case):
    def arm(self, name, seed, **options):
        path = self.folder / name
        return path, write_arm_log(path, seed, **{"joints": 3, "seconds": 16.0, "rate": 400.0, **options})

    def found(self, *words):
        done = ended(0, run("identify", *words, "--json", "-q"))
        return json.loads(done.stdout)


class Identified(Case):
    def test_a_torque_with_nothing_but_the_ripple_of_another_motor_has_no_line_and_no_gear_of_its_own(self):
        log, _ = self.arm("log.csv", 11, own_nm=0.0, ratios=[160, 100, 80],
                          others=[(1, 1, 0.3, 1), (1, 1, 0.3, 2), (3, 1, 0.4, 2)])
        found = self.found(log, "--joint", "j3")
        motor = next(one for one in found["other_motors"] if one["joint"] == "j1")
        seen = {round(at["order"] * motor["gear_ratio"] / 160): at for at in motor["orders"] if at["found"]}
        self.assertEqual([2], list(seen))
        self.assertAlmostEqual(0.4, seen[2]["amplitude_nm"], delta=2 * seen[2]["stderr_nm"])
        self.assertEqual([], found["lines"])
        self.assertIn("The torque also holds ripple of the motor of j1 (0.4 Nm at order", found["verdict"])

    def test_one_joint_alone_gets_the_answer_that_it_gets_among_all(self):
        log, _ = self.arm("log.csv", 12, others=[(2, 3, 0.3, 2)])
        every = self.found(log)["joints"]
        self.assertEqual(3, len(every))
        for joint in every:
            alone = self.found(log, "--joint", joint["joint"])
            for key in "verdict", "lines", "gear_ratio", "other_motors":
                self.assertEqual(joint.get(key), alone.get(key), f"{joint['joint']}: {key}")
        done = run("identify", log, "-q")
        self.assertIn("ripple of each motor (columns) in each torque (rows), Nm", done.stdout)

    def test_without_ripple_of_other_motors_each_has_a_bound_and_a_claim_is_rare(self):
        claims = 0
        for seed in range(20, 26):
            log, _ = self.arm("log.csv", seed)
            for joint in self.found(log)["joints"]:
                for motor in joint["other_motors"]:
                    claims += any(at["found"] for at in motor["orders"])
        self.assertEqual(0, claims)


class Removed(Case):
    def test_a_map_removes_it_from_rows_that_it_was_not_made_from(self):
        log, ratios = self.arm("log.csv", 13, seconds=24.0, others=[(1, 2, 0.5, 2)])
        gear = ["--gear-ratio", str(ratios[0]), "--orders", "1,2,4"]
        done = ended(0, run("map", log, "--joint", "j1", "--to", "14s", *gear, "-o", self.folder / "map.json"))
        self.assertIn("The torque also holds ripple of the motor of j2", done.stdout)
        self.assertRegex(done.stdout, r"(?m)^j3 .*none above 0\.[0-9]+ Nm$")
        left = {}
        for name, words in {"raw": ["--method", "none"], "map": ["--method", f"map,map={self.folder}/map.json"],
                            "oscillator": ["--method", f"oscillator,map={self.folder}/map.json"],
                            "tracking": ["--method", "tracking", *gear, "--other-motors", self.folder / "map.json"]}.items():
            out = self.folder / f"{name}.csv"
            ended(0, run("filter", log, "--joint", "j1", "--from", "14s", *words, "-o", out))
            left[name] = amplitude(out, "j1", "j2", 2 * ratios[1])
        self.assertGreater(left["raw"], 0.35)
        for name in "map", "oscillator", "tracking":
            self.assertLess(left[name], 0.05, name)

    def test_a_log_without_the_other_joint_is_an_error(self):
        log, ratios = self.arm("log.csv", 13, seconds=24.0, others=[(1, 2, 0.5, 2)])
        made = self.folder / "map.json"
        run("map", log, "--joint", "j1", "--gear-ratio", str(ratios[0]), "--orders", "1,2,4", "-o", made)
        head, *lines = log.read_text().splitlines()
        alone = self.folder / "alone.csv"
        alone.write_text("\n".join(",".join(line.split(",")[:4]) for line in [head, *lines]) + "\n")
        ended(3, run("filter", alone, "--method", f"map,map={made}", "-o", self.folder / "out.csv"),
              "the map also holds ripple of the motor of j2, and the log has no joint of that name")
        self.assertFalse((self.folder / "out.csv").exists())
