# SPDX-License-Identifier: MIT
"""ripplenotch spectrum --segment as users meet it: a log goes by, from a file or through a pipe, and is not held."""

import math
import random
import resource
import subprocess

from commands import DATA, TOOL, Case, ended, run, sanitized


ROWS = 2_000_000  # held in memory they would take 70 MiB
MOST_MIB = 32.0   # measured: 14, whatever the number of rows


def spectrum(*words, log=None):
    return run("spectrum", *words, stdin=log, text=False)


class Streams(Case):
    def equal_by_pipe(self, log, *words):
        by_file = spectrum(str(log), *words)
        with open(log, "rb") as stream:
            by_pipe = spectrum("-", *words, log=stream)
        self.assertEqual(by_file.returncode, by_pipe.returncode, by_pipe.stderr)
        self.assertEqual(by_file.stdout, by_pipe.stdout)
        self.assertEqual(by_file.stderr.replace(str(log).encode(), b"standard input"), by_pipe.stderr)
        return by_file

    def test_a_pipe_gives_the_bytes_that_the_file_gives(self):
        for name in ("paper_90deg_s.csv", "paper_move_2s.csv", "paper_rest.csv"):
            for words in (("--segment", "0.5s", "--bins"), ("--segment", "0.5s", "-v"), ("--segment", "100s", "--bins", "-v")):
                with self.subTest(log=name, words=words):
                    self.assertEqual(self.equal_by_pipe(DATA / name, *words).returncode, 0)

    def test_errors_are_those_of_reading(self):
        log = self.folder / "log.csv"
        lines = (DATA / "paper_90deg_s.csv").read_text().splitlines(keepends=True)
        log.write_text("".join(lines[:3500]) + "3.6,90,oops,12\n" + "".join(lines[3500:]))
        done = self.equal_by_pipe(log, "--segment", "0.5s")
        self.assertEqual((done.returncode, done.stdout), (3, b""))
        self.assertIn(b"log.csv:3501:", done.stderr)
        ended(3, spectrum(str(DATA / "paper_90deg_s.csv"), "--segment", "0.01s"), b"use a longer --segment")

    def test_a_log_in_a_pipe_takes_no_more_memory_than_a_piece_does(self):
        random.seed(3)
        rest = [f"{90.0 + math.sin(6e-4 * k):.4f},{random.gauss(0.0, 0.1):.6f}" for k in range(50_000)]
        stamps = [f"{k:03d}" for k in range(1000)]
        if sanitized(TOOL):
            self.skipTest("a sanitizer's own memory would count")
        log = self.folder / "log.csv"
        with open(log, "w") as file:
            file.write("time_s,velocity_deg_s,torque_nm\n")
            for second in range(ROWS // 1000):
                at = random.randrange(len(rest) - 1000)
                file.write("".join([f"{second}.{stamp},{row}\n" for stamp, row in zip(stamps, rest[at:at + 1000])]))
        out = self.folder / "spectrum.csv"
        command = f"cat '{log}' | '{TOOL}' spectrum - --segment 4.096s -o '{out}'"
        subprocess.run(["sh", "-c", command], check=True, timeout=120, stdin=subprocess.DEVNULL)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
        self.assertEqual(len(out.read_text().splitlines()), 1 + 2049)
        self.assertLess(peak, MOST_MIB, "MiB at most of the tool, the shell and what they were started from")
