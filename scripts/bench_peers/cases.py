# SPDX-License-Identifier: MIT
"""What is compared: logs, commands, rounds. Results are plain dictionaries, so that they can be kept and printed again."""

import json
import os
import pathlib
import shlex
import shutil
import subprocess
from dataclasses import asdict

from . import measure
from .measure import Side

os.environ["RIPPLENOTCH_SYNC"] = "none"  # the others do not wait for the disk either
TABLE_WORDS = ["--gear-ratio", "40", "--orders", "1,2", "--sample-rate", "2kHz", "--speed", "20:200:20", "--q", "5"]
# An array says neither names nor units; the CSV logs' header says both.
COLUMNS = ["--columns", "time,velocity,torque", "--unit", "velocity=deg/s"]
TOOL = "ripplenotch"
PIECES = ("--segment", "4.096s")
MODEL = pathlib.Path(__file__).resolve().parents[2] / "data" / "paper_model.json"


class Bench:
    def __init__(self, options, peers, say):
        self.tool, programs = pathlib.Path(options.tool), pathlib.Path(options.benchmarks)
        self.make_log, self.run_once = programs / "bench_make_log", programs / "bench_run_once"
        self.benchmarks = programs / "bench_ripplenotch"
        self.folder, self.peers, self.say = pathlib.Path(options.work), peers, say
        self.rows, self.rounds, self.slow = options.rows, options.rounds, options.slow_rounds
        self.table = self.folder / "table.json"
        subprocess.run([self.tool, "design", *TABLE_WORDS, "-o", self.table, "--force"], check=True)

    def log(self, format, rows, joints=1):
        """Made once; `format` is 6, shortest or npy."""
        path = self.folder / f"{format}_{joints}_{rows}.{'npy' if format == 'npy' else 'csv'}"
        if not path.exists():
            self.say(f"making {path.name}")
            with open(path, "wb") as sink:
                subprocess.run([self.make_log, format, str(joints), str(rows)], stdout=sink, check=True)
        return path

    def out(self, side, log):
        return self.folder / f"out_{''.join(c for c in side if c.isalnum())}{log.suffix}"

    def filter(self, log, *words):
        out = self.out(TOOL, log)
        return Side(TOOL, [self.tool, "filter", log, "--table", self.table, "-o", out, "-q", *words], out)

    def peer(self, name, words, log, most_runs=1000):
        return Side(name, [word if word != "OUT" else self.out(name, log) for word in words], self.out(name, log), most_runs)

    def compare(self, name, log, sides):
        """One case: every side's runs, and how far the torques of the tool and of the first peer that filters are apart."""
        self.say(f"{name}, {log.stat().st_size / 1e6:.0f} MB")
        runs, failed = measure.in_turn(self.run_once, sides, self.rounds, self.say)
        result = {"mb": log.stat().st_size / 1e6, "failed": failed,
                  "runs": {side: [asdict(one) for one in taken] for side, taken in runs.items()}}
        filters = [side for side in sides if side.name in runs and "SciPy" in side.name]
        if filters and TOOL in runs and log.suffix == ".csv":
            result["differs_nm"] = largest_difference(sides[0].makes, filters[0].makes)
        for side in sides:
            side.makes.unlink(missing_ok=True)
        return result

    def long_csv(self, digits):
        log = self.log(digits, self.rows)
        sides = [self.filter(log, "--decimals", digits), self.peer("cp", ["cp", log, "OUT"], log)]
        if self.peers.has("pandas"):
            words = self.peers.script("pandas_scipy.py", log, "OUT", digits)
            sides.append(self.peer("pandas + SciPy", words, log, self.slow))
        for name in ("Polars", "DuckDB"):
            if self.peers.has(name):
                words = self.peers.node(f"{name.lower()}.mjs", log, "OUT", digits)
                sides.append(self.peer(f"{name}, no filter", words, log))
        return self.compare(f"CSV, {digits} digits", log, sides)

    def long_npy(self):
        log = self.log("npy", self.rows)
        sides = [self.filter(log, *COLUMNS), self.peer("cp", ["cp", log, "OUT"], log)]
        if self.peers.has("SciPy"):
            sides.append(self.peer("NumPy + SciPy", self.peers.script("numpy_scipy.py", log, "OUT"), log))
        return self.compare("npy", log, sides)

    def short_csv(self):
        log = self.log("6", 100_000)
        sides = [self.filter(log, "--decimals", "6")]
        if self.peers.has("Octave"):
            sides.append(self.peer("Octave", self.peers.octave(log, "OUT"), log))
        if self.peers.has("pandas"):
            sides.append(self.peer("pandas + SciPy", self.peers.script("pandas_scipy.py", log, "OUT", "6"), log))
        return self.compare("CSV of 100,000 rows", log, sides)

    def kernels(self):
        """Processor seconds inside the process, of the library and of SciPy; processes alternate."""
        log, ours, theirs = self.log("npy", 10_000_000), {}, {}
        for _ in range(self.rounds):
            done = subprocess.run([self.benchmarks, "--json", "--rounds", "3"], capture_output=True, text=True, check=True)
            for one in json.loads(done.stdout):
                ours.setdefault(one["name"], {"work": one["work"], "cpu_s": []})["cpu_s"] += one["cpu_s"]
            if self.peers.has("SciPy"):
                done = subprocess.run([str(w) for w in self.peers.script("scipy_kernels.py", log, "3")], capture_output=True,
                                      text=True, check=True)
                for name, one in json.loads(done.stdout).items():
                    theirs.setdefault(name, {"work": one["work"], "cpu_s": []})["cpu_s"] += one["cpu_s"]
        return {"ripplenotch": ours, "scipy": theirs}

    def analysis(self, rows):
        """The commands that look for lines, the tool alone, on a log at one speed and on one of moves of four seconds."""
        found = {}
        for motion, log in self.simulated(rows).items():
            for words in (["spectrum", log, *PIECES], ["spectrum", log], ["spectrum", log, "--domain", "order"], ["identify", log]):
                if motion == "moves" or "order" not in words:
                    self.analyse(found, words, motion, rows)
        # In pieces a log is not held, however long: ten times the rows, the same memory.
        for motion, log in self.simulated(10 * rows, ["one speed"]).items():
            self.analyse(found, ["spectrum", log, *PIECES], motion, 10 * rows)
            log.unlink()
        return found

    def analyse(self, found, words, motion, rows):
        out = self.folder / "out_analysis.json"
        name = " ".join([words[0], *words[2:]])
        runs, failed = measure.in_turn(self.run_once, [Side(name, [self.tool, *words, "-q", "-o", out], out)], self.rounds, self.say)
        found[f"{name}, {motion}, {rows} rows"] = {"rows": rows, "failed": failed, "runs": [asdict(one) for one in runs.get(name, [])]}

    def simulated(self, rows, wanted=("one speed", "moves")):
        seconds = rows / 1000
        motions = {"one speed": ["--motion", f"constant,speed=60deg/s,duration={seconds}s"],
                   "moves": [word for k in range(int(seconds / 4)) for word in
                             ("--motion", f"poly6,to={-90 if k % 2 == 0 else 90}deg,duration=4s" + (",from=90deg" if k == 0 else ""))]}
        logs = {name: self.folder / f"{name.replace(' ', '_')}_{rows}.npy" for name in wanted}
        for name, log in logs.items():
            subprocess.run([self.tool, "simulate", "--model", MODEL, *motions[name], "--sample-rate", "1kHz", "--noise", "0.05Nm",
                            "--seed", "1", "-o", log, "--force", "-q"], check=True)
        return logs

    def pipes(self):
        """From a pipe to a pipe; the copy is by the same two cats without the tool between them."""
        log = self.log("6", self.rows)
        sides = []
        for name, between in ((TOOL, f"{quoted(self.tool)} filter - --table {quoted(self.table)} --decimals 6 -o - -q |"), ("cat", "")):
            out = self.out(f"{name} of pipes", log)
            sides.append(Side(name, ["sh", "-c", f"cat {quoted(log)} | {between} cat > {quoted(out)}"], out))
        return self.compare("CSV through pipes", log, sides)

    def growth(self, row_counts, joint_counts):
        """Rows of one joint, then joints of one length; CSV with 6 decimals; the tool, and cp, which meets the same pages."""
        cases = [(1, rows) for rows in row_counts] + [(joints, self.rows // 10) for joints in joint_counts]
        found = []
        for joints, rows in cases:
            if room_for(self.folder, joints, rows):
                log = self.log("6", rows, joints)
                side = self.filter(log, "--decimals", "6", *(["--joint", "all"] if joints > 1 else []))
                copy = self.peer("cp", ["cp", log, "OUT"], log)
                runs, failed = measure.in_turn(self.run_once, [side, copy], self.rounds if rows <= 10_000_000 else 3, self.say)
                for one in (side, copy):
                    one.makes.unlink(missing_ok=True)
                found.append({"joints": joints, "rows": rows, "mb": log.stat().st_size / 1e6, "failed": failed,
                              "runs": [asdict(one) for one in runs.get(TOOL, [])], "copies": [asdict(one) for one in runs.get("cp", [])]})
                if rows > 10_000_000:
                    log.unlink()
            else:
                found.append({"joints": joints, "rows": rows, "mb": 0, "runs": [], "copies": [], "failed": {TOOL: "not enough room on disk"}})
        return found


def quoted(path):
    return shlex.quote(str(path))


def room_for(folder, joints, rows):
    return shutil.disk_usage(folder).free > 3.2 * rows * (8 + 20 * joints)


def largest_difference(mine, theirs):
    """Over the torque columns of some thousand rows all along both outputs, Nm."""
    worst = 0.0
    with open(mine) as first, open(theirs) as second:
        for number, (a, b) in enumerate(zip(first, second)):
            if number % 2003 == 1:
                worst = max(worst, abs(float(a.split(",")[2]) - float(b.split(",")[2])))
    return worst


def all_cases(bench, row_counts, joint_counts):
    return {"rows": bench.rows, "fixed": bench.long_csv("6"), "full": bench.long_csv("shortest"), "npy": bench.long_npy(),
            "pipes": bench.pipes(), "short": bench.short_csv(), "kernels": bench.kernels(), "analysis": bench.analysis(bench.rows // 10),
            "growth": bench.growth(row_counts, joint_counts)}
