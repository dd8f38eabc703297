# SPDX-License-Identifier: MIT
"""ripplenotch map as users meet it, from a log to a map to a filter without delay."""

import functools
import json
import math
import random
import shutil
import subprocess
import unittest

import commands
from commands import ended, run

GEAR = ["--gear-ratio", "100", "--orders", "1,2"]


@functools.cache
def motion(seed):
    """Row by row: time, velocity, position, slow torque, the motor's angle in rad, noise."""
    draw, position, before, rows = random.Random(seed), 3.0, None, []
    for k in range(20000):
        t = k / 1000.0
        v = 80 * math.sin(0.9 * t + seed) + 30 * math.sin(0.37 * t)
        position += 0.0 if before is None else (before + v) / 2000.0
        before = v
        rows.append((t, v, position, 6 * math.sin(0.5 * t), math.radians(100 * position), draw.gauss(0, 0.05)))
    return rows


def write_log(path, seed, shift_deg=0.0, ripple=1.0, header="time_s,velocity_deg_s,torque_nm,position_deg", torque=True):
    """Ripple of 0.8 Nm (order 1, phase 30 deg) and 0.5 Nm (order 2) at a gear ratio of 100; returns the slow torque."""
    with open(path, "w") as file:
        file.write(header + "\n")
        for t, v, position, slow, theta, noise in motion(seed):
            nm = slow + ripple * (0.8 * math.cos(theta + math.radians(30)) + 0.5 * math.cos(2 * theta)) + noise
            cells = [t, v, nm, position + shift_deg]
            file.write(",".join(f"{cell:.6f}" for cell in cells[:len(header.split(","))]) + "\n")
    return [row[3] for row in motion(seed)]


class Case(commands.Case):
    def setUp(self):
        super().setUp()
        self.log, self.map = self.folder / "log.csv", self.folder / "map.json"

    def made(self, *words):
        done = ended(0, run("map", *words, *GEAR, "-o", self.map, "--force"))
        return json.loads(self.map.read_text()), done.stdout


class Maps(Case):
    def test_a_log_gives_the_ripple_that_it_was_made_with(self):
        write_log(self.log, 1)
        found, text = self.made(self.log)
        self.assertEqual((found["finding"], found["conclusive"], found["orders"]), ("mapped", True, [1, 2]))
        first, second = found["coefficients"]
        for one, amplitude, phase in (first, 0.8, 30.0), (second, 0.5, 0.0):
            for part, truth in ("cosine", amplitude * math.cos(math.radians(phase))), ("sine", -amplitude * math.sin(math.radians(phase))):
                self.assertAlmostEqual(one[f"{part}_nm"], truth, delta=2 * one[f"{part}_ci95_nm"])
        self.assertIn("Cross-validated: order 1 falls from", text)
        self.assertIn("noise limit", text)

    def test_the_same_log_gives_the_same_bytes(self):
        write_log(self.log, 1)
        self.made(self.log)
        before = self.map.read_bytes()
        self.made(self.log)
        self.assertEqual(self.map.read_bytes(), before)

    def test_without_ripple_the_map_is_empty_with_a_bound_and_no_filter_takes_it(self):
        write_log(self.log, 1, ripple=0.0)
        found, text = self.made(self.log)
        self.assertEqual((found["finding"], found["conclusive"], found["orders"], found["coefficients"]), ("nothing", True, [], []))
        self.assertRegex(text, "the map is empty. An amplitude of [0-9.]+ Nm of order 1, [0-9.]+ Nm of order 2 would have been found")
        for one in found["left_out"]:
            self.assertLess(one["detectable_nm"], 0.05)
        out = self.folder / "out.csv"
        for method in "map", "oscillator":
            ended(3, run("filter", self.log, "--method", f"{method},map={self.map}", "-o", out),
                  f"map.json: the map is empty: method {method} has no order to filter by it")
            self.assertFalse(out.exists())

    def test_a_map_of_other_orders_than_asked_is_an_error(self):
        write_log(self.log, 1)
        self.made(self.log)
        ended(3, run("filter", self.log, "--method", f"oscillator,map={self.map}", "--gear-ratio", "100", "--orders", "4", "-o", self.folder / "out.csv"),
              "map.json: the map holds none of the orders asked for")

    def test_a_second_of_one_speed_is_enough(self):
        ended(0, run("simulate", "--gear-ratio", "100", "--ripple", "1:0.8Nm:30deg", "--ripple", "2:0.5Nm", "--motion", "constant,speed=40deg/s,duration=1.5s",
                     "--sample-rate", "1kHz", "--noise", "0.05Nm", "--seed", "4", "-o", self.log))
        found, _ = self.made(self.log)
        self.assertEqual((found["finding"], found["orders"]), ("mapped", [1, 2]))

    def test_a_log_that_does_not_agree_is_named(self):
        logs = [self.folder / f"{i}.csv" for i in range(3)]
        for i, log in enumerate(logs):
            write_log(log, i + 1, shift_deg=0.6 if i == 1 else 0.0)
        found, text = self.made(*logs)
        self.assertFalse(found["conclusive"])
        self.assertIn("The logs disagree", text)
        ended(5, run("map", *logs, *GEAR, "--require-conclusive"))

    def test_a_log_without_a_position_is_not_conclusive(self):
        write_log(self.log, 1, header="time_s,velocity_deg_s,torque_nm")
        done = run("map", self.log, *GEAR, "--require-conclusive")
        self.assertEqual(done.returncode, 5, done.stdout + done.stderr)

    def test_a_log_without_units_is_read_by_what_turns_with_the_motor(self):
        write_log(self.log, 1, header="time,velocity,torque,position")
        done = run("map", self.log, *GEAR, "--require-conclusive", "--json")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertAlmostEqual(json.loads(done.stdout)["left_out"][0]["ripple_nm"], 0.8, delta=0.02)
        self.assertIn("no unit is stated", done.stderr)

    def test_who_states_no_gear_is_told_so(self):
        write_log(self.log, 1)
        ended(2, run("map", self.log), "map needs to know where the ripple is")

    def wide_log(self, shares):
        """A log of one joint for each share, j1 first, which has that share of ripple of 0.8 and 0.3 Nm (orders 1 and 2)."""
        wide = self.folder / "wide.csv"
        with open(wide, "w") as file:
            file.write("time_s," + ",".join(f"j{j + 1}_{name}" for j in range(len(shares))
                                            for name in ("velocity_deg_s", "torque_nm", "position_deg")) + "\n")
            for t, v, position, slow, theta, noise in motion(1):
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
        for words, said in ((["-o", self.folder / "map.json"], "put {joint} into the name"), (["--json"], "put {joint} into the name")):
            ended(2, run("map", wide, *GEAR, "--joint", "all", *words), said)
        self.assertIn("standard input can be read once only", run("map", "-", *GEAR, "--joint", "all").stderr)


class Compensators(Case):
    def filtered(self, method):
        out = self.folder / "out.csv"
        ended(0, run("filter", self.log, "--method", method, "-o", out, "--force"))
        return [float(line.split(",")[2]) for line in out.read_text().split("\n")[1:] if line]

    def rms(self, method, slow, first=0):
        out = self.filtered(method)
        return math.sqrt(sum((a - b) ** 2 for a, b in zip(out[first:], slow[first:])) / (len(out) - first))

    def test_a_map_of_one_log_takes_the_ripple_out_of_another_without_delay(self):
        write_log(self.log, 1)
        self.made(self.log)
        slow = write_log(self.log, 2)
        self.assertLess(self.rms(f"map,map={self.map}", slow), 0.055)  # the noise is 0.05 Nm
        self.assertLess(self.rms(f"oscillator,map={self.map}", slow), 0.03)

    def test_after_an_encoder_swap_the_zero_is_found(self):
        write_log(self.log, 1)
        self.made(self.log)
        slow = write_log(self.log, 2, shift_deg=1.3)
        self.assertGreater(self.rms(f"map,map={self.map}", slow), 0.3)
        self.assertLess(self.rms(f"oscillator,map={self.map},zero=unknown", slow, 500), 0.03)

    def test_the_method_is_told_by_its_file_and_the_file_is_among_the_inputs(self):
        write_log(self.log, 1)
        self.made(self.log)
        metrics = self.folder / "metrics.json"
        ended(0, run("filter", self.log, "--method", f"map,map={self.map}", "-o", self.folder / "x.csv", "--metrics", metrics))
        told = json.loads(metrics.read_text())
        self.assertEqual(told["method"], f"map,map={self.map}")
        self.assertIn(str(self.map), [one["name"] for one in told["inputs"]])

    def test_a_map_of_another_joint_is_refused_by_name(self):
        write_log(self.log, 1)
        self.made(self.log)
        for words in ("--gear-ratio", "101"), ("--gear-ratio", "101", "--orders", "1,2"):
            ended(2, run("filter", self.log, "--method", f"oscillator,map={self.map}", *words, "-o", self.folder / "y.csv"),
                  "map.json is the map of a joint of gear ratio 100, not of 101")

    def test_a_map_of_a_joint_of_another_name_and_a_faster_log_are_told(self):
        write_log(self.log, 1)
        found, _ = self.made(self.log)
        found["joint"] = "j4"
        self.map.write_text(json.dumps(found))
        named = self.folder / "named.csv"
        named.write_text(self.log.read_text().replace("velocity_deg_s,torque_nm,position_deg", "j3_velocity_deg_s,j3_torque_nm,j3_position_deg", 1))
        ended(2, run("filter", named, "--method", f"map,map={self.map}", "-o", self.folder / "z.csv"),
              "the map is of joint j4, and the log is of joint j3")
        found["joint"], found["range"]["speed_deg_s"] = "", [1.0, 40.0]
        self.map.write_text(json.dumps(found))
        for command in ("filter", self.log, "-o", self.folder / "fast.csv"), ("compare", self.log):
            for method in "map", "oscillator":
                done = ended(3, run(*command, "--method", f"{method},map={self.map}"))
                self.assertRegex(done.stderr, f"method {method}: its map was made at 1 to 40 deg/s, and this joint moves at [67].")
                self.assertFalse((self.folder / "fast.csv").exists())
        ended(0, run("filter", self.log, "--method", f"map,map={self.map},beyond=hold", "-o", self.folder / "z.csv", "--force"),
              "its map was made at 1 to 40 deg/s")

    def test_compare_names_the_joint_of_another_map_too(self):
        write_log(self.log, 1)
        found, _ = self.made(self.log)
        found["joint"] = "j4"
        self.map.write_text(json.dumps(found))
        named = self.folder / "named.csv"
        named.write_text(self.log.read_text().replace("velocity_deg_s,torque_nm,position_deg", "j3_velocity_deg_s,j3_torque_nm,j3_position_deg", 1))
        ended(2, run("compare", named, "--method", f"map,map={self.map}"), "the map is of joint j4, and the log is of joint j3")

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

    def test_a_map_is_drawn_with_its_intervals(self):
        write_log(self.log, 1)
        picture = self.folder / "map.figure.json"
        ended(0, run("map", self.log, *GEAR, "-o", self.map, "--plot", picture))
        panels = json.loads(picture.read_text())["panels"]
        self.assertEqual([panel["y"]["unit"] for panel in panels], ["Nm", "deg"])
        for panel, truths in zip(panels, ((0.8, 0.5), (30.0, 0.0)), strict=True):
            for truth, curve, ribbon in zip(truths, panel["curves"], panel["ribbons"], strict=True):
                self.assertTrue(all(low <= y <= high for low, y, high in zip(ribbon["low"], curve["y"], ribbon["high"], strict=True)))
                self.assertAlmostEqual(curve["y"][0], truth, delta=2 * (ribbon["high"][0] - ribbon["low"][0]))
        write_log(self.log, 1, ripple=0.0)
        ended(3, run("map", self.log, *GEAR, "--plot", self.folder / "empty.json"), "there is nothing to draw")

    def test_compare_takes_maps_beside_others(self):
        write_log(self.log, 1)
        self.made(self.log)
        done = ended(0, run("compare", self.log, "--method", f"map,map={self.map}", "--method", f"oscillator,map={self.map}",
                            "--method", "tracking,gear-ratio=100,orders=1:2"))
        self.assertIn("map.json", done.stdout)

    def test_report_shows_a_map(self):
        write_log(self.log, 1)
        self.made(self.log)
        page = self.folder / "page.html"
        ended(0, run("report", self.map, "-o", page, "-q"))
        self.assertIn("Cross-validated: order 1 falls from", page.read_text())
        self.assertIn("Ripple over speed", page.read_text())


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

    def test_every_target_is_read_back_and_says_how_far_off_it_is(self):
        for to, name in (("fourier", "a.csv"), ("c-header", "a.h"), ("beckhoff-ax8000", "b.csv"), ("lut", "c.csv"),
                         ("moteus,kt=0.1", "d.txt")):
            text = self.exported(to, name)[1].stdout
            self.assertIn("largest error", text)
            self.assertLess(float(text.split("largest error")[1].split()[0]), 0.01, to)

    @unittest.skipUnless(shutil.which("cc"), "there is no C compiler")
    def test_the_exported_c_is_the_method(self):
        self.check_exported_c()

    @unittest.skipUnless(shutil.which("cc"), "there is no C compiler")
    def test_the_exported_c_is_the_method_with_both_combs(self):
        with open(self.log, "w") as file:
            file.write("time_s,velocity_deg_s,torque_nm,position_deg\n")
            for t, v, position, slow, theta, noise in motion(1):
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
