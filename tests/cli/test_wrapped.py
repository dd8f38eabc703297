# SPDX-License-Identifier: MIT
"""Verdicts: one line in a pipe or a file, wrapped at the width of a terminal."""

import fcntl
import os
import pty
import struct
import subprocess
import termios
import threading
import unittest

from commands import DATA, GEAR, TOOL, SharedCase

MOVE = DATA / "paper_move_2s.csv"
METHODS = ("--method", "oscillator", "--method", "tracking")
COMMANDS = {
    "identify": ("identify", DATA / "paper_60deg_s.csv", DATA / "paper_120deg_s.csv"),
    "recommend": ("recommend", MOVE, *GEAR),
    "compare": ("compare", MOVE, *GEAR, *METHODS),
    "diagnose": ("diagnose", MOVE, "--model", "auto"),
}


def on_terminal(columns, *words, cwd=None, code=0):
    """Standard output of the tool where it is a terminal of so many columns; 0: it does not say."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
    said = []

    def listen():
        try:
            while piece := os.read(ours, 65536):
                said.append(piece)
        except OSError:  # nobody has the other end any longer
            pass

    listener = threading.Thread(target=listen)
    listener.start()
    done = subprocess.run([TOOL, *map(str, words)], stdin=subprocess.DEVNULL, stdout=theirs, stderr=subprocess.PIPE, cwd=cwd, timeout=120)
    os.close(theirs)
    listener.join()
    os.close(ours)
    if done.returncode != code:
        raise AssertionError(f"{words}: {done.stderr}")
    return b"".join(said).decode().replace("\r\n", "\n")


class Verdicts(SharedCase):
    def test_in_a_pipe_and_in_a_file_the_first_line_is_the_verdict(self):
        for name, words in COMMANDS.items():
            with self.subTest(name):
                first = self.good(*words).stdout.split("\n")[0]
                self.assertGreater(len(first), 70)
                self.assertTrue(first.endswith("."), first)
                if name == "diagnose":  # its result goes to standard output alone
                    continue
                self.assertEqual(on_terminal(60, *words, "-o", f"{name}.txt", cwd=self.folder), "")
                self.assertEqual((self.folder / f"{name}.txt").read_text().split("\n")[0], first)

    def test_on_a_terminal_it_is_wrapped_at_its_width_and_at_80_where_that_is_not_known(self):
        for name, words in COMMANDS.items():
            first = self.good(*words).stdout.split("\n")[0]
            for columns, width in ((60, 60), (97, 97), (0, 80)):
                with self.subTest(name=name, columns=columns):
                    rest, lines = first, []
                    text = on_terminal(columns, *words, cwd=self.folder).split("\n")
                    while rest:
                        lines.append(text.pop(0))
                        self.assertTrue(rest.startswith(lines[-1]), lines)
                        rest = rest[len(lines[-1]):].removeprefix(" ")
                    self.assertLessEqual(max(map(len, lines)), width)
                    for line, after in zip(lines, lines[1:]):
                        self.assertGreater(len(line) + 1 + len(after.split(" ")[0]), width)

    def test_the_name_of_a_joint_counts(self):
        rows = [line.split(",") for line in MOVE.read_text().split()]
        wide = ["time_s," + ",".join(f"{joint}_{name}" for joint in ("shoulder", "elbow") for name in rows[0][1:])]
        wide += [",".join([row[0], *row[1:], *row[1:]]) for row in rows[1:]]
        (self.folder / "wide.csv").write_text("\n".join(wide) + "\n")
        for name in ("identify", "recommend", "compare"):
            words = (name, "wide.csv", *(GEAR if name != "identify" else ()), *(METHODS if name == "compare" else ()))
            with self.subTest(name):
                lines = on_terminal(70, *words, cwd=self.folder).split("\n")
                found = [line for line in lines if line.startswith(("shoulder: ", "elbow: "))]
                self.assertEqual(len(found), 2)
                self.assertLessEqual(max(map(len, found)), 70)


class Width(unittest.TestCase):
    def test_no_line_is_wider_than_a_hundred_columns_but_what_is_there_to_be_copied(self):
        fixed = [f"oscillator,gear-ratio=100,orders=1:2,amplitudes={a}:0.5,phases={a}12345:0.012345678" for a in (0.7, 0.8)]
        move = str(DATA / "paper_move_2s.csv")
        text = on_terminal(100, "compare", move, "--gear-ratio", "100", "--orders", "1,2", "--truth", move, "--crossover", "12Hz", "--max-delay", "40ms",
                           *(word for name in (*fixed, "lowpass,cutoff=13rad/s,order=1", "fixed,centers=25Hz:50Hz,q=0.25", "lowpass,cutoff=1.894387654321Hz,order=1")
                             for word in ("--method", name)), code=1)
        self.assertNotIn("-0.0 ", text)
        told = [line for line in text.split("\n") if " is --method " not in line]
        self.assertLessEqual(max(map(len, told)), 100, text)
        for letter, method in zip("AB", fixed):
            self.assertIn(f"\noscillator {letter} is --method {method}\n", text)
            self.assertIn(f"\noscillator {letter}  ", text)
        for figure in ("to 0.5 %", "lag at 12 Hz", "order 2", "residual", "error"):
            self.assertIn(figure, text)
