# SPDX-License-Identifier: MIT
"""Commands that work on several threads, watched by the thread sanitizer, on logs long enough for threads to start; and the
tests of the module `filter`.

The program for it is built by `cmake --workflow --preset tsan`. Where it is missing, helgrind of valgrind watches the one that
libraries can be preloaded to, of the dev build, through `filter` alone: it does not know what guards a static variable of a
function, and calls the table of the spreading kernel a race in everything else. How many threads a command had is counted while it runs: one that never had a
second one proves nothing."""

import gzip
import os
import pathlib
import pty
import shutil
import subprocess
import tempfile
import threading
import time

from prove_trust.outcome import Row
from prove_trust.workshop import GEAR, Workshop

ROWS = 200_000  # 5.6 MB of text: filter starts threads behind the first 4 MiB
FEW_ROWS = 8_000  # for commands that start threads on any log, and take long when watched
JOINTS = ("a", "b", "c")
RACES = ("ThreadSanitizer", "Possible data race", "lock order", "Thread #")
HELGRIND = ("valgrind", "--tool=helgrind", "-q", "--history-level=approx", "--error-exitcode=66")
REPORTED = 66  # exit code of a program with a report
BOTH = ("--method", "lowpass,cutoff=13Hz,order=2")
WAYS = {
    "filter --table": ("log.csv", "--table", "table.json", "-o", "out.csv", "--metrics", "out.json"),
    "filter --threads 8": ("log.csv", "--table", "table.json", "--threads", "8", "-o", "out.csv"),
    "filter of gzip": ("log.csv.gz", "--method", "fixed,centers=25Hz:50Hz,q=0.25", *GEAR, "-o", "out.csv"),
    "filter of a pipe": ("-", "--method", "oscillator", *GEAR, "-o", "-"),
    "filter --append, tracking": ("log.csv", "--method", "tracking", *GEAR, "--append", "-o", "out.csv"),
    "filter in two passes": ("log.csv", "--method", "subtract", *GEAR, "-o", "out.csv"),
    "filter of all joints": ("wide.csv", "--joint", "all", *BOTH, *GEAR, "-o", "out.csv"),
    "filter into an array": ("log.csv", *BOTH, "-o", "out.npy"),
    "filter of an array": ("log.npy", *BOTH, "--threads", "4", "-o", "again.npy"),
    "filter of a row that is wrong": ("wrong.csv", *BOTH, "-o", "out.csv"),
    "identify": ("short.csv",),
    "identify of a steady joint": ("steady.csv",),
    "identify of gzip": ("short.csv.gz",),
    "spectrum by order": ("short.csv", "--domain", "order"),
    "features": ("short.csv",),
    "diagnose": ("short.csv", "--model", "auto"),
}
REFUSED = {"filter of a row that is wrong": 3}


def put_logs(shop):
    """Beside the log of the workshop: packed, with a wrong row far behind, of several joints, at one speed, as an array."""
    log = (shop.folder / "log.csv").read_bytes()
    (shop.folder / "log.csv.gz").write_bytes(gzip.compress(log, 1))
    lines = log.decode().splitlines(keepends=True)
    short = "".join(lines[:1 + FEW_ROWS])
    (shop.folder / "short.csv").write_text(short)
    (shop.folder / "short.csv.gz").write_bytes(gzip.compress(short.encode()))
    lines[-5000] = lines[-5000].replace(",", ",x", 1)
    (shop.folder / "wrong.csv").write_text("".join(lines))
    with open(shop.folder / "wide.csv", "w", encoding="ascii") as wide:
        wide.write("time_s," + ",".join(f"{joint}_velocity_deg_s,{joint}_torque_nm" for joint in JOINTS) + "\n")
        for line in log.decode().splitlines()[1:]:
            time_s, velocity, torque = line.split(",")[:3]
            wide.write(",".join([time_s, *[f"{velocity},{torque}"] * len(JOINTS)]) + "\n")
    made = [("simulate", *GEAR[:2], "--ripple", "1:0.8Nm", "--motion", "constant,speed=60deg/s,duration=4s", "--motion",
             "constant,speed=90deg/s,duration=4s", "--sample-rate", "1kHz", "--noise", "0.05Nm", "-o", "steady.csv"),
            ("filter", "log.csv", "--method", "none", "-o", "log.npy")]
    for words in made:
        done = shop.run(*words)
        if done.returncode != 0:
            raise SystemExit(f"prove-trust: {words}: {done.stderr.decode()}")


class Count(threading.Thread):
    """The most threads that a process had at once."""

    def __init__(self, process):
        super().__init__(daemon=True)
        self.process, self.most = process, 0
        self.start()

    def run(self):
        while self.process.poll() is None:
            try:
                self.most = max(self.most, len(os.listdir(f"/proc/{self.process.pid}/task")))
            except FileNotFoundError:
                return
            time.sleep(0.0005)


def run_one(tool, shop, words, terminal=None):
    """Exit code, what it said, and the most threads it had."""
    process = subprocess.Popen([*tool, *words], cwd=shop.folder, env=shop.environment({}), stdin=shop.log_as_pipe(words),
                               stdout=subprocess.DEVNULL, stderr=terminal or subprocess.PIPE)
    count = Count(process)
    said = process.communicate()[1] if terminal is None else b""
    code = process.wait()
    count.join()
    shop.close_pipes()
    return code, (said or b"").decode("utf-8", "replace"), count.most


def with_bar(tool, shop):
    """A command that shows its progress, on a terminal of its own: exit code, what is on it, threads."""
    mine, its = pty.openpty()
    shown = []

    def look():
        try:
            while piece := os.read(mine, 4096):
                shown.append(piece)
        except OSError:  # the other end is closed
            pass

    watching = threading.Thread(target=look, daemon=True)
    watching.start()
    code, _, most = run_one(tool, shop, ("diagnose", "short.csv", "--model", "auto"), its)
    os.close(its)
    watching.join(5.0)
    os.close(mine)
    return code, b"".join(shown).decode("utf-8", "replace"), most


def judged(what, expected, alone, got):
    """A row of one command. alone: threads of a program that starts none, those of the sanitizer."""
    code, said, most = got
    row = Row(f"`{what}`", 1, 0.0, f"no race; {max(1, most - alone + 1)} threads at once")
    if code == REPORTED or any(word in said for word in RACES):
        row.findings.append(said[:2000].replace("\n", " "))
    elif code != expected:
        row.findings.append(f"exit code {code}: {said[-300:]}")
    elif most <= alone and expected == 0:
        row.checked = "no race; one thread"
    return row


def tests_of_filter(build):
    row = Row("tests of the module `filter`", 0, 0.0, "no race")
    program = build / "tests/filter/test_filter"
    done = subprocess.run([program], capture_output=True, text=True, errors="replace", cwd=build)
    row.runs = 1
    if done.returncode != 0 or RACES[0] in done.stderr:
        row.findings.append((done.stdout + done.stderr)[-2000:].replace("\n", " "))
    return row


def timed(make, *words):
    start = time.monotonic()
    row = make(*words)
    row.seconds = time.monotonic() - start
    return row


def prove(options):
    build = options.source / "build/tsan"
    watched = [build / "ripplenotch"]
    if not watched[0].exists():
        watched = [*HELGRIND, options.source / "build/dev/tests/faults/ripplenotch_preloadable"]
    if not (watched[-1].exists() and (len(watched) == 1 or shutil.which(HELGRIND[0]))):
        return [Row("commands on several threads", 0, 0.0, "", ["not built: cmake --workflow --preset tsan"])]
    rows, until = [], time.monotonic() + (options.seconds or 3600.0)
    with tempfile.TemporaryDirectory() as folder:
        shop = Workshop(options.tool, options.source, folder, ROWS)
        put_logs(shop)
        alone = run_one(watched, shop, ("info", "short.csv"))[2]
        for name, words in WAYS.items():
            if time.monotonic() > until or (len(watched) > 1 and not name.startswith("filter")):
                break
            shop.remove(("out.csv", "out.json", "out.npy", "again.npy"))
            command = name.split(" ", 1)[0]
            rows.append(timed(lambda: judged(name, REFUSED.get(name, 0), alone, run_one(watched, shop, (command, *words)))))
        if time.monotonic() < until and len(watched) == 1:
            rows.append(timed(lambda: judged("diagnose, its progress shown", 0, alone, with_bar(watched, shop))))
    if (build / "tests/filter/test_filter").exists():
        rows.append(timed(tests_of_filter, build))
    return rows
