# SPDX-License-Identifier: MIT
"""Readers fed with what nobody would write: bytes and structures by libFuzzer within the readers, mutated documents through the
program itself.

The targets are built by `cmake --workflow --preset fuzz` (clang); where they are missing, only the second is done."""

import pathlib
import re
import subprocess
import tempfile
import time

from . import corpora, documents, outcome

TARGETS = {
    "logs": ("readers of text logs and arrays: vectors, plain, careful, pieces", "same rows or same words four ways; sanitizers"),
    "npz": ("archives of arrays", "same rows or same words at once and in pieces; sanitizers"),
    "mat": ("MAT files of versions 5 to 7", "the same"),
    "hdf5": ("HDF5 files", "the same"),
    "mcap": ("MCAP recordings", "the same"),
    "rosbag2": ("recordings in SQLite", "the same"),
    "raw": ("dumps told by --layout", "the same"),
    "packed": ("gzip, zstd, lz4, xz", "the same"),
    "documents": ("tables, models, joints, figures, diagnoses, pages", "an answer or a page, read again; sanitizers"),
    "arms": ("URDF, MuJoCo, Denavit-Hartenberg, axes", "an answer; sanitizers"),
    "texts": ("quantities, methods, numbers, visible names", "bounds, written and read again; sanitizers"),
}
# Where most of the time goes: what is slowest, and what strangers write most.
SHARES = {"logs": 0.25, "npz": 0.05, "mat": 0.05, "hdf5": 0.05, "mcap": 0.08, "rosbag2": 0.03, "raw": 0.02, "packed": 0.02,
          "documents": 0.2, "arms": 0.07, "texts": 0.07, "program": 0.11}
LONG_ROUND_S = 4 * 3600.0


def fuzz_target(options, name, corpus, seconds):
    """Row of one target, restarted after each finding until its time is over."""
    program = options.source / "build/fuzz/tests/fuzz" / f"fuzz_{name}"
    row = outcome.Row(TARGETS[name][0], 0, 0.0, TARGETS[name][1])
    if not program.exists():
        row.findings.append(f"{program.relative_to(options.source)} is not built: cmake --workflow --preset fuzz")
        return row
    kept = options.keep or pathlib.Path(tempfile.mkdtemp(prefix="prove-trust-"))
    kept.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    while (left := seconds - (time.monotonic() - start)) > 1 and len(row.findings) < 20:
        words = [str(program), str(corpus), f"-max_total_time={int(left)}", f"-seed={options.seed + len(row.findings)}", "-timeout=2",
                 "-rss_limit_mb=2048", "-max_len=20000", "-print_final_stats=1", f"-artifact_prefix={kept}/{name}-"]
        done = subprocess.run(words, capture_output=True, text=True, errors="replace")
        counted = re.search(r"number_of_executed_units:\s*(\d+)", done.stderr)
        row.runs += int(counted[1]) if counted else 0
        if done.returncode == 0:
            break
        written = re.search(r"Test unit written to (\S+)", done.stderr)
        said = re.search(r"(ERROR: \S+: [^\n]*|runtime error: [^\n]*|SUMMARY: [^\n]*|differ[^\n]*)", done.stderr)
        row.findings.append(f"{said[1] if said else done.stderr[-200:]} ({pathlib.Path(written[1]).name if written else 'no file'})")
    row.seconds = time.monotonic() - start
    return row


def fuzz_program(options, folder, seconds):
    start = time.monotonic()
    runs, findings = documents.round_of(options.tool, options.source, folder, options.seed, seconds=seconds, keep=options.keep)
    return outcome.Row("mutated documents through the program", runs, time.monotonic() - start,
                       "exit code 0, 1, 2, 3 or 5; within 2 s; no escapes", findings)


def prove(options):
    seconds = options.seconds or LONG_ROUND_S
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        corpora.make(options.tool, options.source, folder)
        rows = [fuzz_target(options, name, folder / name, SHARES[name] * seconds) for name in TARGETS]
        (folder / "program").mkdir()
        rows.append(fuzz_program(options, folder / "program", SHARES["program"] * seconds))
    return rows
