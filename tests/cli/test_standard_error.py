# SPDX-License-Identifier: MIT
"""Standard error may be full, closed or gone: no exit code changes, no result is lost. Nothing said acts on a terminal."""

import math
import os
import re
import subprocess

from commands import OF_A_LOG, TOOL, Case, asked_for_json, ended

ACTING = [chr(c) for c in (*range(0x20), 0x7F, *range(0x80, 0xA0), 0x202E, 0x2028) if c != 0x0A]


class Streams(Case):
    # Words, and what they end with; the second warns before it works, the last talks all the time.
    RUNS = (
        (("nonsense",), 2),
        ((), 2),
        (("info", "missing.csv"), 4),
        (("info", "broken.csv"), 3),
        (("spectrum", "log.csv", "--track", "--gear-ratio", "100", "--orders", "1", "-o", "-"), 0),
        (("filter", "log.csv", "--method", "lowpass,cutoff=13Hz,order=1", "-v", "-o", "-"), 0),
        (("export", "--method", "lowpass,cutoff=13Hz,order=1", "--sample-rate", "1kHz", "--to", "c-header", "-o", "-"), 0),
    )

    def setUp(self):
        super().setUp()
        rows = "".join(f"{k / 1000},60,{(k % 7) / 7}\n" for k in range(2000))
        (self.folder / "log.csv").write_text("time_s,velocity_deg_s,torque_nm\n" + rows)
        (self.folder / "broken.csv").write_text("time_s,velocity_deg_s,torque_nm\n1,2\n")

    def run_with(self, words, **streams):
        return subprocess.run([TOOL, *words], cwd=self.folder, stdin=subprocess.DEVNULL, timeout=60, **streams)

    def each(self, name, **streams):
        for words, code in self.RUNS:
            with self.subTest(name, words=words):
                usual = ended(code, self.run_with(words, capture_output=True))
                then = self.run_with(words, stdout=subprocess.PIPE, **streams)
                self.assertEqual((then.returncode, then.stdout), (code, usual.stdout))

    def test_full(self):
        with open("/dev/full", "w") as full:
            self.each("full", stderr=full)

    def test_closed(self):
        self.each("closed", preexec_fn=lambda: os.close(2))

    def test_a_reader_that_has_gone(self):
        read, write = os.pipe()
        os.close(read)
        with os.fdopen(write, "wb") as gone:
            self.each("gone", stderr=gone)

    def test_a_file_never_becomes_standard_error(self):
        for words in (("filter", "log.csv", "--method", "lowpass,cutoff=13Hz,order=1", "-v", "-o", "out.csv", "--force"),):
            self.run_with(words, capture_output=True)
            usual = (self.folder / "out.csv").read_bytes()
            ended(0, self.run_with(words, preexec_fn=lambda: [os.close(stream) for stream in (0, 1, 2)]))
            self.assertEqual((self.folder / "out.csv").read_bytes(), usual)


# The library in a page of report, which is a megabyte; what came in is in the scripts that are shorter.
PLOTLY = re.compile(r"<script>(?:(?!</script>).){500000,}</script>", re.S)


class Visible(Case):
    bytes_out = True

    def write(self, name, text):
        path = os.path.join(os.fsencode(self.folder), name if isinstance(name, bytes) else name.encode())
        with open(path, "wb") as file:
            file.write(text if isinstance(text, bytes) else text.encode())

    def shown(self, *words):
        done = self.run_tool(*words)
        self.assertNotIn(done.returncode, (70, -6, -11))
        for stream in (done.stdout, done.stderr):
            text = stream.decode("utf-8")  # whatever came in, what goes out is UTF-8
            text = PLOTLY.sub("", text)  # holds control characters of its own
            for character in ACTING:
                self.assertNotIn(character, text, f"{words}: {text[:300]!r}")
        return done

    def test_contents_of_documents(self):
        for text in ('{"schema":"\\u001b]0;x\\u0007"}', '{"schema":"\\u009b31m"}', '{"schema":"\\u202eabc\\nripplenotch: all is well"}',
                     '{"\\u001b[2J": 1, "\\u001b[2J": 1}', '{"schema": "ripplenotch/table/1", "\\u001b[2J": 1}',
                     '{"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [{"effect": "\\u001b[2J"}]}',
                     '{"schema": "ripplenotch/model/1", "gear_ratio": "\\u001b[2J\\u202e", "effects": []}', "\x1b[2J", "\u009b31m"):
            self.write("x.json", text)
            for words in (("report", "x.json", "-q"), ("export", "x.json", "--to", "c-header"), ("design", "x.json"),
                          ("simulate", "--model", "x.json", "--motion", "constant,speed=60deg/s,duration=1s", "--sample-rate", "1kHz")):
                done = self.shown(*words)
                # One line where it is refused; a document that report can show is no reason for a word.
                self.assertEqual(done.stderr.count(b"\n"), 1 if done.returncode else 0, done.stderr)

    def test_names_of_files(self):
        log = "time_s,velocity_deg_s,torque_nm\n" + "".join(f"{k / 1000},60,{(k % 7) / 7}\n" for k in range(2000))
        for name in ("a\x1b[31mb.csv", "a\u009b31mb.csv", "a\u202eb.csv", "a\nripplenotch: all is well.csv", b"a\xff\xfeb.csv", "a\x7f.csv"):
            self.write(name, log)
            given = [asked_for_json(command, name) for command in OF_A_LOG if command not in ("recommend", "diagnose", "map")]
            for words in (*given, ("info", name), ("info", name, "-v"), ("identify", name), ("compare", name, "--method", "none"),
                          ("filter", name, "--method", "lowpass,cutoff=13Hz,order=1", "-v", "-o", "out.csv", "--force"),
                          ("filter", name, "--method", "switching,table=" + str(name)), ("info", str(name) + ".missing")):
                self.shown(*words)
        for words in (("info", "x.csv", "--columns", "a\x1b[31m"), ("filtre\x1b[2J",), ("info", "--\x1b[2J"), ("info", "x", "--format", "\x1b[2J"),
                      ("filter", "x.csv", "--method", "\x1b[2J,a=b"), ("design", "--gear-ratio", "\u009b5")):
            self.assertEqual(self.shown(*words).stderr.count(b"\n"), 1)

    def test_tables_keep_their_lines(self):
        rows = "".join(f"{k / 1000},60,{math.cos(2 * math.pi * 16.7 * k / 1000)}\n" for k in range(2000))
        self.write("log.csv", "time_s,velocity_deg_s,torque_nm\n" + rows)
        for words in (("spectrum", "log.csv", "-v", "--bins"), ("spectrum", "log.csv", "-v", "--bins", "--segment", "1s"),
                      ("spectrum", "log.csv", "--track", "--gear-ratio", "100", "--orders", "1", "-v")):
            done = self.shown(*words)
            self.assertGreater(done.stderr.count(b"\n"), 1)
            self.assertNotIn(b"\\n", done.stderr)

    def test_names_of_columns(self):
        rows = "".join(f"{k / 1000},60,{(k % 7) / 7},1\n" for k in range(2000))
        self.write("log.csv", "time_s,velocity_deg_s,torque_nm,a\u009b31m\u202eb\n" + rows)
        for words in (("info", "log.csv"), ("info", "log.csv", "--json"), ("info", "log.csv", "-v"),
                      ("info", "log.csv", "--columns", "torque=a\u009b31m\u202eb")):
            self.shown(*words)

    def test_an_escape_in_a_figure_cannot_reach_a_page(self):
        figure = ('{"schema": "ripplenotch/metrics/1", "command": "\\u001b[2J", "verdict": "\\u001b[2J\u202e", "\\u001b[2J": "\u009b"}')
        self.write("x.json", figure)
        self.assertEqual(self.shown("report", "x.json", "-q").returncode, 0)
