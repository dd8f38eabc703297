# SPDX-License-Identifier: MIT
"""Ways to break a log: one clear message with file, line and remedy, exit code 3, and no output left behind."""

import os

from commands import Case, ended

HEAD = b"time_s,velocity_deg_s,torque_nm\n"
GOOD = HEAD + b"".join(b"%.3f,60,%.2f\n" % (k / 1000, k % 7) for k in range(50))

# What is broken, the bytes, and what the message must hold: the place, what was read or expected, and what to do.
WAYS = {
    "cut line": (GOOD + b"0.050,6", ["log.csv:52:8", "read 2 cells, expected 3", "last line is cut off", "remove it"]),
    "text in a number": (GOOD.replace(b"0.010,60,", b"0.010,6O,"), ["log.csv:12:7", "'6O'", "'velocity_deg_s'", "expected a number", "remove the line"]),
    "nan": (GOOD.replace(b"0.010,60,3.00", b"0.010,60,nan"), ["log.csv:12:10", "'nan'", "finite number", "--hold-bad-values"]),
    "wrong column count": (GOOD.replace(b"0.010,60,", b"0.010,60,1,"), ["log.csv:12:", "read 4 cells, expected 3", "remove the line"]),
    "empty file": (b"", ["log.csv: ", "empty file", "expected rows of numbers", "check what wrote it"]),
    "only a header": (HEAD, ["log.csv:1", "only a header", "expected rows of numbers"]),
    "two time columns": (b"time_s,timestamp,velocity_deg_s,torque_nm\n" +
                         b"".join(b"%.3f,%.3f,60,%d\n" % (k / 1000, 7 + k / 1000, k % 7) for k in range(50)),
                         ["log.csv", "'time_s' (column 1) and 'timestamp' (column 2)", "could each be the time", "--columns time=time_s"]),
    "a second time that stands still": (GOOD.replace(b"velocity_deg_s", b"time_ms,velocity_deg_s", 1).replace(b",60,", b",60,60,"),
                         ["log.csv", "'time_ms' (column 2) and 'time_s' (column 1)", "does not run forward", "--columns time=time_s"]),
    "time running backwards": (GOOD.replace(b"0.010,", b"0.002,"), ["log.csv:12:1", "time 0.002 after 0.009", "run forward", "--sample-rate"]),
    "binary rubbish": (bytes(range(256)) * 20, ["log.csv:1:1", "byte 0x00", "expected text", "--format"]),
}


class Ways(Case):
    bytes_out = True

    def check(self, name, *words):
        bytes_, wanted = WAYS[name]
        (self.folder / "log.csv").write_bytes(bytes_)
        done = self.run_tool(*words)
        message = done.stderr.decode("utf-8", "replace")
        self.assertEqual(done.returncode, 3, f"{name}: {message}")
        lines = [line for line in message.splitlines() if "warning:" not in line]
        self.assertEqual(len(lines), 1, f"{name}: one message, got {message}")
        for part in wanted:
            self.assertIn(part, lines[0], name)
        self.assertEqual(done.stdout, b"", name)

    def test_info_names_each(self):
        for name in WAYS:
            with self.subTest(name):
                self.check(name, "info", "log.csv")

    def test_filter_names_each_and_leaves_no_file(self):
        for name in WAYS:
            for output in ("out.csv", "out.npy"):
                with self.subTest(name, output=output):
                    self.check(name, "filter", "log.csv", "--method", "none", "-o", output)
                    self.assertEqual(sorted(os.listdir(self.folder)), ["log.csv"])

    def test_a_pipe_is_called_standard_input(self):
        (self.folder / "log.csv").write_bytes(WAYS["text in a number"][0])
        with open(self.folder / "log.csv", "rb") as pipe:
            done = self.run_tool("info", "-", stdin=pipe)
        self.assertEqual(done.returncode, 3)
        self.assertIn(b"standard input:12:7", done.stderr)

    def test_damage_far_behind_the_part_that_was_sniffed(self):
        rows = b"".join(b"%.3f,60,%.2f\n" % (k / 1000, k % 7) for k in range(200000))
        (self.folder / "log.csv").write_bytes(HEAD + rows + b"200.0,60\n")
        ended(3, self.run_tool("filter", "log.csv", "--method", "none", "-o", "out.csv"), b"log.csv:200002:")
        self.assertEqual(sorted(os.listdir(self.folder)), ["log.csv"])

    def test_the_good_log_reads(self):
        (self.folder / "log.csv").write_bytes(GOOD)
        self.assertEqual(self.run_tool("info", "log.csv").returncode, 0)
