# SPDX-License-Identifier: MIT
"""JSON that no command writes: refused with its place, exit code 3, within two seconds, whatever it is."""

import json

from commands import SOURCE, TOOL, asked_for_json, ended, good, sanitized, Case
from prove_trust import documents

LONGEST_S = 10.0 if sanitized(TOOL) else 2.0  # a sanitizer takes time of its own: 2.1 s were seen

KINDS = ("comparison", "diagnosis", "effects", "export", "figure", "info", "joint", "joints", "metrics", "model",
         "recommendation", "simulation", "spectrum", "table", "track")


def head(kind):
    return {"schema": f"ripplenotch/{kind}/1"}


def table():
    return json.loads(good("design", "--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "18:180:54",
                           "--q", "0.25", "--json").stdout)


class Documents(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "log.csv").write_text(
            "time_s,velocity_deg_s,torque_nm\n" + "".join(f"{k / 1000},60,{k % 7}\n" for k in range(500)))

    def read(self, text, *words):
        (self.folder / "x.json").write_text(text)
        before = documents.processor_s()
        done = self.run_tool(*words)
        self.assertLess(documents.processor_s() - before, LONGEST_S, words)
        return done

    def refused(self, text, *parts, words=("report", "x.json")):
        done = self.read(text, *words)
        self.assertEqual(done.returncode, 3, done.stderr[-300:])
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1)
        for part in parts:
            self.assertIn(part, done.stderr)

    READERS = (("report", "x.json"), ("export", "x.json", "--to", "c-header"), ("design", "x.json", "--speed", "18:180:54"),
               ("filter", "log.csv", "--method", "switching,table=x.json"),
               ("simulate", "--model", "x.json", "--motion", "constant,speed=60deg/s,duration=1s", "--sample-rate", "1kHz"),
               ("diagnose", "log.csv", "--model", "x.json"))

    def test_deep_lists_and_objects_are_refused_by_every_reader(self):
        for opening, closing in (("[", "]"), ('{"a":', "}")):
            for depth in (25, 10000, 200000):
                for words in self.READERS:
                    self.refused(opening * depth + "1" + closing * depth, "x.json:1:", "more than 24 deep", words=words)
        self.refused('{"schema": "ripplenotch/metrics/1",\n "a": ' + "[" * 10000 + "]" * 10000 + "}", "x.json:2:", "deep")

    def test_numbers_that_overflow_are_named_with_their_place(self):
        for words in self.READERS:
            self.refused('{"schema": "x",\n  "gear_ratio": 1e400}', "x.json:2:17", "1e400", words=words)
        self.refused('{"schema": "ripplenotch/metrics/1", "a": -1.797e308}', "-1.797e308", "from -1e+100 to 1e+100")

    def test_a_name_twice_is_refused(self):
        for words in self.READERS:
            self.refused('{"schema": "x",\n "width": 1, "width": 1}', "x.json:2:", '"width" for a second time', words=words)
        many = ", ".join(f'"a{i}": 1' for i in range(900))
        self.refused('{"schema": "ripplenotch/metrics/1", ' + many + ', "a450": 2}', '"a450" for a second time')

    def test_size_and_count_are_bounded_before_any_work(self):
        self.refused('{"schema": "ripplenotch/metrics/1", "a": [' + "1," * 1100000 + "1]}", "more than 1000000 values")
        self.refused('{"schema": "ripplenotch/metrics/1", ' + ", ".join(f'"a{i}": 1' for i in range(1001)) + "}", "1000 members")
        self.refused('"' + "x" * (33 << 20) + '"', "bytes of JSON")

    def test_cut_and_foreign_texts_are_named_with_their_place(self):
        for text in ("", "[1, 2", '{"a" 1}', "NaN", "\x00", '"\x01"', "{}{}", '{"a": "\\ud800"}', "time_s,velocity_deg_s\n1,2\n"):
            self.refused(text, "x.json:1:", "expected")

    def test_a_report_takes_the_kinds_that_commands_write(self):
        for kind in KINDS:
            done = self.read(json.dumps({**head(kind), "a": 1}), "report", "x.json", "-o", "page.html", "--force")
            if kind not in ("joint", "joints", "table", "figure", "diagnosis"):  # these are read whole
                self.assertEqual(done.returncode, 0, kind + done.stderr)
        for schema in ("ripplenotch/nonsense/1", "ripplenotch/table/2", "", "x", 5, None, [], {}):
            self.refused(json.dumps({"schema": schema}), "x.json", "expected a result of ripplenotch")
        self.refused("[]", "expected a result of ripplenotch")

    def test_a_report_refuses_wrong_types_in_the_head(self):
        for name, value in (("inputs", 1), ("inputs", [1]), ("inputs", {"a": {}}), ("inputs", [{"name": 5}]), ("inputs", [{"sha256": "x"}]),
                            ("inputs", [{"name": "a", "x": 1}]), ("command", 5), ("tool", []), ("version", {})):
            self.refused(json.dumps({**head("metrics"), name: value}), f"x.json: {name}")

    def test_a_report_shows_values_of_any_type(self):
        for value in (None, True, 1, -0.0, 1e99, "x", [], {}, [[]], [{}], [[1, 2], [3, "a"]], [{"a": {"b": [1]}}, {"a": None}],
                      {"value": "x", "ci95": ["a", 1]}, {"value": 1, "stderr": "x", "ci95": [1]}, {"parameters": {"a": 1, "b": {"value": None}}},
                      [{"parameters": {"a": [], "b": {"value": {}, "ci95": [1, 2]}}, "where": {"x": 0, "y": []}}], [1, [2, [3]]]):
            for name in ("verdict", "gear_ratio", "lines", "value", "parameters", "where", "recording"):
                done = self.read(json.dumps({**head("metrics"), name: value}), "report", "x.json", "-o", "page.html", "--force")
                self.assertEqual(done.returncode, 0, f"{name}: {value}: {done.stderr}")

    def test_tables_are_bounded_before_they_are_measured(self):
        whole = table()
        notch = whole["bands"][0]["notches"][0]
        band = whole["bands"][0]
        for count in (65, 800, 4000):
            many = {**whole, "bands": [{**band, "notches": [{**notch, "order": i + 1} for i in range(count)]}]}
            self.refused(json.dumps(many), "expected at most 64", words=("export", "x.json", "--to", "c-header"))
        for count in (10001, 20000):
            self.refused(json.dumps({**whole, "bands": [band] * count}), "expected at most 10000", words=("export", "x.json", "--to", "c-header"))
        wide = {**whole, "orders": list(range(1, 65)), "bands": [
            {**band, "number": i + 1, "notches": [{**notch, "order": n + 1} for n in range(64)]} for i in range(100)]}
        self.refused(json.dumps(wide), words=("export", "x.json", "--to", "c-header"))

    def test_what_design_can_make_can_be_read(self):
        path = self.folder / "x.json"
        self.good("design", "--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "20:200:0.2", "--json", "-o", path)
        ended(0, self.read(path.read_text(), "export", "x.json", "--to", "json"))

    def test_models_and_figures_are_bounded(self):
        model = {**head("model"), "gear_ratio": 100, "effects": [{"effect": "inertia", "inertia_kgm2": 1}] * 257}
        self.refused(json.dumps(model), "effects has 257 entries", words=self.READERS[4])
        figure = {**head("figure"), "name": "x", "title": "x", "sentence": "", "columns": 1, "panels": [{}] * 17}
        self.refused(json.dumps(figure), "panels has 17 entries")


class Mutated(Case):
    def test_no_mutant_ends_in_a_fault_a_signal_or_in_two_seconds(self):
        count, findings = documents.round_of(TOOL, SOURCE, self.folder, seed=7, runs=250)
        self.assertGreaterEqual(count, 250)
        self.assertEqual(findings, [])


# Logs with numbers that no sensor gives, bytes that no text has, and comments where rows are counted.
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
