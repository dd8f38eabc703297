# SPDX-License-Identifier: MIT
"""The tool as a citizen of the shell: pipes, early ends, terminals, full disks, files that exist."""

import json
import os
import pathlib
import pty
import subprocess
import tempfile
import unittest

TOOL = os.environ["RIPPLENOTCH"]
DATA = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"]) / "data"
LOG = DATA / "paper_90deg_s.csv"
LOWPASS = "lowpass,cutoff=13rad/s,order=1"


def shell(command):
    environment = dict(os.environ, PATH=f"{pathlib.Path(TOOL).parent}:{os.environ['PATH']}")
    return subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True, env=environment,
                          stdin=subprocess.DEVNULL, timeout=60)


class Pipes(unittest.TestCase):
    def test_a_log_flows_through_filter_into_spectrum(self):
        done = shell(f"cat {LOG} | ripplenotch filter --method {LOWPASS} - | ripplenotch spectrum - --json")
        self.assertEqual(done.returncode, 0, done.stderr)
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
        with tempfile.TemporaryDirectory() as folder:
            target = pathlib.Path(folder, "out.npy")
            self.assertEqual(shell(f"ripplenotch filter --method {LOWPASS} {LOG} -o {target}").returncode, 0)
            piped = shell(f"cat {LOG} | ripplenotch filter --method {LOWPASS} - --output-format npy | cat")
            self.assertEqual(piped.returncode, 0, piped.stderr)
            self.assertEqual(piped.stdout, target.read_bytes())
        read = shell(f"cat {LOG} | ripplenotch filter --method none - --output-format npy | ripplenotch info - --json")
        self.assertEqual(json.loads(read.stdout)["rows"], 4000)

    def test_a_reader_that_leaves_early_ends_the_tool_quietly(self):
        done = shell(f"(for i in $(seq 200); do tail -n +2 {LOG} | cut -d, -f2-; done) "
                     f"| ripplenotch filter --columns velocity,torque,position --no-header --sample-rate 1kHz -q "
                     f"--method {LOWPASS} - | head -n 2; test ${{PIPESTATUS[2]}} -eq 0")
        self.assertEqual(done.stderr, b"")
        self.assertEqual(len(done.stdout.splitlines()), 2)

    def test_a_full_disk_is_exit_code_4_with_a_reason(self):
        done = shell(f"ripplenotch filter --method {LOWPASS} {LOG} > /dev/full")
        self.assertEqual(done.returncode, 4)
        self.assertIn(b"No space left", done.stderr)


class Terminals(unittest.TestCase):
    def on_terminal(self, words, stdin_is_terminal=False):
        ours, theirs = pty.openpty()
        try:
            done = subprocess.run([TOOL, *words], stdin=theirs if stdin_is_terminal else subprocess.DEVNULL,
                                  stdout=theirs, stderr=subprocess.PIPE, timeout=20)
        finally:
            os.close(theirs)
            os.close(ours)
        return done

    def test_binary_to_a_terminal_is_refused(self):
        done = self.on_terminal(["filter", str(LOG), "--method", LOWPASS, "--output-format", "npy"])
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"terminal", done.stderr)

    def test_waiting_for_someone_to_type_a_log_is_refused(self):
        done = self.on_terminal(["info", "-"], stdin_is_terminal=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"terminal", done.stderr)


class Files(unittest.TestCase):
    def test_nothing_is_overwritten_unasked(self):
        with tempfile.TemporaryDirectory() as folder:
            target = pathlib.Path(folder, "out.csv")
            target.write_text("mine")
            command = f"ripplenotch filter --method {LOWPASS} {LOG} -o {target}"
            refused = shell(command)
            self.assertEqual(refused.returncode, 4)
            self.assertIn(b"--force", refused.stderr)
            self.assertEqual(target.read_text(), "mine")
            self.assertEqual(shell(command + " --force").returncode, 0)
            self.assertNotEqual(target.read_text(), "mine")
            self.assertEqual(os.listdir(folder), ["out.csv"])

    def test_a_folder_that_cannot_be_written_is_exit_code_4(self):
        done = shell(f"ripplenotch filter --method {LOWPASS} {LOG} -o /proc/none/out.csv")
        self.assertEqual(done.returncode, 4)
        self.assertIn(b"/proc/none/out.csv", done.stderr)


if __name__ == "__main__":
    unittest.main()
