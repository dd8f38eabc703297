# SPDX-License-Identifier: MIT
"""The tool as a citizen of the shell: signals, terminals, progress."""

import os
import pathlib
import pty
import signal
import subprocess
import time
import unittest

from commands import DATA, TOOL, Case, ended, new_folder

LOG = DATA / "paper_90deg_s.csv"
LOWPASS = "lowpass,cutoff=13rad/s,order=1"


def open_terminal():
    """Both ends of a terminal; the test is skipped where the system has none to give (no /dev/pts)."""
    try:
        return pty.openpty()
    except OSError as error:
        raise unittest.SkipTest(f"SKIPPED: there is no terminal here ({error})")


class Pipes(Case):

    def has_begun(self, tool, folder):
        """Whether the tool has a file in the folder, with or without a name."""
        for descriptor in pathlib.Path(f"/proc/{tool.pid}/fd").iterdir():
            try:
                if str(folder) in os.readlink(descriptor):
                    return True
            except FileNotFoundError:
                pass
        return False

    def interrupted(self, folder, number, ignored=False):
        """The tool with a part of a log in a pipe that stays open, as it ends by a signal; what it left in the folder.
        Units are stated: it reads on for those that are not."""
        out = pathlib.Path(folder, "out.csv")
        tool = subprocess.Popen([TOOL, "filter", "-", "--method", LOWPASS, "--columns", "velocity,torque", "--no-header",
                                 "--sample-rate", "1kHz", "--unit", "velocity=deg/s", "--unit", "torque=Nm", "-o", out, "-q"],
                                stdin=subprocess.PIPE,
                                preexec_fn=(lambda: signal.signal(number, signal.SIG_IGN)) if ignored else None)
        tool.stdin.write(b"90,0.5\n90,0.25\n" * 700000)  # more than the opening that is looked at before rows are written
        tool.stdin.flush()
        deadline = time.monotonic() + 30
        while not self.has_begun(tool, out.parent) and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertTrue(self.has_begun(tool, out.parent), "there is a file to write to")
        tool.send_signal(number)
        if ignored:
            time.sleep(0.1)
            tool.stdin.close()
        code = tool.wait(timeout=30)
        tool.stdin.close()
        return code, [file.name for file in out.parent.iterdir()]

    def test_a_signal_leaves_no_temporary_file_behind(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number=number):
                self.assertEqual(self.interrupted(new_folder(self), number), (-number, []))

    def test_an_ignored_signal_stays_ignored(self):
        self.assertEqual(self.interrupted(self.folder, signal.SIGHUP, ignored=True), (0, ["out.csv"]))


class Terminals(unittest.TestCase):
    def on_terminal(self, words, stdin_is_terminal=False):
        ours, theirs = open_terminal()
        try:
            done = subprocess.run([TOOL, *words], stdin=theirs if stdin_is_terminal else subprocess.DEVNULL,
                                  stdout=theirs, stderr=subprocess.PIPE, timeout=20)
        finally:
            os.close(theirs)
            os.close(ours)
        return done

    def test_waiting_for_someone_to_type_a_log_is_refused(self):
        ended(2, self.on_terminal(["info", "-"], stdin_is_terminal=True), b"terminal")


class Progress(Case):
    """On a terminal, after a second, and gone afterwards."""

    def slow(self, words, terminal=True, seconds=1.8):
        """Runs with a reader of standard output that lets it wait; what came on standard error, and how it ended."""
        log = self.folder / "long.csv"
        head, *rows = LOG.read_text().splitlines()
        speed = "\n".join(row.split(",", 1)[1] for row in rows)
        log.write_text(head.split(",", 1)[1] + "\n" + "\n".join([speed] * 60) + "\n")
        ours, theirs = open_terminal() if terminal else (None, None)
        process = subprocess.Popen([TOOL, "filter", log, "--sample-rate", "1kHz", "--method", LOWPASS, *words],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=theirs if terminal else subprocess.PIPE,
                                   env=dict(os.environ, TERM="xterm"))
        if terminal:
            os.close(theirs)
        time.sleep(seconds)
        process.stdout.read()
        process.stdout.close()
        code = process.wait(timeout=60)
        said = b"" if terminal else process.stderr.read()
        if process.stderr:
            process.stderr.close()
        while terminal:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            said += piece
        if terminal:
            os.close(ours)
        return code, said.decode()

    def test_work_longer_than_a_second_shows_share_rate_and_time_left_and_tidies_up(self):
        code, said = self.slow([])
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"filter: reading \[=*>? *\] +\d+ %  [0-9.]+ [kM]?B/s  \d+ s left")
        self.assertTrue(said.endswith("\r\x1b[K"), repr(said[-40:]))
        for line in said.split("\r"):
            self.assertLess(len(line.replace("\x1b[K", "")), 80)

    def test_nothing_is_shown_to_who_is_no_terminal_or_wants_quiet_or_for_quick_work(self):
        self.assertEqual(self.slow([], terminal=False), (0, ""))
        self.assertEqual(self.slow(["-q"]), (0, ""))
        self.assertEqual(self.slow([], seconds=0.0), (0, ""))
