# SPDX-License-Identifier: MIT
"""The tool as a citizen of the shell: pipes, early ends, terminals, full disks, files that exist."""

import json
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


def shell(command):
    environment = dict(os.environ, PATH=f"{pathlib.Path(TOOL).parent}:{os.environ['PATH']}")
    return subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True, env=environment,
                          stdin=subprocess.DEVNULL, timeout=60)


class Provenance(Case):
    def test_where_a_result_goes_and_how_much_is_told_is_no_part_of_its_command(self):
        plain = f"ripplenotch info {LOG}"
        target = self.folder / "info.json"
        for words in (f"-o {target}", f"-o{target} -qv", f"-vqo {target}", f"-qo{target}", f"--output={target} -q -v",
                      f"--output {target} --quiet --verbose --json"):
            ended(0, shell(f"{plain} {words} --force"))
            self.assertEqual(json.loads(target.read_text())["command"], plain, words)
        done = shell(f"ripplenotch info --json -- {LOG} {LOG} -qv")
        self.assertIn(b"-qv: ", done.stderr)  # behind -- it is a name
        done = shell(f"ripplenotch info --json -v --columns -,velocity,torque --sample-rate 1kHz --no-header --skip-lines 1 {LOG}")
        self.assertIn("--columns -,velocity,torque", json.loads(done.stdout)["command"])


class Pipes(Case):
    def test_a_log_flows_through_filter_into_spectrum(self):
        done = ended(0, shell(f"cat {LOG} | ripplenotch filter --method {LOWPASS} - | ripplenotch spectrum - --json"))
        self.assertEqual(json.loads(done.stdout)["schema"], "ripplenotch/spectrum/1")

    def test_a_pipe_and_a_file_give_the_same_bytes(self):
        from_file = shell(f"ripplenotch filter --method {LOWPASS} {LOG}")
        from_pipe = shell(f"cat {LOG} | ripplenotch filter --method {LOWPASS} -")
        dribbled = shell(f"dd if={LOG} bs=997 status=none | ripplenotch filter --method {LOWPASS} -")
        self.assertEqual(from_file.returncode, 0, from_file.stderr)
        self.assertEqual(from_file.stdout, from_pipe.stdout)
        self.assertEqual(from_file.stdout, dribbled.stdout)

    def test_a_binary_log_of_unknown_length_is_whole_in_a_pipe(self):
        # Its header holds the number of rows, which a pipe of text tells only at its end.
        target = self.folder / "out.npy"
        self.assertEqual(shell(f"ripplenotch filter --method {LOWPASS} {LOG} -o {target}").returncode, 0)
        piped = ended(0, shell(f"cat {LOG} | ripplenotch filter --method {LOWPASS} - --output-format npy | cat"))
        self.assertEqual(piped.stdout, target.read_bytes())
        read = shell(f"cat {LOG} | ripplenotch filter --method none - --output-format npy | ripplenotch info - --json")
        self.assertEqual(json.loads(read.stdout)["rows"], 4000)

    def test_a_reader_that_leaves_early_ends_the_tool_quietly(self):
        done = shell(f"(for i in $(seq 200); do tail -n +2 {LOG} | cut -d, -f2-; done) "
                     f"| ripplenotch filter --columns velocity,torque,position --no-header --sample-rate 1kHz -q "
                     f"--method {LOWPASS} - | head -n 2; test ${{PIPESTATUS[2]}} -eq 0")
        self.assertEqual(done.stderr, b"")
        self.assertEqual(len(done.stdout.splitlines()), 2)

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

    def test_a_full_disk_is_exit_code_4_with_a_reason(self):
        ended(4, shell(f"ripplenotch filter --method {LOWPASS} {LOG} > /dev/full"), b"No space left")


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


class Files(Case):
    def test_nothing_is_overwritten_unasked(self):
        target = self.folder / "out.csv"
        target.write_text("mine")
        command = f"ripplenotch filter --method {LOWPASS} {LOG} -o {target}"
        ended(4, shell(command), b"--force")
        self.assertEqual(target.read_text(), "mine")
        self.assertEqual(shell(command + " --force").returncode, 0)
        self.assertNotEqual(target.read_text(), "mine")
        self.assertEqual(os.listdir(self.folder), ["out.csv"])

    def test_a_folder_that_cannot_be_written_is_exit_code_4(self):
        ended(4, shell(f"ripplenotch filter --method {LOWPASS} {LOG} -o /proc/none/out.csv"), b"/proc/none/out.csv")
