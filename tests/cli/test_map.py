# SPDX-License-Identifier: MIT
"""ripplenotch map as users meet it, from a log to a map to a filter without delay."""

import json
import math
import shutil
import subprocess
import unittest

import commands
from commands import ended, run
from logs import map_log, to_and_fro

GEAR = ["--gear-ratio", "100", "--orders", "1,2"]


def write_log(path, seed, **more):
    """The slow torque of a log that is written."""
    path.write_text(map_log(seed, **more))
    return [row[3] for row in to_and_fro(seed)]


class Case(commands.Case):
    def setUp(self):
        super().setUp()
        self.log, self.map = self.folder / "log.csv", self.folder / "map.json"

    def made(self, *words):
        done = ended(0, run("map", *words, *GEAR, "-o", self.map, "--force"))
        return json.loads(self.map.read_text()), done.stdout


class Maps(Case):
    def wide_log(self, shares):
        """A log of one joint for each share, j1 first, which has that share of ripple of 0.8 and 0.3 Nm (orders 1 and 2)."""
        wide = self.folder / "wide.csv"
        with open(wide, "w") as file:
            file.write("time_s," + ",".join(f"j{j + 1}_{name}" for j in range(len(shares))
                                            for name in ("velocity_deg_s", "torque_nm", "position_deg")) + "\n")
            for t, v, position, slow, theta, noise in to_and_fro(1):
                cells = [t]
                for share in shares:
                    cells += [v, slow + share * (0.8 * math.cos(theta) + 0.3 * math.cos(2 * theta)) + noise, position]
                file.write(",".join(f"{cell:.6f}" for cell in cells) + "\n")
        return wide

    def test_a_joint_without_a_gear_does_not_keep_the_maps_of_the_others_back(self):
        """identify finds no line of the second joint, so that its joint.json has no ratio."""
        wide = self.wide_log((1.0, 0.0, 0.5))
        files = ["--joint-file", self.folder / "{joint}.json"]
        self.assertEqual(run("identify", wide, "--joint", "all", "-o", self.folder / "{joint}.json").returncode, 0)
        done = ended(3, run("map", wide, "--joint", "all", *files, "-o", self.folder / "{joint}_map.json"))
        self.assertEqual([line for line in done.stderr.split("\n") if "joint j" in line],
                         [f"ripplenotch map: joint j2: {self.folder}/j2.json: its gear ratio is null, because identify found none; give --gear-ratio, "
                          "or lines per turn of the joint, for example --orders 200/turn"])
        for joint, amplitude in (("j1", 0.8), ("j3", 0.4)):
            found = json.loads((self.folder / f"{joint}_map.json").read_text())
            self.assertAlmostEqual(found["left_out"][0]["ripple_nm"], amplitude, delta=0.02)
            self.assertIn(f"{joint}: Cross-validated", done.stdout)
        self.assertFalse((self.folder / "j2_map.json").exists())
        self.assertNotIn("j2: ", done.stdout)
        # The first joint that failed names the code; a file that is missing is another kind of failure.
        (self.folder / "j1.json").unlink()
        again = ended(4, run("map", wide, "--joint", "all", *files, "-o", self.folder / "{joint}_map.json", "--force", "-q"))
        self.assertEqual([line.split(":")[1] for line in again.stderr.strip().split("\n")], [" joint j1", " joint j2"])
        # Without any gear there is one complaint, not one for each joint.
        none = ended(2, run("map", wide, "--joint", "all", "-o", self.folder / "{joint}_map.json", "--force"))
        self.assertEqual(none.stderr.count("map needs to know where the ripple is"), 1)

    def test_every_joint_has_a_map_of_its_own(self):
        """Two joints of one log, the second with half of the ripple: the maps are those of each joint by its name."""
        wide = self.wide_log((1.0, 0.5))
        done = ended(0, run("map", wide, *GEAR, "--joint", "all", "-o", self.folder / "{joint}_map.json"))
        for joint, amplitude in (("j1", 0.8), ("j2", 0.4)):
            found = json.loads((self.folder / f"{joint}_map.json").read_text())
            self.made(wide, "--joint", joint)
            alone = json.loads(self.map.read_text())
            self.assertEqual({**found, "command": ""}, {**alone, "command": ""})
            first = next(one for one in found["coefficients"] if one["order"] == 1)
            self.assertAlmostEqual(first["cosine_nm"], amplitude, delta=0.02)
            self.assertIn(f"{joint}: Cross-validated", done.stdout)
        ended(0, run("filter", wide, "--joint", "all", "--method", f"oscillator,map={self.folder}/{{joint}}_map.json",
                     "-o", self.folder / "clean.csv"))
        for words, said in ((["-o", self.folder / "all.json"], "put {joint} into the name"), (["--json"], "put {joint} into the name")):
            ended(2, run("map", wide, *GEAR, "--joint", "all", *words), said)
        self.assertIn("standard input can be read once only", run("map", "-", *GEAR, "--joint", "all").stderr)


class Compensators(Case):
    def test_a_map_of_a_joint_of_another_name_and_a_faster_log_are_told(self):
        write_log(self.log, 1)
        found, _ = self.made(self.log)
        found["joint"] = "j4"
        self.map.write_text(json.dumps(found))
        named = self.folder / "named.csv"
        named.write_text(self.log.read_text().replace("velocity_deg_s,torque_nm,position_deg", "j3_velocity_deg_s,j3_torque_nm,j3_position_deg", 1))
        for command in ("filter", named, "-o", self.folder / "z.csv"), ("compare", named):
            ended(2, run(*command, "--method", f"map,map={self.map}"), "the map is of joint j4, and the log is of joint j3")
        found["joint"], found["range"]["speed_deg_s"] = "", [1.0, 40.0]
        self.map.write_text(json.dumps(found))
        for command in ("filter", self.log, "-o", self.folder / "fast.csv"), ("compare", self.log):
            for method in "map", "oscillator":
                done = ended(3, run(*command, "--method", f"{method},map={self.map}"))
                self.assertRegex(done.stderr, f"method {method}: its map was made at 1 to 40 deg/s, and this joint moves at [67].")
                self.assertFalse((self.folder / "fast.csv").exists())
        ended(0, run("filter", self.log, "--method", f"map,map={self.map},beyond=hold", "-o", self.folder / "z.csv", "--force"),
              "its map was made at 1 to 40 deg/s")

    def test_against_the_true_torque_a_map_leaves_the_noise(self):
        write_log(self.log, 1)
        self.made(self.log)
        slow = write_log(self.log, 2)
        rows = self.log.read_text().split("\n")
        cells = [row.split(",") for row in rows[1:] if row]
        truth = self.folder / "truth.csv"
        truth.write_text("\n".join([rows[0], *(",".join([t, v, f"{nm!r}", q]) for (t, v, _, q), nm in zip(cells, slow, strict=True))]) + "\n")
        done = ended(0, run("compare", self.log, "--truth", truth, "--method", f"map,map={self.map}", "--method", f"oscillator,map={self.map}", "--json"))
        none, mapped, followed = (one["error_rms_nm"] for one in json.loads(done.stdout)["methods"])
        self.assertGreater(none, 0.6)
        self.assertAlmostEqual(mapped, 0.05, delta=0.005)  # the noise
        self.assertLess(followed, 0.03)


HARNESS = """#include <stdio.h>
#include "ripple_map.h"
int main(void) {
    double speed, turns, position;
    while (scanf("%lf %lf %lf", &speed, &turns, &position) == 3)
        printf("%.17g\\n", (double)ripple_map_torque(speed, turns, position));
    return 0;
}
"""


class Exports(Case):
    def setUp(self):
        super().setUp()
        write_log(self.log, 1)
        self.made(self.log)

    def exported(self, to, name):
        path = self.folder / name
        done = ended(0, run("export", self.map, "--to", to, "-o", path))
        return path, done

    @unittest.skipUnless(shutil.which("cc"), "there is no C compiler")
    def test_the_exported_c_is_the_method(self):
        self.check_exported_c()

    @unittest.skipUnless(shutil.which("cc"), "there is no C compiler")
    def test_the_exported_c_is_the_method_with_both_combs(self):
        with open(self.log, "w") as file:
            file.write("time_s,velocity_deg_s,torque_nm,position_deg\n")
            for t, v, position, slow, theta, noise in to_and_fro(1):
                second = 2 * (theta + math.radians(position))
                file.write(f"{t},{v},{slow + 0.8 * math.cos(theta) + 0.4 * math.cos(second) + 0.3 * math.sin(2 * theta) + noise},{position}\n")
        self.assertEqual(self.made(self.log)[0]["form"]["second_comb"], 1)
        self.check_exported_c()

    def check_exported_c(self):
        still = self.folder / "still.csv"
        rows = [(k / 1000, 50, 3 + 0.05 * k) for k in range(2000)]
        still.write_text("time_s,velocity_deg_s,torque_nm,position_deg\n" + "".join(f"{t!r},{v},0,{q!r}\n" for t, v, q in rows))
        out = self.folder / "still_out.csv"
        self.assertEqual(run("filter", still, "--method", f"map,map={self.map}", "-o", out).returncode, 0)
        expected = [-float(line.split(",")[2]) for line in out.read_text().split("\n")[1:] if line]
        states = "".join(f"{v} {(100 * q / 360) % 1.0!r} {q!r}\n" for _, v, q in rows)
        (self.folder / "main.c").write_text(HARNESS)
        for precision, most in ("double", 1e-11), ("float", 1e-5):
            self.exported(f"c-header,precision={precision}", "ripple_map.h")
            ended(0, subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off", "main.c", "-lm", "-o", "main"],
                                    cwd=self.folder, capture_output=True, text=True))
            found = subprocess.run(["./main"], cwd=self.folder, input=states, capture_output=True, text=True).stdout.split()
            self.assertEqual(len(found), len(expected))
            self.assertLess(max(abs(float(a) - b) for a, b in zip(found, expected)), most, precision)
            (self.folder / "ripple_map.h").unlink()
