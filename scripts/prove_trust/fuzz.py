# SPDX-License-Identifier: MIT
"""Readers fed with what nobody would write: bytes and structures by libFuzzer within the readers, mutated documents through the
program itself.

The targets are built by `cmake --workflow --preset fuzz` (clang); where they are missing, only the second is done."""

import concurrent.futures
import os
import pathlib
import re
import subprocess
import tempfile
import time

from . import corpora, documents, outcome

TARGETS = {
    "logs": ("readers of text logs and arrays: vectors, plain, careful, pieces", "same rows or same message four ways; sanitizers"),
    "npz": ("archives of arrays", "same rows or same message at once and in pieces; sanitizers"),
    "mat": ("MAT files of versions 5 to 7", "the same"),
    "hdf5": ("HDF5 files", "the same"),
    "mcap": ("MCAP recordings", "the same"),
    "rosbag2": ("recordings in SQLite", "the same"),
    "json": ("logs in JSON", "the same"),
    "raw": ("raw dumps, read with --layout", "the same"),
    "packed": ("gzip, zstd, lz4", "same bytes or same message at once and in pieces; sanitizers"),
    "documents": ("tables, models, joints, figures, diagnoses, pages", "an answer or a page, read again; sanitizers"),
    "arms": ("URDF, MuJoCo, Denavit-Hartenberg, axes", "an answer; sanitizers"),
    "texts": ("quantities, methods, numbers, visible names", "bounds, written and read again; sanitizers"),
}
# Where most of the time goes: what is slowest, and what strangers write most.
SHARES = {"logs": 0.22, "npz": 0.05, "mat": 0.05, "hdf5": 0.05, "mcap": 0.08, "rosbag2": 0.03, "json": 0.03, "raw": 0.02, "packed": 0.02,
          "documents": 0.2, "arms": 0.07, "texts": 0.07, "program": 0.11}
LONG_ROUND_S = 4 * 3600.0
# Containers have to hold a file; everything else says what it says in less, and more often.
MOST_BYTES = {"logs": 1500, "json": 1500, "raw": 1500, "packed": 2000, "documents": 5000, "arms": 600, "texts": 120}
MOST_BYTES_ELSE = 6000
# Stacks of allocations are only read after a finding, which is tried once more then, with all of them.
SANITIZERS = {"ASAN_OPTIONS": "malloc_context_size=1:quarantine_size_mb=16:symbolize=0"}
# What comes out of a pipe is kept in files, which are quicker made in memory.
QUICK_FOLDER = {"TMPDIR": "/dev/shm"} if os.access("/dev/shm", os.W_OK) else {}
PROGRAM = "program"
LONGEST_S = 2.0  # of one input


def runs_told(said):
    """By the statistics at the end, or, where a target was killed, by its last line: "#1234 REDUCE cov: ..."."""
    counted = re.search(r"number_of_executed_units:\s*(\d+)", said) or next(
        iter(list(re.finditer(r"^#(\d+)\s", said, re.M))[-1:]), None)
    return int(counted[1]) if counted else 0


def finding(said, written, program):
    """A sentence about what ended a target, with the file that does it again; None for an input that took long by the clock
    alone, which depends on who else is at work."""
    if written:
        before = documents.processor_s()
        again = subprocess.run([str(program), written[1]], capture_output=True, text=True, errors="replace", check=False, timeout=600)
        if "libFuzzer: timeout" in said and again.returncode == 0 and documents.processor_s() - before < LONGEST_S:
            return None
        said = again.stderr if again.returncode else said
    words = re.search(r"(ERROR: \S+: [^\n]*|runtime error: [^\n]*|SUMMARY: [^\n]*|differ[^\n]*)", said)
    return f"{words[1] if words else said[-200:]} ({pathlib.Path(written[1]).name if written else 'no file'})"


def fuzz_target(options, name, corpus, seconds):
    """Row of one target, restarted after each finding until its time is over."""
    program = options.source / "build/fuzz/tests/fuzz" / f"fuzz_{name}"
    row = outcome.Row(TARGETS[name][0], 0, 0.0, TARGETS[name][1])
    if not program.exists():
        row.findings.append(f"{program.relative_to(options.source)} is not built: cmake --workflow --preset fuzz")
        return row
    kept = options.keep or pathlib.Path(tempfile.mkdtemp(prefix="prove-trust-"))
    kept.mkdir(parents=True, exist_ok=True)
    start, tries = time.monotonic(), 0
    while (left := seconds - (time.monotonic() - start)) > 1 and len(row.findings) < 20:
        words = [str(program), str(corpus), f"-max_total_time={int(left)}", f"-seed={options.seed + tries}", f"-timeout={LONGEST_S:g}",
                 "-rss_limit_mb=2048", f"-max_len={MOST_BYTES.get(name, MOST_BYTES_ELSE)}", "-entropic=0", "-print_funcs=0", "-print_final_stats=1",
                 f"-artifact_prefix={kept}/{name}-"]
        done = subprocess.run(words, capture_output=True, text=True, errors="replace", env={**os.environ, **SANITIZERS, **QUICK_FOLDER})
        row.runs += runs_told(done.stderr)
        if done.returncode == 0:
            break
        found = finding(done.stderr, re.search(r"Test unit written to (\S+)", done.stderr), program)
        row.findings += [found] if found else []
        tries += 1
    row.seconds = time.monotonic() - start
    return row


def fuzz_program(options, folder, seconds):
    start = time.monotonic()
    runs, findings = documents.round_of(options.tool, options.source, folder, options.seed, seconds=seconds, keep=options.keep)
    return outcome.Row("mutated documents through the program", runs, time.monotonic() - start,
                       "exit code 0, 1, 2, 3 or 5; within 2 s; no escapes", findings)


def prove(options):
    seconds = options.seconds or LONG_ROUND_S
    names = options.reader or [*TARGETS, PROGRAM]
    share = {name: SHARES[name] / sum(SHARES[one] for one in names) for name in names}
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        corpora.make(options.tool, options.source, folder)
        (folder / PROGRAM).mkdir(exist_ok=True)

        def row_of(name):
            if name == PROGRAM:
                return fuzz_program(options, folder / PROGRAM, share[name] * seconds * options.jobs)
            return fuzz_target(options, name, folder / name, share[name] * seconds * options.jobs)

        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            rows = list(pool.map(row_of, names))
    return rows
