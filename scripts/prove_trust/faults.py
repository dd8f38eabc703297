# SPDX-License-Identifier: MIT
"""The system under the tool fails: disks, memory, reads, threads, streams. Every run ends with a promised exit code and one
message, and leaves its outputs whole or not at all."""

import pathlib
import random
import resource
import subprocess
import tempfile
import time

from prove_trust.outcome import Row
from prove_trust.workshop import Workshop

ROWS = 6_000
FILE, MEMORY = 4, 6  # exit codes, docs/commands/README.md


def preloaded(library, **faults):
    return {"LD_PRELOAD": str(library), **{f"FAULT_{name}": str(value) for name, value in faults.items()}}


class Saboteur:
    """Runs commands of a workshop under faults; `library` is the one that is preloaded."""

    def __init__(self, shop, library):
        self.shop, self.library, self.whole = shop, library, {}

    def learn(self, name):
        words, outputs = self.shop.commands()[name]
        if name not in self.whole:
            self.shop.remove(outputs)
            self.shop.put_old_file()
            done = self.shop.run(*words)
            if done.returncode != 0:
                raise SystemExit(f"prove-trust: {words}: {done.stderr.decode()}")
            self.whole[name] = self.shop.contents(outputs)
        return words, outputs, self.whole[name]

    def run(self, name, codes, limit=None, **faults):
        """One run: its exit code, and sentences about what is wrong with it."""
        words, outputs, whole = self.learn(name)
        self.shop.remove(outputs)
        self.shop.put_old_file()
        before = self.shop.contents(outputs)
        settings = preloaded(self.library, **faults) if faults else {}
        done = self.shop.run(*words, settings=settings, preexec_fn=limit)
        self.shop.close_pipes()
        wrong = []
        if done.returncode not in codes:
            wrong.append(f"exit code {done.returncode}: {done.stderr.decode()[:300]}")
        if done.returncode not in (0, 1) and done.stderr.count(b"\n") != 1:
            wrong.append(f"not one message: {done.stderr.decode()[:300]!r}")
        now = self.shop.contents(outputs)
        for output in outputs:
            allowed = (whole[output],) if done.returncode == 0 else (whole[output], before.get(output))
            if now.get(output) not in allowed:
                wrong.append(f"{output} is neither whole nor as before")
        self.shop.remove(outputs)
        if litter := self.shop.litter(()):
            wrong.append(f"left {', '.join(litter)}")
            self.shop.remove(litter)
        how = " ".join(f"FAULT_{key}={value}" for key, value in faults.items())
        return done.returncode, [f"{how} {' '.join(words)}: {sentence}" for sentence in wrong]


def step_by_step(saboteur, name, fault, codes, steps, until, **more):
    """The 1st, 2nd, ... call fails, until a run is through without any; `steps` of them where there are more, drawn."""
    row = Row(f"{fault.lower().replace('_at', '').replace('_from', ' for good')}, `{name}`", 0, 0.0,
              "exit code, one message, outputs complete or unchanged, no other file")
    start, draw = time.monotonic(), random.Random(1)
    last = 1
    while saboteur.run(name, (0, *codes), **{fault: last}, **more)[0] != 0 and last < 1 << 20:
        last *= 2
    places = list(range(1, last + 1))
    if len(places) > steps:
        places = sorted(draw.sample(places, steps))
    for place in places:
        if time.monotonic() > until:
            break
        row.findings += saboteur.run(name, (0, *codes), **{fault: place}, **more)[1]
        row.runs += 1
    row.seconds = time.monotonic() - start
    return row


def limited_file(size):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    return limit


def full_disk(saboteur, name, runs, until):
    """Files may not grow beyond a limit, drawn below what the command writes."""
    row = Row(f"disk full, `{name}`", 0, 0.0, "exit code 4, one message, no other file")
    start, draw = time.monotonic(), random.Random(2)
    saboteur.learn(name)
    size = (saboteur.shop.folder / "log.csv").stat().st_size // 2
    while row.runs < runs and time.monotonic() < until:
        row.findings += saboteur.run(name, (FILE, 0), limit=limited_file(draw.randrange(1, size)))[1]
        row.runs += 1
    row.seconds = time.monotonic() - start
    return row


def closed_stream(shop, words, stream):
    """Exit code of a command without one of its standard streams."""
    redirect = {0: "<&-", 1: ">&-", 2: "2>&-", "full": ">/dev/full"}[stream]
    line = " ".join(f"'{word}'" for word in (shop.tool, *words))
    return subprocess.run(["sh", "-c", f"{line} {redirect}"], cwd=shop.folder, capture_output=True, timeout=60,
                          env=shop.environment({})).returncode


def streams(shop):
    row = Row("standard streams closed or full", 0, 0.0, "exit code 4 where data are lost, else 0")
    start = time.monotonic()
    lost = {("info", "log.csv"): {0: 0, 1: FILE, 2: 0, "full": FILE},
            ("info", "-"): {0: FILE},
            ("filter", "log.csv", "--method", "switching,table=table.json"): {0: 0, 1: FILE, 2: 0, "full": FILE},
            ("filter", "-", "--method", "switching,table=table.json"): {0: FILE}}
    for words, codes in lost.items():
        for stream, code in codes.items():
            got = closed_stream(shop, words, stream)
            row.runs += 1
            if got != code:
                row.findings.append(f"{' '.join(words)}, stream {stream}: exit code {got}, not {code}")
    row.seconds = time.monotonic() - start
    return row


def short_round(saboteur, steps, until):
    rows = [streams(saboteur.shop), full_disk(saboteur, "filter", steps, until)]
    if not saboteur.library:
        return rows
    for name in ("filter", "identify", "spectrum of a pipe"):
        rows.append(step_by_step(saboteur, name, "MALLOC_AT", (MEMORY,), steps, until))
        rows.append(step_by_step(saboteur, name, "MALLOC_FROM", (MEMORY,), steps, until))
        rows.append(step_by_step(saboteur, name, "READ_AT", (FILE,), steps, until))
        rows.append(step_by_step(saboteur, name, "WRITE_AT", (FILE,), steps, until))
    for name in ("filter", "filter, in place of an old file"):
        for fault in ("SYNC_AT", "LINK_AT", "RENAME_AT", "WRITE_AT"):
            rows.append(step_by_step(saboteur, name, fault, (FILE,), steps, until))
            rows.append(step_by_step(saboteur, name, fault, (FILE,), steps, until, NAMELESS=1))
    for fault in ("READ_SHORT", "WRITE_SHORT", "THREADS", "NAMELESS"):
        row = Row(f"{fault.lower().replace('_', ' ')}, every command", 0, 0.0, "the same bytes")
        start = time.monotonic()
        for name in saboteur.shop.commands():
            row.findings += saboteur.run(name, (0,), **{fault: 1})[1]
            row.runs += 1
        row.seconds = time.monotonic() - start
        rows.append(row)
    return rows


def prove(options):
    build = pathlib.Path(options.tool).resolve().parent
    library, tool = build / "tests/faults/libfaults.so", build / "tests/faults/ripplenotch_preloadable"
    if not (library.exists() and tool.exists()):
        print(f"prove-trust faults: {library} is not built; only what needs no preloading is tried")
        library, tool = None, options.tool
    with tempfile.TemporaryDirectory() as folder:
        shop = Workshop(pathlib.Path(tool).resolve(), options.source, folder, ROWS)
        return short_round(Saboteur(shop, library), 400, time.monotonic() + (options.seconds or 3600.0))
