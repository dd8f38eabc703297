# SPDX-License-Identifier: MIT
"""tracking and oscillator as C: what was exported compiles without a warning and is the method, sample for sample."""

import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

TOOL = os.environ["RIPPLENOTCH"]
ROWS = 20000
MOST = {"double": 1e-12, "float": 1e-5}
# A map by three speeds, direction, two harmonics of the joint's turn and load.
VALUES = ":".join(f"{0.4 / (1 + k % 8) - 0.03 * (k % 5)}" for k in range(32))
RICH = (f"oscillator,gear-ratio=100,orders=1:2,cosines={VALUES},sines={VALUES},speeds=10:40:90,directions=2,turn-harmonics=2,by-load=1,"
        "slowest=8deg/s,positions=-60deg:70deg,loads=-4Nm:5Nm,spread=0.1Nm:0.2Nm")
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
    RICH + ",output=minus-ripple,memory=0.4": "map",
}
HARNESS = """#include <stdio.h>
#include "code.h"
int main(void) {
    static code_state state;
    double torque, speed, angle, position;
    code_init(&state);
    while (scanf("%lf %lf %lf %lf", &torque, &speed, &angle, &position) == 4)
        printf("%.17g\\n", (double)code_step(&state, (REAL)torque, MOTION));
    return 0;
}
"""
MOTIONS = {"speed": "(REAL)speed", "angle": "(REAL)angle", "map": "(REAL)angle,(REAL)speed,(REAL)position"}


def run(*words):
    return subprocess.run([TOOL, *map(str, words)], capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL)


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


class Code(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def export(self, method, *words, code=0, to="c-header,name=code"):
        done = run("export", "--method", method, "--sample-rate", "1kHz", "--to", to, "-o", self.folder / "code.h", "--force", *words)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    @unittest.skipUnless(shutil.which("cc"), "SKIPPED: there is no C compiler")
    def test_the_compiled_code_is_the_method(self):
        log, made = self.folder / "log.csv", rows()
        log.write_text("time_s,velocity_deg_s,torque_nm,position_deg\n" + "".join(f"{t!r},{v!r},{nm!r},{q!r}\n" for t, v, nm, q, _ in made))
        fed = "".join(f"{nm!r} {v!r} {turns!r} {q!r}\n" for _, v, nm, q, turns in made)
        (self.folder / "main.c").write_text(HARNESS)
        for method, motion in METHODS.items():
            out = self.folder / "out.csv"
            done = run("filter", log, "--method", method, "-o", out, "--force")
            self.assertEqual(done.returncode, 0, done.stderr)
            expected = [float(line.split(",")[2]) for line in out.read_text().split("\n")[1:] if line]
            for precision, most in MOST.items():
                self.export(method, to=f"c-header,name=code,precision={precision}")
                done = subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-Wdouble-promotion", "-O2", "-ffp-contract=off",
                                       f"-DREAL={precision}", f"-DMOTION={MOTIONS[motion]}", "main.c", "-lm", "-o", "main"], cwd=self.folder, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, f"{method}: {done.stderr}")
                found = subprocess.run(["./main"], cwd=self.folder, input=fed, capture_output=True, text=True).stdout.split()
                self.assertEqual(len(found), len(expected))
                errors = [abs(float(a) - b) for a, b in zip(found, expected)]
                self.assertLess(max(errors), most, f"{method} in {precision}")

    def test_verify_runs_it_beside_the_method_over_a_million_samples(self):
        for method in "tracking,gear-ratio=100,orders=1:2", "oscillator,gear-ratio=100,orders=1:2", RICH:
            for precision, most in MOST.items():
                text = self.export(method, "--verify", to=f"c-header,precision={precision}").stdout
                self.assertIn("1000000 samples", text)
                self.assertLess(float(text.split("largest difference")[1].split()[0]), most, f"{method} in {precision}")

    def test_what_is_not_written_is_refused_by_name(self):
        for more, said in (("gain=scheduled", "gain=scheduled"), ("angle=velocity", "angle=velocity"), ("rest=0Nm", "rest"), ("cosines=1:1,sines=1:1,zero=unknown", "zero=unknown"),
                           ("cosines=1:1,sines=1:1,return=0.5", "a return below one turn"),
                           ("orders=1.5", "order 1.5 is not whole")):
            orders = "" if more.startswith("orders") else ",orders=1:2"
            self.assertIn(said, self.export(f"oscillator,gear-ratio=100{orders},{more}", code=2).stderr)
        self.assertIn("use c-header", self.export("tracking,gear-ratio=100,orders=1", to="scipy", code=2).stderr)
        self.assertIn("limits are on coefficients", self.export("tracking,gear-ratio=100,orders=1", "--min-depth-db", "20", code=2).stderr)


if __name__ == "__main__":
    unittest.main()
