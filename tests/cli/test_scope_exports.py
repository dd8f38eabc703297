# SPDX-License-Identifier: MIT
"""One recording as TwinCAT Scope exports it: every option of the export, one answer. The options are those of
https://infosys.beckhoff.com/content/1033/te13xx_tc3_scopeview/6193063051.html."""

import functools
import itertools
import json
import shlex
import struct

from commands import Case, ended, run
from test_log_dialects import RATE, RATIO, ROWS


STEP_MS = 1000.0 / RATE
FILETIME = 133_600_000_000_000_000
CHANNELS = {"MAIN.ActVelo": ("°/s (Velocity)", lambda r: r.velocity), "MAIN.ActTorque": ("mNm (Torque)", lambda r: 1e3 * r.torque),
            "MAIN.ActPos": ("° (Angle)", lambda r: r.position)}
KEYS = {"SymbolComment": "", "Data-Type": "REAL64", "SampleTime[ms]": None, "VariableSize": "8", "SymbolBased": "True",
        "IndexGroup": "16448", "IndexOffset": "385048", "SymbolName": None, "NetID": "192.168.1.2.1.1", "Port": "851",
        "Offset": "0", "ScaleFactor": "1", "BitMask": "0xffffffffffffffff", "Unit": None, "Unit ScaleFactor": "1",
        "Unit Offset": "0"}


class Group:
    """Channels of one sample time; `every` rows of the recording make one of its samples, `until` is its last row."""

    def __init__(self, names, every=1, until=None):
        self.names, self.every = names, every
        self.rows = ROWS[:until:every]


@functools.cache
def cells(name, every, until, decimal):
    take = CHANNELS[name][1]
    return [f"{take(row):.6f}".replace(".", decimal) for row in Group((), every, until).rows]


@functools.cache
def times(every, until, stamps):
    rows = Group((), every, until).rows
    if stamps == "filetime":
        return [str(FILETIME + 20_000 * row.k) for row in rows]
    return [f"{STEP_MS * row.k:g}" for row in rows]


def export(groups, separator="\t", decimal=",", head="full", timelines="each", stamps="ms", gaps="short", end="\r\n", mark=False,
           tag=True, keys=None):
    """`groups` as (names, every, until). `gaps`: how a group with fewer samples is written. "short": on the first rows, shorter
    rows behind; "after": on the first rows, empty cells behind; "empty": beside its time, empty cells between; "fill": beside
    its time, repeated between."""
    groups = [(names, every, until) for names, every, until in groups]
    if timelines == "each":
        groups = [([name], every, until) for names, every, until in groups for name in names]
    said = dict(KEYS, **(keys or {}))

    def line(key, of):
        texts = [] if timelines != "none" else [key]
        for names, every, _ in groups:
            texts += ([key] if timelines != "none" else []) + [of(name, every) for name in names]
        return separator.join(texts)

    def value(key):
        if key == "SampleTime[ms]":
            return lambda name, every: f"{STEP_MS * every:g}"
        if key == "SymbolName":
            return lambda name, every: name
        if key == "Unit":
            return lambda name, every: CHANNELS[name][0]
        return lambda name, every: said[key][name] if isinstance(said[key], dict) else said[key]

    lines = []
    if head != "names":
        lines += [separator.join(("Name", "axis_run")), separator.join(("File", "C:\\scope\\axis_run.csv")),
                  separator.join(("Starttime of export", str(FILETIME), "Montag, 2. Mai 2022", "15:56:24.376")),
                  separator.join(("Endtime of export", str(FILETIME + 90_000_000), "Montag, 2. Mai 2022", "15:56:33.376")),
                  "", ""]
    lines.append(line("Name", lambda name, every: name))
    if head != "names":
        kept = KEYS if head == "full" else ("SampleTime[ms]", "Unit")
        lines += [line(key, value(key)) for key in kept]
        lines.append("")
    blocks = []
    for names, every, until in groups:
        columns = [times(every, until, stamps)] if timelines != "none" else []
        blocks.append(list(zip(*columns, *(cells(name, every, until, decimal) for name in names))))
    if gaps == "short":
        rows = [sum((block[k] for block in blocks if k < len(block)), ()) for k in range(max(map(len, blocks)))]
    else:
        rows = []
        for k in range(len(ROWS)):
            row = ()
            for block, (names, every, until) in zip(blocks, groups):
                at, rest = divmod(k, every)
                width = len(block[0])
                if gaps == "after":
                    row += block[k] if k < len(block) else ("",) * width
                elif gaps == "fill":
                    row += block[min(at, len(block) - 1)]
                else:
                    row += block[at] if rest == 0 and at < len(block) else ("",) * width
            rows.append(row)
    lines += [separator.join(row) for row in rows]
    text = end.join(lines) + end + ("EOF" + end if tag else "")
    return (b"\xef\xbb\xbf" if mark else b"") + text.encode()


ALL = list(CHANNELS)
RATES = {
    "one rate": ([(ALL, 1, None)], "short"),
    "the position ends earlier": ([(ALL[:2], 1, None), (ALL[2:], 1, len(ROWS) - 40)], "short"),
    "the position ends earlier, empty cells": ([(ALL[:2], 1, None), (ALL[2:], 1, len(ROWS) - 40)], "empty"),
    "the position is slower": ([(ALL[:2], 1, None), (ALL[2:], 2, None)], "short"),
    "the position is slower, shifted": ([(ALL[:2], 1, None), (ALL[2:], 2, None)], "empty"),
    "the position is slower, filled": ([(ALL[:2], 1, None), (ALL[2:], 2, None)], "fill"),
    "the position is slower and stands first": ([(ALL[2:], 2, None), (ALL[:2], 1, None)], "after"),
    "the motion is slower": ([(ALL[1:2], 1, None), (ALL[::2], 4, None)], "short"),
}
SEPARATORS = [(separator, decimal) for separator, decimal in itertools.product("\t;,:", ".,") if separator + decimal != ",,"]


class EveryOptionOfTheExport(Case):
    def answer(self, content, *words):
        path = self.folder / "scope.csv"
        path.write_bytes(content)
        return run("identify", path, "--json", "-q", *words)

    def check(self, content, *words):
        done = ended(0, self.answer(content, *words))
        found = json.loads(done.stdout)
        self.assertAlmostEqual(found["gear_ratio"]["value"], RATIO, delta=0.1)
        self.assertAlmostEqual(found["sample_rate_hz"], RATE, delta=0.5)
        self.assertEqual(found["doubts"], [], done.stdout[:1500])
        torque = max(line["amplitude_nm"] for line in found["lines"])
        self.assertAlmostEqual(torque, 0.4, delta=0.02)

    def test_the_same_answer_whatever_was_chosen(self):
        count = 0
        for (separator, decimal), head, timelines, stamps, rates in itertools.product(
                SEPARATORS, ("full", "some", "names"), ("each", "shared"), ("ms", "filetime"), RATES):
            groups, gaps = RATES[rates]
            with self.subTest(separator=separator, decimal=decimal, head=head, timelines=timelines, stamps=stamps, rates=rates):
                words = ("--unit", "torque=mNm") if head == "names" else ()
                self.check(export(groups, separator, decimal, head, timelines, stamps, gaps), *words)
                count += 1
        print(f"\n{count} exports")

    def test_without_times_the_sample_time_of_the_head_counts(self):
        for separator, decimal in SEPARATORS:
            with self.subTest(separator=separator, decimal=decimal):
                self.check(export([(ALL, 1, None)], separator, decimal, timelines="none"))

    def test_line_ends_marks_and_tags_make_no_difference(self):
        for end, mark, tag in itertools.product(("\n", "\r\n"), (False, True), (False, True)):
            with self.subTest(end=end, mark=mark, tag=tag):
                self.check(export([(ALL, 1, None)], end=end, mark=mark, tag=tag))


class WhatAnExportDoesNotSay(Case):
    def info(self, content, *words):
        return run("identify", "-", "--json", "-q", *words, stdin=content.decode())

    def test_values_that_may_have_been_scaled_are_asked_for(self):
        keys = {"ScaleFactor": {"MAIN.ActVelo": "1", "MAIN.ActTorque": "2", "MAIN.ActPos": "1"},
                "Offset": {"MAIN.ActVelo": "0", "MAIN.ActTorque": "10", "MAIN.ActPos": "0"}}
        content = export([(ALL, 1, None)], keys=keys)
        done = self.info(content)
        self.assertEqual((done.returncode, done.stdout), (5, ""))
        self.assertIn("ScaleFactor 2, Offset 10 over 'MAIN.ActTorque' (column 4)", done.stderr)
        self.assertIn("--scale torque=2mNm+10mNm where it did not, --unit torque=mNm where it did", done.stderr)
        largest = {}
        for option in (("--scale", "torque=2mNm+10mNm"), ("--unit", "torque=mNm")):
            done = ended(0, self.info(content, *option))
            largest[option[0]] = max(line["amplitude_nm"] for line in json.loads(done.stdout)["lines"])
        self.assertAlmostEqual(largest["--scale"], 2 * largest["--unit"], delta=1e-3)

    def test_a_scale_of_its_unit_alone_says_nothing_new(self):
        keys = {"Unit ScaleFactor": {"MAIN.ActVelo": "0.0174533", "MAIN.ActTorque": "0.001", "MAIN.ActPos": "0.0174533"}}
        ended(0, self.info(export([(ALL, 1, None)], keys=keys)))

    def test_a_comma_cannot_be_both(self):
        done = self.info(export([(ALL, 1, None)], ",", ","))
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("export again with another separator", done.stderr)

    def test_several_rates_without_times_are_no_log(self):
        done = self.info(export(RATES["the position is slower, filled"][0], timelines="none", gaps="fill"))
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("read channels of 2 and 4 ms without times", done.stderr)

    def test_what_is_wrong_in_a_joined_channel_is_named_by_its_place(self):
        groups, gaps = RATES["the position is slower"]
        lines = export(groups, gaps=gaps, timelines="shared").decode().split("\r\n")
        at = next(k for k, line in enumerate(lines) if line.startswith("100\t"))
        row = lines[at].split("\t")
        row[2] = "broken"
        lines[at] = "\t".join(row)
        done = self.info("\r\n".join(lines).encode())
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn(f"standard input:{at + 1}:{len(row[0]) + len(row[1]) + 3}: read 'broken' in 'MAIN.ActTorque'", done.stderr)

    def test_a_table_that_begins_with_name_by_chance_is_read_as_any(self):
        content = "Name,run 7\nOperator,lab\n\ntime_s,velocity_deg_s,torque_nm\n" + "".join(
            f"{k / 500:.3f},{row.velocity:.5f},{row.torque:.5f}\n" for k, row in enumerate(ROWS))
        ended(0, self.info(content.encode()))


class CountsAndPerMille(Case):
    """Numbers of a drive (CiA 402) are asked for; what 1 is makes them right in every format of text and arrays."""

    TURN, RATED = 524288, 40.0
    SCALES = ("--scale", "velocity=360deg/s/524288", "--scale", "torque=0.04Nm", "--scale", "position=360deg/524288")

    def table(self, names, shift=0):
        lines = [",".join(names)]
        for row in ROWS:
            cells = (1000 * 2 * row.k, round(row.position / 360 * self.TURN) + shift, round(row.velocity / 360 * self.TURN),
                     round(1000 * row.torque / self.RATED))
            lines.append(",".join(map(str, cells)))
        return "\n".join(lines) + "\n"

    NAMES = (("timestamp_us", "position_actual_value_0x6064", "velocity_actual_value_0x606C", "torque_actual_value_0x6077"),
             ("time_us", "0x6064:00", "0x606C:00", "0x6077:00"), ("time_us", "6064h", "606Ch", "6077h"),
             ("time_us", "Position actual value", "Velocity actual value", "Torque actual value"),
             ("time_us", "Axis 1.Position actual value", "Axis 1.Velocity actual value", "Axis 1.Torque actual value"),
             ("time_us", "axis2_0x6864", "axis2_0x686C", "axis2_0x6877"),
             ("time_us", "position_counts", "velocity_counts_s", "torque_permille"),
             ("time_us", "position [inc]", "velocity [inc/s]", "torque [%]"),
             ("time_us", "Lageistwert", "Drehzahlistwert", "Drehmomentistwert"),
             ("time_us", "position", "velocity", "torque"))

    def test_asked_with_the_option_that_makes_it_right(self):
        for names in self.NAMES:
            with self.subTest(names=names):
                text = self.table(names)
                done = run("identify", "-", "--json", "-q", stdin=text)
                self.assertEqual((done.returncode, done.stdout), (5, ""))
                for option in ("--scale velocity=360deg/s/524288", "--scale torque=0.04Nm", "--scale position=360deg/524288"):
                    self.assertIn(option, done.stderr)
                for name in names[1:]:
                    self.assertIn(f"'{name}'", done.stderr)
                done = ended(0, run("identify", "-", "--json", "-q", *self.SCALES, stdin=text))
                found = json.loads(done.stdout)
                self.assertAlmostEqual(found["gear_ratio"]["value"], RATIO, delta=0.1)
                self.assertAlmostEqual(max(line["amplitude_nm"] for line in found["lines"]), 0.4, delta=0.02)

    def test_counts_that_begin_at_rest_are_asked_for(self):
        lines = ["time_s,velocity,torque_nm"]
        for k in range(4000 + len(ROWS)):
            row = ROWS[max(0, k - 4000)]
            lines.append(f"{k / RATE:.3f},{round(row.velocity / 360 * 4096)},{row.torque:.5f}")
        done = run("identify", "-", "-q", stdin="\n".join(lines) + "\n")
        self.assertEqual((done.returncode, done.stdout), (5, ""))
        self.assertIn("'velocity' (column 2) in whole numbers throughout", done.stderr)

    def test_a_speed_that_nothing_has_is_asked_for(self):
        text = "time_s,velocity,torque_nm\n" + "".join(
            f"{row.t:.3f},{row.velocity * 14563.5 / 10 + 0.5:.4f},{row.torque:.4f}\n" for row in ROWS)
        done = run("identify", "-", "-q", stdin=text)
        self.assertEqual((done.returncode, done.stdout), (5, ""))
        self.assertIn("--scale velocity=360deg/s/524288", done.stderr)

    def test_the_option_line_of_info_makes_the_same_reading(self):
        text = self.table(self.NAMES[0])
        told = json.loads(run("info", "-", "--json", *self.SCALES, stdin=text).stdout)
        self.assertIn("--scale velocity=360deg/s/524288", told["options"])
        again = run("info", "-", "--json", *shlex.split(told["options"]), stdin=text)
        self.assertEqual(json.loads(again.stdout)["joints"], told["joints"])

    def test_an_array_is_scaled_alike(self):
        descr = "[('timestamp_us', '<i8'), ('position', '<i4'), ('velocity', '<i4'), ('torque', '<i2')]"
        head = f"{{'descr': {descr}, 'fortran_order': False, 'shape': ({len(ROWS)},), }}"
        head += " " * (-(len(head) + 11) % 64) + "\n"
        rows = [tuple(map(int, line.split(","))) for line in self.table(self.NAMES[-1]).splitlines()[1:]]
        path = self.folder / "counts.npy"
        path.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode()
                         + b"".join(struct.pack("<qiih", *row) for row in rows))
        self.assertIn("--scale torque=0.04Nm", run("identify", path, "-q").stderr)
        done = ended(0, run("identify", path, "--json", "-q", *self.SCALES))
        self.assertAlmostEqual(json.loads(done.stdout)["gear_ratio"]["value"], RATIO, delta=0.1)

    def test_filter_writes_in_the_units_of_the_file(self):
        path, out = self.folder / "counts.csv", self.folder / "out.csv"
        path.write_text(self.table(self.NAMES[0]))
        ended(0, run("filter", path, "-o", out, "--method", "lowpass,cutoff=20Hz", *self.SCALES))
        before, after = ([line.split(",") for line in one.read_text().splitlines()] for one in (path, out))
        self.assertEqual([row[:3] for row in before], [row[:3] for row in after])
        self.assertLess(abs(float(after[3000][3]) - float(before[3000][3])), 30)

    def test_an_offset_moves_the_torque(self):
        path, out = self.folder / "log.csv", self.folder / "out.csv"
        path.write_text("time_s,velocity_deg_s,torque\n" + "".join(
            f"{row.t:.3f},{row.velocity:.4f},{row.torque:.4f}\n" for row in ROWS))
        told = {option: json.loads(run("info", path, "--json", *option).stdout) for option in
                ((), ("--scale", "torque=1Nm+100Nm"))}
        low = [one["joints"][0]["torque_nm"]["min"] for one in told.values()]
        self.assertAlmostEqual(low[1] - low[0], 100.0, places=3)
        ended(0, run("filter", path, "-o", out, "--method", "lowpass,cutoff=20Hz", "--scale", "torque=1Nm+100Nm"))
        self.assertGreater(float(out.read_text().splitlines()[2000].split(",")[2]), 90.0)
