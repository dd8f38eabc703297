# SPDX-License-Identifier: MIT
"""The gate on speed: instructions a row, as valgrind counts them, against the recorded figures.

usage: tests/bench/instructions.py [--update]      (environment: RIPPLENOTCH, the tool; RIPPLENOTCH_BUILD, compiler and flags)

Times are noise on a shared machine; the number of instructions of one build is not. Every case runs the tool on a short
and on a long log and divides the difference by the rows between, so that the start of the process does not count. More than
`limit_percent` above the figure in instructions.json is exit code 1. Exit code 77, for ctest "skipped": without
valgrind, or on a build that the figures were not recorded with. --update records what is measured.
"""

import argparse
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

RECORDED = pathlib.Path(__file__).with_name("instructions.json")
SKIPPED = 77
# Most of a short run is valgrind's translation of code that runs but a few times: it is not to optimise it. The counts are
# callgrind's, to the last instruction; cachegrind does no more than count.
COUNT = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null", "--vgdb=no",
         "--vex-guest-chase=no", "--vex-iropt-level=0"]
SHORT, LONG = 17_000, 29_000  # both beyond the first 16384 rows, which filter looks at before it begins
COLUMNS = ("time_s", "velocity_deg_s", "torque_nm")

# Quiet: the warnings of harm measure the ripple in stretches of the log, whose cost is no cost of a row.
CASES = {
    "filter, CSV with 6 decimals": ["filter", "-q", "{log}.csv", "--method", "switching,table={table}", "--decimals", "6", "-o", "{out}.csv"],
    "filter, CSV, shortest digits": ["filter", "-q", "{log}.csv", "--method", "switching,table={table}", "--decimals", "shortest", "-o", "{out}.csv"],
    "filter, npy": ["filter", "-q", "{log}.npy", "--method", "switching,table={table}", "-o", "{out}.npy"],
    # Through a pipe, whose bytes are not hashed: valgrind knows no instructions for SHA-256, so hashing would be most of it.
    # No line in either log: the short one has two by chance, and what it costs to measure them is no cost of a row.
    "spectrum, npy, segments of 4096": ["spectrum", "-", "--segment", "2.048s", "--false-alarm", "1e-6", "-o", "{out}.csv"],
    "track, npy, least squares": ["spectrum", "-", "--track", "--orders", "1,2", "--gear-ratio", "40", "-o", "{out}.csv"],
    "identify, CSV with 6 decimals": ["identify", "{log}.csv", "-o", "{out}.txt"],
    "spectrum against order, npy": ["spectrum", "-", "--domain", "order", "-o", "{out}.csv"],
}


def rows(count):
    """Speed goes through all bands; ripple at orders 1 and 2 of a gear of 40; noise from a linear congruential generator."""
    motor, seed = 0.0, 1
    for k in range(count):
        t = k / 2000
        speed = 166 * math.sin(0.314 * t) * math.sin(0.17 * t + 1)
        motor += 40 * math.radians(speed) / 2000
        seed = seed * 16807 % 2147483647
        yield t, speed, speed / 52 + 0.8 * math.sin(motor) + 0.35 * math.sin(2 * motor + 1) + 0.2 * (seed / 2147483647 - 0.5)


def make_logs(folder, log):
    count = len(log)
    text = ",".join(COLUMNS) + "\n" + "".join(f"{t:.4f},{v:.6f},{x:.6f}\n" for t, v, x in log)
    (folder / f"{count}.csv").write_text(text)
    header = str({"descr": [(name, "<f8") for name in COLUMNS], "fortran_order": False, "shape": (count,)})
    header += " " * (-(len(header) + 11) % 64) + "\n"
    (folder / f"{count}.npy").write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() +
                                          b"".join(struct.pack("<3d", *row) for row in log))


def instructions(words, piped):
    with open(piped, "rb") as pipe:
        done = subprocess.run([*COUNT, *words], capture_output=True, text=True, stdin=pipe)
    found = re.search(r"I +refs: +([\d,]+)", done.stderr)
    if done.returncode != 0 or not found:
        raise RuntimeError(f"{' '.join(words)}:\n{done.stderr}")
    return int(found[1].replace(",", ""))


def per_row(tool, folder, words):
    """With one thread: how two wait for each other, and who of them does what, is not the same twice."""
    def count(length):
        filled = [word.format(log=folder / str(length), table=folder / "table.json", out=folder / "out") for word in words]
        one_thread = ["--threads", "1"] if words[0] == "filter" else []
        return instructions([tool, *filled, "--force", *one_thread], folder / f"{length}.npy")
    return (count(LONG) - count(SHORT)) / (LONG - SHORT)


def without_symbols(tool, folder):
    """The same instructions; valgrind would read its symbols anew in each of the runs, which takes as long as some of them."""
    if not shutil.which("strip"):
        return tool
    subprocess.run(["strip", "-o", folder / "tool", tool], check=True)
    return folder / "tool"


def measure(tool):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tool = without_symbols(tool, folder)
        log = list(rows(LONG))
        for count in (SHORT, LONG):
            make_logs(folder, log[:count])
        subprocess.run([tool, "design", "--gear-ratio", "40", "--orders", "1,2", "--sample-rate", "2kHz", "--speed", "20:200:20",
                        "--q", "5", "-o", folder / "table.json"], check=True)
        return {case: per_row(tool, folder, words) for case, words in CASES.items()}


def reason_to_skip(build, recorded_with):
    if not shutil.which("valgrind"):
        return "there is no valgrind here"
    if build != recorded_with:
        return f"the figures are those of '{recorded_with}', this is '{build}'"
    if "avx2" not in pathlib.Path("/proc/cpuinfo").read_text().split():
        return "this processor has no AVX2, so other code runs"
    if "-AVX2" in os.environ.get("GLIBC_TUNABLES", ""):
        return "the C library is told to do without AVX2, so other code runs"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    recorded, build = json.loads(RECORDED.read_text()), os.environ["RIPPLENOTCH_BUILD"]
    reason = reason_to_skip(build, build if options.update else recorded["build"])
    if reason:
        print(f"SKIPPED: {reason}")
        return SKIPPED
    measured = measure(os.environ["RIPPLENOTCH"])
    slower = []
    for case, figure in measured.items():
        before = recorded["instructions_per_row"].get(case, math.nan)
        change = 100 * (figure / before - 1)
        print(f"{case:34} {figure:9.1f} instructions a row, recorded {before:9.1f}, {change:+6.1f} %")
        if not change <= recorded["limit_percent"]:
            slower.append(case)
    if options.update:
        recorded |= {"build": build, "instructions_per_row": {case: round(figure, 1) for case, figure in measured.items()}}
        RECORDED.write_text(json.dumps(recorded, indent=2) + "\n")
    elif slower:
        print(f"More than {recorded['limit_percent']} % above the record: {'; '.join(slower)}. Find out why with callgrind; "
              "if it is worth it, record it (docs/performance.md).")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
