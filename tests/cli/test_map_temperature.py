# SPDX-License-Identifier: MIT
"""Maps of ripple that depends on the joint's temperature: where it enters, how the methods and the exports take it."""

import ctypes
import functools
import json
import math
import shlex
import shutil
import subprocess
import unittest

from commands import GEAR, run
from commands import run
from test_map import Case, motion


@functools.cache
def parts(seed):
    """What is the same at any temperature: time and velocity as text, position as text, slow torque, ripple, noise."""
    return [(f"{t:.6f},{v:.6f}", f"{position:.6f}", slow, 0.8 * math.cos(theta + 0.5) + 0.5 * math.cos(2 * theta), noise)
            for t, v, position, slow, theta, noise in motion(seed)]


class Warm(Case):
    """Ripple of 0.8 Nm at 30 degC that grows by 3 % a degree, in logs with a column of the joint's temperature."""

    COLUMN = ["--temperature", "drive_degc"]

    def write(self, warmth, seed=1, grows=0.03, path=None, column=True):
        """Returns the slow torque; `warmth` is the temperature from first to last row, or of a row by its number."""
        with open(path or self.log, "w") as file:
            file.write("time_s,velocity_deg_s,torque_nm,position_deg" + (",drive_degc" if column else "") + "\n")
            for k, (start, position, slow, ripple, noise) in enumerate(parts(seed)):
                degc = warmth(k) if callable(warmth) else warmth[0] + (warmth[1] - warmth[0]) * k / 20000
                nm = slow + (1 + grows * (degc - 30)) * ripple + noise
                file.write(f"{start},{nm:.6f},{position}" + (f",{degc:.6f}\n" if column else "\n"))
        return [slow for _, _, slow, _, _ in parts(seed)]

    def filtered(self, method, *words, code=0):
        out = self.folder / "out.csv"
        done = run("filter", self.log, "--method", method, "-o", out, "--force", *words)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr if code else [float(line.split(",")[2]) for line in out.read_text().split("\n")[1:] if line]

    def left(self, method, slow, *words):
        out = self.filtered(method, *words)
        return math.sqrt(sum((a - b) ** 2 for a, b in zip(out, slow, strict=True)) / len(out))

    def test_temperature_enters_where_it_pays_and_comes_back_as_it_was(self):
        self.write((20, 40))
        found, text = self.made(self.log, *self.COLUMN)
        self.assertTrue(found["form"]["by_temperature"])
        self.assertIn("and by temperature", text)
        self.assertEqual(found["temperature_column"], "drive_degc")
        low, high = found["range"]["temperature_degc"]
        self.assertTrue(20 <= low < 21 and 39 < high <= 40, (low, high))
        per_degree = [one for one in found["coefficients"] if one["column"] == "per degC beyond the middle"]
        for one, amplitude, phase in zip(per_degree, (0.8, 0.5), (0.5, 0.0), strict=True):
            self.assertAlmostEqual(one["cosine_nm"], 0.03 * amplitude * math.cos(phase), delta=2.5 * one["cosine_ci95_nm"])
            self.assertAlmostEqual(one["sine_nm"], -0.03 * amplitude * math.sin(phase), delta=2.5 * one["sine_ci95_nm"])

    def test_temperature_that_says_nothing_is_not_in_the_map(self):
        self.write((20, 40), grows=0.0)
        found, _ = self.made(self.log, *self.COLUMN)
        self.assertNotIn("by_temperature", found["form"])
        self.assertNotIn("temperature_degc", found["range"])
        self.write((30, 30.5))
        self.assertNotIn("by_temperature", self.made(self.log, *self.COLUMN)[0]["form"])

    def test_a_column_that_stands_still_is_one_number(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        self.write((22.5, 22.5), seed=2)
        for method in "map", "oscillator":
            self.filtered(f"{method},map={self.map}")
            along_the_rows = (self.folder / "out.csv").read_bytes()
            self.filtered(f"{method},map={self.map},temperature=22.5")
            self.assertEqual(along_the_rows, (self.folder / "out.csv").read_bytes(), method)

    def test_where_the_column_steps_the_map_is_another_from_that_row_on(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        at, degc = 7321, (24.0, 37.0)
        slow = self.write(lambda k: degc[k >= at], seed=2)
        stepped, cold, hot = (self.filtered(f"map,map={self.map}{more}") for more in ("", ",temperature=24", ",temperature=37"))
        self.assertEqual(stepped, cold[:at] + hot[at:])
        self.assertNotEqual(cold[at - 50:at], hot[at - 50:at])
        self.assertEqual(stepped, self.filtered(f"map,map={self.map}", "--threads", "1"))
        mean = (at * degc[0] + (20000 - at) * degc[1]) / 20000
        for method, most in (("map", 0.056), ("oscillator", 0.035)):
            self.assertLess(self.left(f"{method},map={self.map}", slow), most)
        self.assertGreater(self.left(f"map,map={self.map},temperature={mean}", slow), 0.1)

    def test_compare_follows_the_column_as_filter_does(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        slow, truth = self.write(lambda k: 22 + 14 * (k // 5000 % 2), seed=2), self.folder / "truth.csv"
        rows = self.log.read_text().split("\n")[1:-1]
        truth.write_text("time_s,velocity_deg_s,torque_nm,position_deg\n" + "".join(
            ",".join(cells[:2] + [repr(one)] + cells[3:4]) + "\n" for cells, one in zip((row.split(",") for row in rows), slow, strict=True)))
        words = [word for method in ("map", "oscillator") for word in ("--method", f"{method},map={self.map}")]
        done = run("compare", self.log, *words, *GEAR, "--truth", truth, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        errors = {one["method"].split(",")[0]: one.get("error_rms_nm") for one in json.loads(done.stdout)["methods"]}
        for method in "map", "oscillator":
            self.assertAlmostEqual(errors[method], self.left(f"{method},map={self.map}", slow), delta=1e-7)

    def test_a_wrong_option_is_not_taken_for_a_missing_column(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        method, out = f"map,map={self.map}", self.folder / "out.csv"
        for words, code, message in ((("--joint", "elbow"), 2, "--joint elbow"), (("--unit", "velocity=Nm"), 2, "'Nm' is no unit of velocity"),
                                     (("--columns", "torque=torque_nm,velocity=nix"), 2, "'nix'")):
            done = run("filter", self.log, "--method", method, "-o", out, "--force", *words)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(message, done.stderr)
            self.assertNotIn("read no column", done.stderr)
        self.log.write_text(self.log.read_text().replace("drive_degc", "motor_current"))
        done = run("filter", self.log, "--method", method, "-o", out, "--force")
        self.assertEqual(done.returncode, 3)
        self.assertIn("read no column 'drive_degc', expected the temperature", done.stderr)

    def test_cells_without_a_temperature_are_those_before_them_and_counted(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        self.write(lambda k: 24.0 if k < 9000 else 37.0, seed=2)
        method, out = f"map,map={self.map}", self.folder / "out.csv"
        self.filtered(method)
        whole = [row.split(",")[2] for row in out.read_text().split("\n")[1:-1]]
        rows = self.log.read_text().split("\n")
        for k in (500, 501, 502, 12000):
            rows[1 + k] = rows[1 + k].rpartition(",")[0] + ","
        self.log.write_text("\n".join(rows))
        done = run("filter", self.log, "--method", method, "-o", out, "--force")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("column 'drive_degc': 4 cells without a temperature; the row before counts", done.stderr)
        self.assertEqual([row.split(",")[2] for row in out.read_text().split("\n")[1:-1]], whole)
        done = run("compare", self.log, "--method", method)
        self.assertIn("4 cells without a temperature", done.stderr)

    @unittest.skipUnless(shutil.which("cc"), "no C compiler here")
    def test_the_maps_c_takes_each_rows_temperature_as_the_tool_does(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        self.write(lambda k: 18 + 3 * (k // 2000), seed=2)
        header, library = self.folder / "ripple.h", self.folder / "ripple.so"
        done = run("export", self.map, "--to", "c-header,precision=double,name=ripple", "-o", header)
        self.assertEqual(done.returncode, 0, done.stderr)
        source = self.folder / "ripple.c"
        source.write_text('#include "ripple.h"\ndouble says(double v, double turns, double deg, double nm, double degc) '
                          "{ return ripple_torque(v, turns, deg, nm, degc); }\n")
        subprocess.run(["cc", "-O1", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
        says = ctypes.CDLL(str(library)).says
        says.restype, says.argtypes = ctypes.c_double, [ctypes.c_double] * 5
        clean = self.filtered(f"map,map={self.map}")
        rows = [[float(cell) for cell in row.split(",")] for row in self.log.read_text().split("\n")[1:-1]]
        # Slower than 7.2 deg/s the tool's angle follows the velocity, too, where the position trembles.
        worst = max(abs(nm - says(v, deg / 3.6, deg, nm, degc) - one)
                    for (_, v, nm, deg, degc), one in zip(rows, clean, strict=True) if abs(v) > 8.0)
        self.assertLess(worst, 1e-9)

    def test_the_methods_look_the_map_up_at_the_logs_temperature(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        slow = self.write((22, 23), seed=2)
        self.assertLess(self.left(f"map,map={self.map}", slow), 0.056)  # the noise is 0.05 Nm
        self.assertLess(self.left(f"oscillator,map={self.map}", slow), 0.03)
        self.assertGreater(self.left(f"map,map={self.map},temperature=38", slow), 0.2)
        done = run("compare", self.log, "--method", f"map,map={self.map}", "--method", f"oscillator,map={self.map}")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_log_without_it_is_refused_until_somebody_states_it(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        slow = self.write((22, 22), seed=2, column=False)
        for method in "map", "oscillator":
            said = self.filtered(f"{method},map={self.map}", code=3)
            self.assertRegex(said, r"log.csv: read no column 'drive_degc', expected the temperature that .*map.json depends on; state it in the method")
            self.assertEqual(run("compare", self.log, "--method", f"{method},map={self.map}").returncode, 3)
        self.assertLess(self.left(f"map,map={self.map},temperature=22", slow), 0.056)

    def test_beyond_what_was_seen_the_edge_holds(self):
        self.write((20, 40))
        found, _ = self.made(self.log, *self.COLUMN)
        self.write((60, 60), seed=2)
        high = found["range"]["temperature_degc"][1]
        self.assertEqual(self.filtered(f"map,map={self.map}"), self.filtered(f"map,map={self.map},temperature={high!r}"))

    def test_a_column_that_is_not_there_is_refused_when_the_map_is_made(self):
        self.write((20, 40))
        done = run("map", self.log, *GEAR, "--temperature", "nix")
        self.assertEqual(done.returncode, 2)
        self.assertIn("has no column 'nix'", done.stderr)

    def test_two_logs_of_two_temperatures_make_one_map(self):
        cold, hot = self.folder / "cold.csv", self.folder / "hot.csv"
        self.write((18, 19), path=cold)
        self.write((41, 42), seed=3, path=hot)
        found, _ = self.made(cold, hot, *self.COLUMN)
        self.assertTrue(found["form"]["by_temperature"], found["verdict"])

    def test_exports_hold_it_or_say_that_they_do_not(self):
        self.write((20, 40))
        self.made(self.log, *self.COLUMN)
        for to, most in ("c-header,precision=double", 1e-12), ("c-header", 1e-5), ("fourier", 1e-12):
            done = run("export", self.map, "--to", to, "-o", self.folder / ("a.csv" if to == "fourier" else "a.h"), "--verify", "--force")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("temperature", done.stderr)
            self.assertLess(float(done.stdout.split("largest error")[1].split()[0]), most)
        held = []
        for more in "", ",temperature=22", ",temperature=38":
            done = run("export", self.map, "--to", "lut,entries=16" + more, "-o", self.folder / "a.csv", "--force")
            self.assertIn("the dependence on temperature is left out", done.stderr)
            held.append((self.folder / "a.csv").read_text().split("\n")[-6:])
        self.assertEqual(len({tuple(one) for one in held}), 3)
        for precision, most in ("double", 1e-12), ("float", 1e-5):
            done = run("export", "--method", f"oscillator,map={self.map},temperature=25", "--sample-rate", "1kHz", "--to", f"c-header,precision={precision}",
                       "-o", self.folder / "b.h", "--verify", "--force")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertLess(float(done.stdout.split("largest difference")[1].split()[0]), most)

    def test_recommend_trains_a_map_along_the_temperature_and_says_how_to(self):
        self.write(lambda k: 30 + 8 * math.sin(k / 700))
        judged = {}
        for column in [], self.COLUMN:
            done = run("recommend", self.log, *GEAR, *column, "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            told = json.loads(done.stdout)
            judged[bool(column)] = {one["method"]: one for one in told["methods"]}
        # Beside a ripple that is off by 8 degC x 3 %, the noise in eight motor turns is nothing.
        plain, warm = (judged[one]["map,map=map.json"]["ripple_rms_nm"] for one in (False, True))
        self.assertLess(warm, 0.2 * plain)
        self.assertIn("map=map.json", told["take"])
        commands = [line.replace("ripplenotch ", "", 1) for line in told["take_commands"] + told["runner_up_commands"]]
        self.assertTrue(any(line.startswith("map ") and "--temperature drive_degc" in line for line in commands), commands)
        for line in dict.fromkeys(commands):
            self.pasted(line)
        compared = {one["method"].split(",temperature")[0]: one for one in json.loads(self.pasted(told["check"].replace("ripplenotch ", "", 1) + " --json"))["methods"]}
        for name in told["take"], told["runner_up"]:
            self.assertAlmostEqual(compared[name]["ripple_rms_nm"], judged[True][name]["ripple_rms_nm"], places=8)

    def test_recommend_for_code_judges_what_the_code_can_do(self):
        self.write(lambda k: 30 + 8 * math.sin(k / 700))
        done = run("recommend", self.log, *GEAR, *self.COLUMN, "--target", "c-header", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        methods = [one["method"] for one in told["methods"]]
        self.assertIn("map,map=map.json", methods)  # the map's code takes each row's temperature
        self.assertNotIn("oscillator,map=map.json", methods)  # the oscillator's has one for good
        self.assertRegex(",".join(methods), r"oscillator,map=map.json,temperature=\d\d\.\d,")
        for line in told["take_commands"]:
            self.pasted(line.replace("ripplenotch ", "", 1))

    def test_recommend_says_when_the_temperature_says_nothing(self):
        self.write((20, 40), grows=0.0)
        done = run("recommend", self.log, *GEAR, *self.COLUMN)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("a map by temperature: 'drive_degc' does not predict this ripple", done.stdout)
        refused = run("recommend", self.log, *GEAR, "--temperature", "nix")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("has no column 'nix'", refused.stderr)

    def pasted(self, line):
        words = shlex.split(line)
        done = self.good(*words, *([] if words[0] == "compare" else ["--force"]))
        return done.stdout
