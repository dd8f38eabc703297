# SPDX-License-Identifier: MIT
"""What becomes of files: docs/reliability.md."""

import hashlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import time
import unittest

from commands import DATA, TOOL, Case, ended


LOWPASS = ("--method", "lowpass,cutoff=13rad/s,order=1")
NOT_SYNCED = {"RIPPLENOTCH_SYNC": "none"}
GEAR = ("--gear-ratio", "100", "--orders", "1,2")


class InFolder(Case):
    def setUp(self):
        super().setUp()
        shutil.copy(DATA / "paper_90deg_s.csv", self.folder / "log.csv")

    def hash_of(self, name):
        return hashlib.sha256((self.folder / name).read_bytes()).hexdigest()


class Hashes(InFolder):
    def test_a_result_that_tells_a_hash_has_it_whichever_way_it_is_asked_for(self):
        raw = self.hash_of("log.csv")
        for command in (("identify",), ("spectrum", "--track", *GEAR), ("spectrum",), ("map", *GEAR), ("compare", *GEAR, *LOWPASS)):
            for number, output in enumerate((("--json",), ("-o", "NAME"), ("--plot", "NAME"))):
                name = f"{len(command)}_{command[0]}_{number}.json"
                done = ended(0, self.run_tool(command[0], "log.csv", *command[1:], *(w.replace("NAME", name) for w in output)))
                words = json.loads(done.stdout if output == ("--json",) else (self.folder / name).read_text())
                self.assertEqual(words["inputs"][0]["sha256"], raw, f"{command} {output}")

    def test_of_a_named_pipe_the_hash_is_that_of_what_it_said(self):
        os.mkfifo(self.folder / "pipe")
        raw = (self.folder / "log.csv").read_bytes()
        writer = threading.Thread(target=lambda: (self.folder / "pipe").write_bytes(raw), daemon=True)
        writer.start()
        done = self.run_tool("identify", "pipe", "--json")
        writer.join()
        self.assertEqual(json.loads(done.stdout)["inputs"][0]["sha256"], hashlib.sha256(raw).hexdigest(), done.stderr)


class ChangingLogs(InFolder):
    def test_a_log_that_is_cut_while_it_is_read_gives_no_result(self):
        head, *lines = (self.folder / "log.csv").read_text().splitlines(keepends=True)
        cells = [line.split(",", 1)[1] for line in lines]
        with open(self.folder / "long.csv", "w", encoding="ascii") as log:
            log.write(head)
            for turn in range(40):
                log.writelines(f"{turn * 4 + k / 1000:.3f},{cell}" for k, cell in enumerate(cells))
        whole = (self.folder / "long.csv").read_bytes()
        begin, refused = time.monotonic(), 0
        self.assertEqual(self.run_tool("filter", "long.csv", *LOWPASS, "-o", "out.csv", environment=NOT_SYNCED).returncode, 0)
        a_run_s = time.monotonic() - begin  # more under a sanitizer, or beside other work
        for run in range(30):
            (self.folder / "long.csv").write_bytes(whole)
            (self.folder / "out.csv").unlink(missing_ok=True)
            running = subprocess.Popen([TOOL, "filter", "long.csv", *LOWPASS, "-o", "out.csv"],
                                       cwd=self.folder, env={**os.environ, **NOT_SYNCED}, stderr=subprocess.PIPE, text=True)
            try:
                running.wait(run / 25 * a_run_s)
            except subprocess.TimeoutExpired:
                pass
            os.truncate(self.folder / "long.csv", len(whole) // 3)
            words = running.communicate()[1]
            if running.returncode == 0:
                self.assertEqual((self.folder / "out.csv").read_bytes().count(b"\n"), whole.count(b"\n"))
                continue
            # Cut before it was opened, it is a log like any other, if the cut is between two rows.
            self.assertIn(running.returncode, (3, 4), words)
            self.assertFalse((self.folder / "out.csv").exists())
            if running.returncode == 4:
                refused += 1
                self.assertIn("changed while it was read", words)
        self.assertGreater(refused, 0)


class LogsThatChangeBetweenPasses(InFolder):
    """Commands that hash nothing (their result tells no hash) and read a log twice, stopped while they read."""

    COMMANDS = (("identify",), ("info",), ("spectrum", "--segment", "1s", "-o", "out.csv"))

    def setUp(self):
        super().setUp()
        # Longer than what is kept from one pass to the next.
        ended(0, self.run_tool("simulate", *GEAR[:2], "--inertia", "0.4", "--motion", "constant,speed=90deg/s,duration=2500s",
                               "--sample-rate", "1kHz", "-o", "long.npy"))
        self.size = (self.folder / "long.npy").stat().st_size

    def read_by(self, process):
        for line in pathlib.Path(f"/proc/{process.pid}/io").read_text().splitlines():
            if line.startswith("rchar:"):
                return int(line.split()[1])
        return 0

    def changed_while_read(self, words, change):
        """Exit code and message where the process could be stopped within its first pass."""
        (self.folder / "out.csv").unlink(missing_ok=True)
        running = subprocess.Popen([TOOL, words[0], "long.npy", *words[1:]], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        try:
            while running.poll() is None and self.read_by(running) < self.size // 4:
                pass
            running.send_signal(signal.SIGSTOP)
            in_time = running.poll() is None and self.read_by(running) < 3 * self.size // 4
            if in_time:
                change(self.folder / "long.npy")
        finally:
            running.send_signal(signal.SIGCONT)
        said = running.communicate()[1]
        return (running.returncode, said) if in_time else None

    @unittest.skipUnless(pathlib.Path("/proc/self/io").exists(), "no /proc here, which tells how far a process has read")
    def refuse(self, change):
        for words in self.COMMANDS:
            whole = (self.folder / "long.npy").read_bytes()
            for _ in range(20):
                found = self.changed_while_read(words, change)
                (self.folder / "long.npy").write_bytes(whole)
                if found:
                    break
            self.assertIsNotNone(found, f"{words}: never stopped in time")
            self.assertEqual(found[0], 4, f"{words}: {found[1]}")
            self.assertIn("changed while it was read", found[1])
            self.assertFalse((self.folder / "out.csv").exists())

    def test_one_that_is_written_to_in_place_is_refused_though_its_size_and_time_are_as_before(self):
        def other_bytes(path):
            before = path.stat()
            with open(path, "r+b") as log:
                log.seek(300)
                log.write(b"\0" * 8)
            os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
        self.refuse(other_bytes)

    def test_one_that_ends_early_is_refused(self):
        self.refuse(lambda path: os.truncate(path, self.size // 2))


class Places(InFolder):

    @unittest.skipUnless(os.geteuid() == 0, "only root may give files away")
    def test_owner_and_group_are_kept(self):
        (self.folder / "out.csv").write_text("old")
        os.chown(self.folder / "out.csv", 1234, 2345)
        ended(0, self.run_tool("filter", "log.csv", *LOWPASS, "--force", "-o", "out.csv"))
        status = (self.folder / "out.csv").stat()
        self.assertEqual((status.st_uid, status.st_gid), (1234, 2345))

    @unittest.skipUnless(shutil.which("strace"), "no strace here, which counts the calls")
    def test_a_result_is_on_the_disk_before_it_has_its_name(self):
        for settings, synced in (({}, True), (NOT_SYNCED, False)):
            traced = subprocess.run(["strace", "-f", "-e", "trace=fsync,linkat,rename", TOOL, "filter", "log.csv", *LOWPASS,
                                     "--force", "-o", "out.csv"], cwd=self.folder, capture_output=True, text=True,
                                    env={**os.environ, **settings, "ASAN_OPTIONS": "detect_leaks=0"})  # they are not looked for under strace
            calls = [name for line in traced.stderr.splitlines() for name in ("fsync", "linkat", "rename") if name + "(" in line]
            self.assertEqual(traced.returncode, 0, traced.stderr)
            if synced:
                self.assertEqual((calls[0], calls[-1]), ("fsync", "fsync"), calls)
            else:
                self.assertNotIn("fsync", calls)
