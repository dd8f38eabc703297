# SPDX-License-Identifier: MIT
"""What `filter` previews is what exported C runs: every transition, precision and form, compiled and compared on a log that
switches up, down and outside the bands, on a speed with noise."""

import math
import random
import unittest

import commands
from commands import COMPILER, FILTER, SELF_TEST

FULL_SCALE_NM = 50.0
# Largest difference from `filter`, Nm. Of fixed point a share of a blend has 15 bits.
BOUNDS_NM = {"double": 1e-9, "float": 2e-4, "q31": 1e-4}
TRANSITIONS = {"keep-state-variable": ("svf",), "parallel": ("svf", "df1", "df2t"),
               "crossfade": ("svf", "df1", "df2t")}
FIXED = """
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
        source = FIXED.replace("WORDS", "2147483648.0") if fixed else FILTER
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
