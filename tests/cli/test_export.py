# SPDX-License-Identifier: MIT
"""ripplenotch export as its users meet it: files that compile and run, limits as exit codes, clear refusals."""

import json
import math
import os
import random
import shutil
import struct
import subprocess
import unittest

import commands
from commands import COMPILER, DATA, FILTER, SELF_TEST, ended

FIXED = ("--method", "fixed,centers=60Hz:120Hz,q=2", "--sample-rate", "1kHz")

# What CMSIS-DSP documents: y = b0 x + b1 x1 + b2 x2 + a1 y1 + a2 y2, state x1 x2 y1 y2 a stage.
ARM_MATH = """
typedef float float32_t;
static void cascade(const float32_t *c, int stages, float32_t *state, const float *in, float *out, int count)
{
    for (int k = 0; k < count; ++k) {
        float x = in[k];
        for (int s = 0; s < stages; ++s) {
            const float32_t *b = c + 5 * s;
            float32_t *m = state + 4 * s;
            const float y = b[0] * x + b[1] * m[0] + b[2] * m[1] + b[3] * m[2] + b[4] * m[3];
            m[1] = m[0]; m[0] = x; m[3] = m[2]; m[2] = y;
            x = y;
        }
        out[k] = x;
    }
}
"""


class Case(commands.Case):
    bytes_out = True

    def table(self, *words, name="table.json"):
        words = words or ("--speed", "18:180:18")
        self.good("design", "--gear-ratio", 100, "--orders", "1,2", "--sample-rate", "1kHz", *words, "-o", name, "--force")
        return name


@unittest.skipUnless(COMPILER, "no C compiler")
class CHeader(Case):
    def test_every_precision_and_form_compiles_without_a_warning_and_passes_its_own_test_vector(self):
        self.table()
        # In parallel every form runs as its preview does.
        for source in (["--method", "switching,table=table.json,transition=parallel"], FIXED):
            for precision in ("float", "double"):
                for form in ("svf", "df1", "df2t"):
                    self.good("export", *source, "--to", f"c-header,precision={precision},form={form}", "-o", "notch.h", "--force")
                    # Not contracted, it is the same arithmetic to the last bit.
                    self.assertEqual(float(self.compiled(SELF_TEST, "-O2", "-ffp-contract=off")), 0.0, (precision, form))
                    if form == "svf":
                        self.compiled(SELF_TEST, "-O3", "-ffast-math")  # within the tolerance all the same

    def test_the_test_vector_notices_one_wrong_digit_in_the_table(self):
        self.table()
        self.good("export", "table.json", "--to", "c-header,precision=double", "-o", "notch.h")
        path = self.folder / "notch.h"
        lines = path.read_text().split("\n")
        row = next(i for i, line in enumerate(lines) if line.startswith("        {0."))
        lines[row] = lines[row].replace("{0.", "{0.1", 1)
        path.write_text("\n".join(lines))
        (self.folder / "main.c").write_text(SELF_TEST)
        subprocess.run([COMPILER, "main.c", "-o", "main"], cwd=self.folder, check=True)
        self.assertEqual(subprocess.run(["./main"], cwd=self.folder, stdout=subprocess.DEVNULL).returncode, 1)

    def filtered_by_header(self, rows):
        text = "".join(f"{speed} {torque}\n" for speed, torque in rows)
        return [float(line) for line in self.compiled(FILTER, stdin=text).split()]

    def filtered_by_tool(self, rows, method):
        log = "time_s,velocity_deg_s,torque_nm\n" + "".join(f"{k / 1000},{v},{t}\n" for k, (v, t) in enumerate(rows))
        (self.folder / "log.csv").write_text(log)
        out = self.good("filter", "log.csv", "--method", method, "-q").stdout.decode().splitlines()
        return [float(line.split(",")[2]) for line in out[1:]]

    def test_the_header_filters_as_the_tool_does_under_every_rule_and_through_switches(self):
        # Speeds below, in, between and above the bands, both signs.
        rows = []
        for speed in (2, 9, 13, 25, 45, 57, 70, 95, 130, 90, 70, 55, 48, -30, -11, -3, 0, 4, 60):
            rows += [(speed, round(4 + math.sin(0.1 * k) + 0.5 * (k % 7), 6)) for k in range(60)]
        self.table("--bands", "18:36,36:54,60:80")
        for below in ("pass", "hold", "fade"):
            for above in ("pass", "hold", "fade"):
                method = f"switching,table=table.json,transition=keep-state-variable,below={below},above={above}"
                self.good("export", "--method", method, "--to", "c-header,precision=double", "-o", "notch.h", "--force")
                ours = self.filtered_by_header(rows)
                theirs = self.filtered_by_tool(rows, method)
                self.assertEqual(len(ours), len(theirs))
                self.assertLess(max(abs(a - b) for a, b in zip(ours, theirs)), 1e-9, (below, above))

    def test_a_constant_torque_passes_bit_for_bit_from_the_first_sample_through_every_switch(self):
        # ArduPilot's reset test, with its number, made harder: the speed goes through all bands meanwhile.
        self.table("--speed", "18:180:18")
        rows = [(k - 250, -0.512) for k in range(500)]
        for precision, expected in (("double", -0.512), ("float", struct.unpack("f", struct.pack("f", -0.512))[0])):
            self.good("export", "--method", "switching,table=table.json,below=fade,above=fade", "--to",
                      f"c-header,precision={precision}", "-o", "notch.h", "--force")
            self.assertEqual(set(self.filtered_by_header(rows)), {expected})

    def test_on_a_log_at_one_speed_the_float_header_is_within_a_tenth_of_a_millinewton_metre_of_the_tool(self):
        self.table()
        self.good("export", "table.json", "--to", "c-header", "-o", "notch.h")
        lines = (DATA / "paper_90deg_s.csv").read_text().splitlines()[1:]
        rows = [tuple(float(cell) for cell in line.split(",")[1:3]) for line in lines]
        worst = max(abs(a - b) for a, b in zip(self.filtered_by_header(rows),
                                               self.filtered_by_tool(rows, "switching,table=table.json")))
        self.assertLess(worst, 1e-4)


@unittest.skipUnless(COMPILER, "no C compiler")
class Cmsis(Case):
    def test_the_arrays_run_with_added_feedback_and_give_what_the_tool_gives(self):
        self.good("export", *FIXED, "--to", "cmsis-dsp", "-o", "notch.h")
        (self.folder / "arm_math.h").write_text(ARM_MATH)
        out = self.compiled("""
#include "notch.h"
#include <stdio.h>
int main(void)
{
    static float in[400], out[400];
    float32_t state[RIPPLENOTCH_STATE_FLOATS] = {0};
    for (int k = 0; k < 400; ++k) in[k] = k < 10 ? 0.0f : (float)(k % 5);
    cascade(ripplenotch_coefficients[0], RIPPLENOTCH_STAGES, state, in, out, 400);
    for (int k = 0; k < 400; ++k) printf("%.9g\\n", (double)out[k]);
    return 0;
}
""", "-I.")
        log = "time_s,velocity_deg_s,torque_nm\n" + "".join(
            f"{k / 1000},60,{0 if k < 10 else k % 5}\n" for k in range(400))
        (self.folder / "log.csv").write_text(log)
        theirs = self.good("filter", "log.csv", *FIXED[:2], "-q").stdout.decode().splitlines()[1:]
        for mine, line in zip(out.split(), theirs):
            self.assertAlmostEqual(float(mine), float(line.split(",")[2]), delta=2e-5)


class Content(Case):
    def test_scipy_itself_loads_it_and_filters_alike(self):
        python = "/usr/bin/python3"
        program = ("import numpy, scipy.signal as s, sys; sos = numpy.load('n.npy'); x = 3 + numpy.sin(numpy.arange(300) / 3);"
                   "y, _ = s.sosfilt(sos, x, zi=s.sosfilt_zi(sos) * x[0]); print(*y)")
        if not os.path.exists(python) or subprocess.run([python, "-c", "import scipy"], capture_output=True).returncode:
            self.skipTest("no SciPy")
        self.good("export", *FIXED, "--to", "scipy", "-o", "n.npy")
        done = subprocess.run([python, "-c", program], cwd=self.folder, capture_output=True, text=True, check=True)
        log = "time_s,velocity_deg_s,torque_nm\n" + "".join(
            f"{k / 1000},60,{3 + math.sin(k / 3)!r}\n" for k in range(300))
        (self.folder / "log.csv").write_text(log)
        theirs = self.good("filter", "log.csv", *FIXED[:2], "-q").stdout.decode().splitlines()[1:]
        for mine, line in zip(done.stdout.split(), theirs):
            self.assertAlmostEqual(float(mine), float(line.split(",")[2]), delta=1e-9)

    def test_octave_runs_the_script(self):
        octave = shutil.which("octave")
        if not octave:
            self.skipTest("no Octave")
        self.table()
        self.good("export", "table.json", "--to", "matlab", "-o", "n.m")
        program = "n; printf('%d %d %.17g %.17g %g', numel(ripplenotch.sos), rows(ripplenotch.sos{9}), " \
                  "ripplenotch.sos{9}(2, 5), ripplenotch.fs, ripplenotch.to_deg_s(9))"
        done = ended(0, subprocess.run([octave, "--no-gui", "--quiet", "--eval", program], cwd=self.folder, capture_output=True,
                                       text=True, timeout=60))
        table = json.loads((self.folder / "table.json").read_text())
        bands, sections, a1, rate, last = done.stdout.split()
        self.assertEqual((int(bands), int(sections), float(rate), float(last)), (9, 2, 1000, 180))
        self.assertEqual(float(a1), table["bands"][8]["notches"][1]["sos"][4])


# What `filter` previews is what exported C runs: every transition, precision and form, compiled and compared on a log that.
# switches up, down and outside the bands, on a speed with noise.
FULL_SCALE_NM = 50.0
# Largest difference from `filter`, Nm. Of fixed point a share of a blend has 15 bits.
BOUNDS_NM = {"double": 1e-9, "float": 2e-4, "q31": 1e-4}
TRANSITIONS = {"keep-state-variable": ("svf",), "parallel": ("svf", "df1", "df2t"),
               "crossfade": ("svf", "df1", "df2t")}
FIXED_POINT = """
#include "notch.h"
#include <math.h>
#include <stdio.h>
int main(void)
{
    const double last_place = RIPPLENOTCH_FULL_SCALE_NM / WORDS;
    double speed, torque;
    ripplenotch_state state;
    ripplenotch_init(&state);
    while (scanf("%lf %lf", &speed, &torque) == 2) {
        const ripplenotch_real word = (ripplenotch_real)floor(torque / last_place + 0.5);
        printf("%.17g\\n", (double)ripplenotch_step(&state, word, (int32_t)floor(1000 * speed + 0.5)) * last_place);
    }
    return 0;
}
"""


def moving_rows():
    """Speeds from rest through all bands and back, with noise at their edges; torque with ripple at order 1 and 2 of 100."""
    chance, turns, rows = random.Random(7), 0.0, []
    for k in range(6000):
        speed = 110.0 * (1.0 - abs(k - 3000) / 3000.0) * (1 if k < 4500 else -1) + chance.gauss(0.0, 0.4)
        speed = round(speed, 3)
        turns += speed * 100.0 / 360.0 / 1000.0
        torque = 8.0 + 4.0 * (k / 6000.0) + 0.8 * math.cos(6.2831853 * turns) + chance.gauss(0.0, 0.05)
        rows.append((speed, round(torque, 6)))
    return rows


@unittest.skipUnless(COMPILER, "no C compiler")
class PreviewIsExport(commands.Case):
    bytes_out = True

    def setUp(self):
        super().setUp()
        self.rows = moving_rows()
        (self.folder / "log.csv").write_text("time_s,velocity_deg_s,torque_nm\n" + "".join(
            f"{k / 1000},{speed},{torque}\n" for k, (speed, torque) in enumerate(self.rows)))
        self.good("design", "--gear-ratio", 100, "--orders", "1,2", "--sample-rate", "1kHz", "--bands", "18:36,36:54,60:80",
                  "--hysteresis", "1deg/s", "-o", "table.json")

    def preview(self, method):
        out = self.good("filter", "log.csv", "--method", method, "-q").stdout.decode().splitlines()
        return [float(line.split(",")[2]) for line in out[1:]]

    def exported(self, method, target, speed=1.0):
        self.good("export", "--method", method, "--to", target, "-o", "notch.h", "--force", "-q")
        fixed = "precision=q" in target
        # The test vector holds to the last bit where nothing is contracted, in fixed point always.
        tolerance = ("GOLDEN_TOLERANCE_NM", "GOLDEN_TOLERANCE") if fixed else ("", "")
        self.assertEqual(float(self.compiled(SELF_TEST.replace(*tolerance), "-O2", "-ffp-contract=off")), 0.0, (method, target))
        source = FIXED_POINT.replace("WORDS", "2147483648.0") if fixed else FILTER
        text = "".join(f"{v * speed!r} {t}\n" for v, t in self.rows)
        return [float(line) for line in self.compiled(source, "-O2", stdin=text).split()]

    def assert_same(self, method, target, bound_nm, speed=1.0):
        preview, exported = self.preview(method), self.exported(method, target, speed)
        self.assertEqual(len(preview), len(exported))
        self.assertLess(max(abs(a - b) for a, b in zip(preview, exported)), bound_nm, (method, target))

    def test_every_transition_in_every_precision_and_form(self):
        for transition, forms in TRANSITIONS.items():
            method = f"switching,table=table.json,transition={transition}"
            for precision, bound_nm in BOUNDS_NM.items():
                fixed = precision.startswith("q")
                for form in forms[:1] if fixed else forms:
                    keys = f",range={FULL_SCALE_NM}Nm" if fixed else f",form={form}"
                    # Direct forms of low centres lose digits in float, which is why they are not the default.
                    loose = 30 if precision == "float" and form != "svf" else 1
                    self.assert_same(method, f"c-header,precision={precision}{keys}", loose * bound_nm)

    def test_every_key_of_the_supervisor(self):
        for keys in ("hysteresis=0", "hysteresis=4deg/s", "dwell=200ms", "hysteresis=2deg/s,dwell=50ms", "below=fade,above=fade",
                     "below=hold,above=pass", "below=fade,hysteresis=3deg/s,dwell=20ms"):
            for transition in ("keep-state-variable", "crossfade,crossfade=120ms"):
                method = f"switching,table=table.json,transition={transition},{keys}"
                self.assert_same(method, "c-header,precision=double", 1e-9)
            self.assert_same(f"switching,table=table.json,{keys}", f"c-header,precision=q31,range={FULL_SCALE_NM}Nm", BOUNDS_NM["q31"])

    def test_a_table_alone_is_its_method_with_the_defaults_of_filter(self):
        default = self.preview("switching,table=table.json")
        self.assertEqual(default, self.preview("switching,table=table.json,transition=keep-state-variable,hysteresis=1deg/s"))
        self.good("export", "table.json", "--to", "c-header,precision=double", "-o", "a.h")
        self.good("export", "--method", "switching,table=table.json", "--to", "c-header,precision=double", "-o", "b.h")
        self.assertEqual([line for line in (self.folder / "a.h").read_text().splitlines() if "ripplenotch export" not in line],
                         [line for line in (self.folder / "b.h").read_text().splitlines() if "ripplenotch export" not in line])

    def test_a_speed_in_another_unit_or_of_the_motor(self):
        for unit, factor in (("rad/s", 0.017453292519943295), ("rpm", 1 / 6)):
            for side, ratio in (("joint", 1.0), ("motor", 100.0)):
                self.assert_same("switching,table=table.json,below=fade",
                                 f"c-header,precision=double,speed-unit={unit},speed-side={side}", 1e-9, factor * ratio)
        self.assertIn("motor_speed_rpm", (self.folder / "notch.h").read_text())
        self.good("export", "--method", "tracking,gear-ratio=100,orders=1:2", "--sample-rate", "1kHz", "-o", "track.h", "-q",
                  "--to", "c-header,precision=double,speed-unit=rpm,speed-side=motor")
        text = (self.folder / "track.h").read_text()
        self.assertIn("motor_speed_rpm", text)
        self.assertNotIn("speed_deg_s", text)
