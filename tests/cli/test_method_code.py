# SPDX-License-Identifier: MIT
"""tracking and oscillator as C: what was exported compiles without a warning and is the method, sample for sample."""

import math
import shutil
import subprocess
import unittest

from commands import Case, ended, run

ROWS = 20000
MOST = {"double": 1e-12, "float": 1e-5}
# A map by three speeds and direction.
VALUES = ":".join(f"{0.4 / (1 + k % 8) - 0.03 * (k % 5)}" for k in range(12))
RICH = (f"oscillator,gear-ratio=100,orders=1:2,cosines={VALUES},sines={VALUES},speeds=10:40:90,directions=2,"
        "slowest=8deg/s,positions=-60deg:70deg,spread=0.1Nm:0.2Nm")
# Both combs at two speeds and in both directions, orders 1 and 2.
COMBS = ":".join(f"{0.3 - 0.04 * k}" for k in range(16))
TWO_COMBS = (f"oscillator,gear-ratio=100,orders=1:2,cosines={COMBS},sines={COMBS},speeds=10:90,directions=2,second-comb=-1,slowest=8deg/s,"
             "positions=-60deg:70deg,spread=0.1Nm:0.2Nm")
# method -> what its step is told of the motion
METHODS = {
    "tracking,gear-ratio=100,orders=1:2": "speed",
    "tracking,gear-ratio=100,orders=1:2.5,composite=triple,slew=0.05,speed-lowpass=20Hz,low=park,weights=1:0.6,depth=40dB,q=3": "speed",
    "tracking,gear-ratio=100,orders=1,fade=0Hz,composite=double": "speed",
    "oscillator,gear-ratio=100,orders=1:2": "angle",
    "oscillator,gear-ratio=100,orders=1:2,output=minus-ripple,slip=0": "angle",
    "oscillator,gear-ratio=100,orders=2,amplitudes=0.5Nm,phases=40deg,jump=12": "angle",
    "oscillator,gear-ratio=100,orders=3:1:2:6": "angle",
    "oscillator,gear-ratio=100,orders=1:17": "angle",  # beyond half the sample rate in the middle of the swing
    "oscillator,gear-ratio=100,orders=1:2,cosines=0.5:0.3,sines=-0.2:0.1,return=1.5": "map",
    RICH: "map",
    TWO_COMBS: "map",
    RICH + ",output=minus-ripple,memory=0.4": "map",
}
# One function for each header, all of them in one program, which is told the number of the one to run.
RUN = """#include "code%(k)d.h"
static void run%(k)d(void) {
    static code%(k)d_state state;
    double torque, speed, angle, position;
    code%(k)d_init(&state);
    while (scanf("%%lf %%lf %%lf %%lf", &torque, &speed, &angle, &position) == 4)
        printf("%%.17g\\n", (double)code%(k)d_step(&state, (%(real)s)torque, %(motion)s));
}
"""
MOTIONS = {"speed": ("speed",), "angle": ("angle",), "map": ("angle", "speed", "position")}


def rows():
    """A swing through standstill whose position is its velocity added up, as the tool does it."""
    position, before, made = 0.0, None, []
    for k in range(ROWS):
        t = k / 1000.0
        v = 100 * math.cos(1.3 * t)
        position += 0.0 if before is None else 0.5 * (before + v) / 1000.0
        before = v
        turns = 100 * position / 360.0
        theta = 2 * math.pi * turns
        nm = 6 * math.sin(0.4 * t) + 0.8 * math.cos(theta + 1) + 0.5 * math.cos(2 * theta) + 0.05 * math.sin(7919 * t * t)
        made.append((t, v, nm + (5.0 if k > 12000 else 0.0), position, turns - math.floor(turns)))
    return made


class Code(Case):
    def export(self, method, *words, code=0, to="c-header,name=code", header="code.h"):
        done = ended(code, run("export", "--method", method, "--sample-rate", "1kHz", "--to", to, "-o", self.folder / header, "--force", *words))
        return done

    def filtered(self, log, method):
        out = self.folder / "out.csv"
        ended(0, run("filter", log, "--method", method, "-o", out, "--force"))
        return [float(line.split(",")[2]) for line in out.read_text().split("\n")[1:] if line]

    @unittest.skipUnless(shutil.which("cc"), "SKIPPED: there is no C compiler")
    def test_the_compiled_code_is_the_method(self):
        log, made = self.folder / "log.csv", rows()
        log.write_text("time_s,velocity_deg_s,torque_nm,position_deg\n" + "".join(f"{t!r},{v!r},{nm!r},{q!r}\n" for t, v, nm, q, _ in made))
        fed = "".join(f"{nm!r} {v!r} {turns!r} {q!r}\n" for _, v, nm, q, turns in made)
        cases = [(method, motion, precision) for method, motion in METHODS.items() for precision in MOST]
        program = "#include <stdio.h>\n#include <stdlib.h>\n"
        for k, (method, motion, precision) in enumerate(cases):
            self.export(method, to=f"c-header,name=code{k},precision={precision}", header=f"code{k}.h")
            program += RUN % {"k": k, "real": precision, "motion": ", ".join(f"({precision}){word}" for word in MOTIONS[motion])}
        runs = ", ".join(f"run{k}" for k in range(len(cases)))
        program += f"static void (*const runs[])(void) = {{{runs}}};\n"
        program += "int main(int count, char** words) {\n    if (count == 2) runs[atoi(words[1])]();\n    return 0;\n}\n"
        (self.folder / "main.c").write_text(program)
        ended(0, subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-Wdouble-promotion", "-O2", "-ffp-contract=off", "main.c",
                                 "-lm", "-o", "main"], cwd=self.folder, capture_output=True, text=True))
        alone = ["cc", "-std=c99", "-fsyntax-only", "-x", "c", *(f"code{k}.h" for k in range(len(cases)))]
        done = subprocess.run(alone, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""), "what a header needs, it includes itself")
        expected = {method: self.filtered(log, method) for method in METHODS}
        for k, (method, _, precision) in enumerate(cases):
            done = subprocess.run(["./main", str(k)], cwd=self.folder, input=fed, capture_output=True, text=True)
            found = list(map(float, done.stdout.split()))
            self.assertEqual(len(found), len(expected[method]))
            self.assertLess(max(abs(a - b) for a, b in zip(found, expected[method])), MOST[precision], f"{method} in {precision}")

    def test_verify_runs_it_beside_the_method_over_a_million_samples(self):
        by_joint = ("oscillator,gear-ratio=100,orders=1.5", "oscillator,orders=200/turn")
        for method in ("tracking,gear-ratio=100,orders=1:2", "oscillator,gear-ratio=100,orders=1:2", RICH, *by_joint):
            for precision, most in MOST.items():
                if method in by_joint and precision == "float":
                    most = 1e-4  # the joint's turn in float is a hundred times as coarse as the motor's
                text = self.export(method, to=f"c-header,precision={precision}").stdout
                self.assertIn("1000000 samples", text)
                self.assertLess(float(text.split("largest difference")[1].split()[0]), most, f"{method} in {precision}")
