# SPDX-License-Identifier: MIT
"""Clocks that a file or its reader states: the step in the head of a .lvm, and counters whose unit the user says."""

import json
import math

from commands import Case, ended
from test_log_dialects import ROWS, lvm, table


def lvm_without_times(x_value=True, step="0.002", dimension="Time"):
    """X_Columns No: the cells of X_Value are empty, or there is no such column, and Delta_X is the clock."""
    head = lvm().decode()
    head = head[:head.index("X_Value")].replace("X_Columns\tOne", "X_Columns\tNo")
    head = head.replace("0.002\t0.002\t0.002", "\t".join([step] * 3)).replace("Time\tTime\tTime", "\t".join([dimension] * 3))
    names, columns = ("X_Value|", "|") if x_value else ("", "")
    return table(f"{names}velocity|torque|position|Comment", f"{columns}deg/s|Nm|deg", delimiter="\t", head=head)


class Clocks(Case):
    def recording(self, content, *options):
        (self.folder / "log.csv").write_bytes(content)
        done = ended(0, self.run_tool("identify", "log.csv", "--json", "-q", *options))
        found = json.loads(done.stdout)
        return found["recording"], found["gear_ratio"]["value"]


class LabView(Clocks):
    def test_the_head_is_the_clock_of_a_file_without_one(self):
        for x_value in (True, False):
            with self.subTest(x_value=x_value):
                recording, ratio = self.recording(lvm_without_times(x_value), "--unit", "velocity=deg/s,position=deg")
                self.assertEqual((recording["nominal_rate_hz"], recording["rate_stated"], recording["gap_count"]), (500, True, 0))
                self.assertAlmostEqual(ratio, 100, delta=0.5)
                told = [one for one in recording["inferences"] if one["about"] == "time"]
                self.assertEqual([(one["assumed"], one["settle_with"]) for one in told], [("0.002 s a row", "--sample-rate 500Hz")])

    def test_every_row_is_as_far_from_the_last_in_what_is_written(self):
        (self.folder / "log.csv").write_bytes(lvm_without_times(step="0.004"))
        self.assertEqual(self.run_tool("filter", "log.csv", "--method", "none", "-o", "out.npy", "-q").returncode, 0)
        seen = json.loads(self.run_tool("info", "out.npy", "--json").stdout)
        self.assertEqual((seen["sample_rate_hz"], seen["rows"]), (250, len(ROWS)))

    def test_times_and_options_come_before_the_head(self):
        content = lvm().replace(b"Delta_X\t0.002\t0.002\t0.002", b"Delta_X\t0.004\t0.004\t0.004")
        self.assertEqual(self.recording(content)[0]["nominal_rate_hz"], 500)
        self.assertEqual(self.recording(lvm_without_times(step="0.004"), "--sample-rate", "500Hz")[0]["nominal_rate_hz"], 500)

    def test_a_step_that_is_no_time_or_differs_by_channel_is_none(self):
        for content in (lvm_without_times(dimension="Frequency"), lvm_without_times(step="0.0"),
                        lvm_without_times().replace(b"0.002\t0.002\t0.002", b"0.002\t0.004\t0.002")):
            (self.folder / "log.csv").write_bytes(content)
            done = self.run_tool("identify", "log.csv", "-q")
            self.assertEqual(done.returncode, 3, done.stdout)


class Counters(Clocks):
    """libfranka counts milliseconds, one a row: a row number, until somebody says what it counts."""

    def libfranka(self, name):
        rows = "".join(f"{5000 + r.k},{math.radians(r.velocity):.7f},{r.torque:.5f},{math.radians(r.position):.8f}\n" for r in ROWS)
        return f"{name},dq,tau_J,q\n{rows}".encode()

    def test_a_stated_unit_is_believed(self):
        for name, options in (("time", ["--unit", "time=ms"]), ("t", ["--unit", "t=ms"]), ("timestamp", ["--unit", "time=ms"]),
                              ("count", ["--columns", "time=count", "--unit", "time=ms"])):
            with self.subTest(name=name, options=options):
                self.assertEqual(self.recording(self.libfranka(name), *options)[0]["nominal_rate_hz"], 1000)

    def test_without_one_the_option_is_named(self):
        (self.folder / "log.csv").write_bytes(self.libfranka("time"))
        ended(3, self.run_tool("identify", "log.csv"), "--unit time=ms")
