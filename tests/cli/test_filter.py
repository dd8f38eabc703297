# SPDX-License-Identifier: MIT
"""ripplenotch filter as its users meet it: bytes that pass, decimals, threads."""

import math
import re

import commands
from commands import DATA, ended

LOWPASS = "lowpass,cutoff=13rad/s"


class Case(commands.Case):
    bytes_out = True

    def write(self, name, text):
        path = self.folder / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path


class Bytes(Case):
    def test_every_byte_but_the_torque_cells_passes(self):
        head = "# made by hand\ntime [s];note;velocity [deg/s];\"torque [Nm]\";position [deg]\n"
        rows = [f"{k / 1000:.3f};a{k}  ;  9{k % 10},5;{2 + (k % 7) / 10};+{k}e-1".replace(".", ",") for k in range(400)]
        for end in ("\n", "\r\n"):
            log = self.write("log.csv", end.join((head + "\n".join(rows)).split("\n")) + end)
            out = self.good("filter", log, "--method", LOWPASS, "-q").stdout.decode()
            source = log.read_bytes().decode()
            cut = re.compile(r"^((?:[^;\n]*;){3})[^;\n]*;", re.M)
            self.assertEqual(cut.sub(r"\1T;", out.split(end, 2)[2]), cut.sub(r"\1T;", source.split(end, 2)[2]))
            self.assertEqual(out.split(end, 2)[:2], source.split(end, 2)[:2])
            self.assertRegex(out, r"\d,\d+;\+399e-1")   # the decimal mark of the log

    def test_decimals_shortest_input_or_a_number(self):
        log = DATA / "paper_90deg_s.csv"
        def column(how):
            out = self.good("filter", log, "--method", LOWPASS, "--decimals", how).stdout.decode().splitlines()
            return [line.split(",")[2] for line in out[1:]]
        exact, as_input, two = column("shortest"), column("input"), column("2")
        for a, b, c in zip(exact, as_input, two):
            self.assertRegex(b, r"^-?\d+\.\d{4}$")
            self.assertRegex(c, r"^-?\d+\.\d{2}$")
            self.assertLessEqual(abs(float(a) - float(b)), 0.5000001e-4)
            self.assertLessEqual(abs(float(a) - float(c)), 0.5000001e-2)


class Threads(Case):
    """A log that is well beyond the 4 MiB that one thread takes alone, cut into blocks that are worked on side by side."""

    ROWS = 240_000

    @classmethod
    def setUpClass(cls):
        rows = ["time_s,velocity_deg_s,torque_nm,note"]
        for k in range(cls.ROWS):
            rows.append(f"{k / 1000:.3f},{60 * math.sin(k / 3000):.6f},{math.sin(k / 40) + math.sin(k / 7000):.6f},n{k}")
        for k, comment in ((2, "# between rows, with, commas"), (170_000, "# a line, longer"), (cls.ROWS, "EOF")):
            rows.insert(k, comment)
        cls.text = "\n".join(rows) + "\n"

    def test_any_number_of_threads_gives_the_same_bytes_from_file_and_pipe(self):
        rows = self.text.splitlines()
        rows.append(rows.pop(rows.index("EOF")))  # an end mark stands at the end
        text = "\n".join(rows) + "\n"
        log = self.write("ended.csv", text)
        expected = None
        for threads in (1, 2, 3, 8):
            for source, stdin in ((log, None), ("-", text.encode())):
                got = self.good("filter", source, "--method", LOWPASS, "--threads", threads, "-q", stdin=stdin).stdout
                expected = expected or got
                self.assertEqual(got, expected)
        lines = expected.decode().splitlines()
        self.assertEqual(len(lines), len(rows))
        for mine, theirs in zip(lines, rows):
            if theirs.startswith(("#", "EOF", "time")):
                self.assertEqual(mine, theirs)
            else:
                self.assertEqual([cell for i, cell in enumerate(mine.split(",")) if i != 2],
                                 [cell for i, cell in enumerate(theirs.split(",")) if i != 2])

    def test_a_bad_row_is_named_with_its_line_and_what_came_before_is_the_same(self):
        rows = self.text.splitlines()
        for line, bad, said in ((190_000, "oops", "5: read 1 cells, expected 4"),
                                (self.ROWS + 1, "9999,1,1,n", "1: read a row after the line EOF")):
            text = "\n".join([*rows[:line], bad, *rows[line + 1:]]).encode()
            outputs = set()
            for threads in (1, 2, 5):
                done = ended(3, self.run_tool("filter", "-", "--method", LOWPASS, "--threads", threads, "-q", stdin=text))
                self.assertIn(f"standard input:{line + 1}:{said}", done.stderr.decode())
                outputs.add(done.stdout)
            self.assertEqual(len(outputs), 1)

    def test_time_that_runs_backward_between_blocks_is_found_at_its_line(self):
        rows = self.text.splitlines()
        for line in range(20_000, 140_000, 30_000):
            row = rows[line - 1]
            text = "\n".join([*rows[:line], "0.001" + row[row.index(","):], *rows[line:]]).encode()
            for threads in (1, 4):
                done = ended(3, self.run_tool("filter", "-", "--method", LOWPASS, "--threads", threads, "-q", stdin=text))
                self.assertIn(f"standard input:{line + 1}:1: read the time 0.001 after", done.stderr.decode())
