# SPDX-License-Identifier: MIT
"""ripplenotch filter as its users meet it: bytes that pass, gaps, rates, metrics, errors that leave nothing behind."""

import json
import math
import re

import commands
from commands import DATA, ended
from logs import sine

LOWPASS = "lowpass,cutoff=13rad/s"


class Case(commands.Case):
    bytes_out = True

    def refused(self, code, *words, stdin=None):
        done = self.run_tool(*words, stdin=stdin)
        message = done.stderr.decode()
        self.assertEqual(done.returncode, code, message)
        self.assertEqual(len(message.splitlines()), 1, message)
        return message

    def write(self, name, text):
        path = self.folder / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    def table(self, *words):
        words = words or ("--sample-rate", "1kHz", "--speed", "18:180:18")
        self.good("design", "--gear-ratio", 100, "--orders", "1,2", *words, "-o", "table.json", "--force")
        return self.folder / "table.json"

    def metrics(self, log, *words):
        self.good("filter", log, *words, "-o", "out.csv", "--metrics", "metrics.json", "--force")
        return json.loads((self.folder / "metrics.json").read_text())


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
        self.assertIn("shortest", self.refused(2, "filter", log, "--method", "none", "--decimals", "many"))


class Clock(Case):
    def test_a_log_without_time_needs_a_rate(self):
        text = "velocity_deg_s,torque_nm\n" + "90,3.5\n" * 500
        log = self.write("log.csv", text)
        self.assertIn("--sample-rate", self.refused(3, "filter", log, "--method", LOWPASS))
        self.good("filter", log, "--method", LOWPASS, "--sample-rate", "1kHz")


class Errors(Case):
    good_rows = sine(300)

    def broken(self):
        lines = self.good_rows.splitlines(keepends=True)
        swapped = lines[:100] + lines[150:151] + lines[100:]
        yield "cut_line", "".join(lines[:-1]) + "0.3,9"
        yield "text_in_number", self.good_rows.replace("0.120000,90.0", "0.120000,ninety")
        yield "nan", self.good_rows.replace("0.120000,90.0", "0.120000,nan")
        yield "wrong_column_count", self.good_rows.replace("0.120000,90.0", "0.120000,90.0,1,2")
        yield "empty", ""
        yield "only_header", lines[0]
        yield "two_times", self.good_rows.replace("time_s,velocity_deg_s", "time_s,time_ms")
        yield "backwards", "".join(swapped)
        yield "wrong_unit", self.good_rows.replace("torque_nm", "torque [parsec]")
        yield "binary", bytes(range(256)) * 40

    def test_a_broken_log_gives_one_message_with_the_file_and_no_output(self):
        for name, text in self.broken():
            with self.subTest(name):
                log = self.write(f"{name}.csv", text)
                # A unit that nobody knows is asked for; everything else is refused.
                code = 5 if name == "wrong_unit" else 3
                message = self.refused(code, "filter", log, "--method", LOWPASS, "-o", "out.csv", "--metrics", "m.json")
                self.assertIn(f"{name}.csv", message)
                self.assertEqual(sorted(p.name for p in self.folder.iterdir() if not p.name.endswith(f"{name}.csv")), [])
                log.unlink()


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
