# SPDX-License-Identifier: MIT
"""Logs with numbers that no sensor gives, bytes that no text has, and comments where rows are counted."""


from commands import Case, asked_for_json

HEAD = b"time_s,velocity_deg_s,torque_nm,note\n"
COMMANDS = [asked_for_json(name, "log.csv") for name in ("info", "spectrum", "identify", "spectrum --track", "filter", "compare")]


def rows(count, note=b"abc", torque=b"%.2f"):
    return [b"%.3f,60,%s,%s\n" % (k / 1000, torque % (k % 7), note) for k in range(count)]


class Logs(Case):
    bytes_out = True

    def run_on(self, bytes_, *words):
        (self.folder / "log.csv").write_bytes(bytes_)
        return self.run_tool(*words)

    def test_a_number_that_would_overflow_names_its_row(self):
        for number in (b"1.797e308", b"-1e300", b"1.1e30"):
            lines = rows(2001)
            lines[1000] = b"1.000,60,%s,abc\n" % number
            for words in COMMANDS:
                done = self.run_on(HEAD + b"".join(lines), *words)
                self.assertEqual(done.returncode, 3, words)
                self.assertIn(b"log.csv:1002:10", done.stderr)
                self.assertIn(b"expected a number from -1e30 to 1e30", done.stderr)

    def test_large_numbers_below_that_give_finite_results(self):
        lines = rows(2001)
        lines[1000] = b"1.000,60,1e30,abc\n"
        for words in COMMANDS:
            done = self.run_on(HEAD + b"".join(lines), *words)
            self.assertIn(done.returncode, (0, 5), done.stderr)
            words_said = done.stdout.lower().replace(b"info", b"").replace(b"infer", b"")
            self.assertNotRegex(words_said, rb"\b-?nan\b|\binf\b", words)

    def test_a_control_byte_is_refused_wherever_it_stands(self):
        for byte in (b"\x00", b"\x1b", b"\x01", b"\x0b"):
            for row in (5, 1400, 15000):
                lines = rows(20000)
                lines[row] = lines[row].replace(b"abc", b"a%sc" % byte)
                for words in (("info", "log.csv"), ("filter", "log.csv", "--method", "none", "-o", "-")):
                    done = self.run_on(HEAD + b"".join(lines), *words)
                    self.assertEqual(done.returncode, 3, (byte, row, words))
                    self.assertIn(b"log.csv:%d:" % (row + 2), done.stderr)
                    self.assertIn(b"read the byte 0x%02x, expected text" % byte[0], done.stderr)
        lines = rows(20000)
        lines[15000] += b"# a \x1b[2J comment\n"
        self.assertEqual(self.run_on(HEAD + b"".join(lines), "info", "log.csv").returncode, 3)
        lines[15000] = b"15.000,60,1.00,\"a\x1bc\"\n"
        self.assertEqual(self.run_on(HEAD + b"".join(lines), "info", "log.csv").returncode, 3)

    def test_tabs_in_a_cell_are_text_wherever_they_stand(self):
        for row in (5, 15000):
            lines = rows(20000)
            lines[row] = lines[row].replace(b"abc", b"a\tc")
            done = self.run_on(HEAD + b"".join(lines), "filter", "log.csv", "--method", "none", "-o", "-")
            self.assertEqual((done.returncode, done.stdout), (0, HEAD + b"".join(lines)))

    def test_comments_are_no_rows_in_a_log_whose_first_column_nobody_reads(self):
        one = "foo\n" + "".join(f"{k % 7}.5\n" + ("# note\n\n" if k % 100 == 50 else "") for k in range(20000))
        done = self.run_on(one.encode(), "info", "log.csv", "--sample-rate", "1kHz")
        self.assertIn(b"log.csv: 20000 rows", done.stdout)
        for comment in ("#12.5,60,1.5", "# 12,60,1", "% 12,60,1", "//12,60,1", " # 1,60,1"):
            three = "index,velocity_deg_s,torque_nm\n" + "".join(f"{k},60,{k % 7}.5\n" + (comment + "\n" if k % 100 == 50 else "") for k in range(9000))
            done = self.run_on(three.encode(), "info", "log.csv", "--sample-rate", "1kHz", "--columns", "-,velocity,torque")
            self.assertIn(b"log.csv: 9000 rows", done.stdout, comment)

    def test_arrays_keep_the_same_bound(self):
        header = b"{'descr': [('time_s', '<f8'), ('velocity_deg_s', '<f8'), ('torque_nm', '<f8')], 'fortran_order': False, 'shape': (500,), }"
        header += b" " * (117 - len(header)) + b"\n"
        import struct
        for number in (1.797e308, -2e30, float("inf")):
            values = b"".join(struct.pack("<3d", k / 1000, 60.0, number if k == 300 else k % 7) for k in range(500))
            (self.folder / "log.npy").write_bytes(
                b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + values)
            done = self.run_tool("info", "log.npy")
            self.assertEqual(done.returncode, 3, done.stdout)
            self.assertIn(b"row 301", done.stderr)
