# SPDX-License-Identifier: MIT
"""One log as many loggers write it. The law: the right ratio without an option, or a refusal that names the option
that makes it right; never a wrong answer with exit code 0."""

import datetime
import functools
import itertools
import json
import math
import random
import re
import resource
import shlex
import struct
import unittest

from commands import LOGS, TOOL, ended, run, sanitized, Case

RATIO, RATE = 100.0, 500.0
EPOCH_NS = 1_700_000_000_123_456_789
DEG = math.pi / 180.0


class Row:
    def __init__(self, k, velocity, torque, position):
        self.k, self.t = k, k / RATE
        self.velocity, self.torque, self.position = velocity, torque, position  # deg/s, Nm, deg
        self.ns = EPOCH_NS + round(1e9 * k / RATE)


def make_rows():
    noise = random.Random(7)
    rows, position, velocity = [], -100.0, 0.0
    for seconds, goal in ((0.3, 0.0), (3.0, 60.0), (2.5, -80.0), (3.0, 40.0)):
        for _ in range(int(seconds * RATE)):
            velocity += max(-400.0 / RATE, min(400.0 / RATE, goal - velocity))
            position += velocity / RATE
            angle = RATIO * position * DEG
            torque = (5.0 + math.copysign(1.0, velocity) * (abs(velocity) > 0.5) + 0.4 * math.cos(2 * angle)
                      + 0.15 * math.cos(angle + 1.0) + noise.gauss(0.0, 0.05))
            rows.append(Row(len(rows), velocity, torque, position))
    return rows


def stamp(row):
    return datetime.datetime(2025, 12, 31, 23, 59, 55) + datetime.timedelta(seconds=row.k // 500, milliseconds=row.k % 500 * 2)


ROWS = make_rows()
COLUMNS = {
    "t": lambda r: f"{r.t:.6f}", "deg/s": lambda r: f"{r.velocity:.6f}", "rad/s": lambda r: f"{r.velocity * DEG:.7f}",
    "rpm": lambda r: f"{r.velocity / 6:.7f}", "Nm": lambda r: f"{r.torque:.5f}", "mNm": lambda r: f"{1e3 * r.torque:.2f}",
    "deg": lambda r: f"{r.position:.6f}", "rad": lambda r: f"{r.position * DEG:.8f}",
    "A": lambda r: f"{r.torque / 0.11:.5f}", "k": lambda r: str(r.k), "ms": lambda r: str(2 * r.k),
    "us": lambda r: str(12_345_678 + 2000 * r.k), "ns": lambda r: str(r.ns), "epoch_us": lambda r: str(r.ns // 1000),
    "epoch_ms": lambda r: str(r.ns // 1_000_000), "epoch_s": lambda r: f"{r.ns // 10**9}.{r.ns % 10**9:09d}",
    "sec": lambda r: str(r.ns // 10**9), "nanosec": lambda r: str(r.ns % 10**9),
    "wrapped rad": lambda r: f"{(r.position * DEG) % (2 * math.pi):.8f}",
    "wrapped deg": lambda r: f"{r.position % 360.0:.6f}",
    "motor rpm": lambda r: f"{RATIO * r.velocity / 6:.5f}", "motor deg": lambda r: f"{RATIO * r.position:.4f}",
    "motor deg/s": lambda r: f"{RATIO * r.velocity:.5f}", "motor rad": lambda r: f"{RATIO * r.position * DEG:.6f}",
    "iso": lambda r: (datetime.datetime(2024, 5, 1, 12, 30) + datetime.timedelta(seconds=r.t)).isoformat(
        timespec="microseconds") + "Z",
    "clock": lambda r: (datetime.datetime(2024, 5, 1, 12, 30) + datetime.timedelta(seconds=r.t)).strftime("%H:%M:%S.%f"),
    "filetime": lambda r: str(133_600_000_000_000_000 + 20_000 * r.k), "0": lambda r: "0", "": lambda r: "",
    "dt": lambda r: "0.002", "dt us": lambda r: str(2000 + 5 * (r.k % 3 - 1)),
    "german": lambda r: stamp(r).strftime("%d.%m.%Y %H:%M:%S,") + f"{r.k * 2 % 1000:03d}",
    "american": lambda r: stamp(r).strftime("%m/%d/%Y %I:%M:%S.%f %p"),
    "logging": lambda r: stamp(r).strftime("%Y-%m-%d %H:%M:%S,") + f"{r.k * 2 % 1000:03d}",
    "frame": lambda r: "base_link", "text": lambda r: "running",
}


@functools.cache
def column(name):
    """Its cells, made once for all dialects that have it."""
    return [COLUMNS[name](row) for row in ROWS]


def table(header, columns, delimiter=",", decimal=".", end="\n", head="", quote=False, units=None, tail=""):
    """The log as text: a header line, or none, and one cell a column."""
    def line(cells):
        return delimiter.join(f'"{cell}"' if quote else cell for cell in cells) + tail + end

    text = head
    if header is not None:
        text += line(header if isinstance(header, list) else header.split("|"))
    if units:
        text += line(units.split("|"))
    cells = [column(name) for name in columns.split("|")]
    if decimal != ".":
        cells = [[cell.replace(".", decimal) for cell in one] for one in cells]
    return (text + "".join(line(row) for row in zip(*cells))).encode()


def npy(fortran, transposed):
    values = [[r.t, r.velocity, r.torque, r.position] for r in ROWS]
    by_columns = fortran != transposed
    flat = [v for c in range(4) for v in (row[c] for row in values)] if by_columns else [v for row in values for v in row]
    shape = (4, len(values)) if transposed else (len(values), 4)
    text = f"{{'descr': '<f8', 'fortran_order': {fortran}, 'shape': {shape}, }}"
    text += " " * (-(len(text) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode() + struct.pack(f"<{len(flat)}d", *flat)


def npy_stamped():
    """A structured array with whole nanoseconds since 1970."""
    descr = "[('timestamp', '<i8'), ('velocity_deg_s', '<f8'), ('torque_nm', '<f8')]"
    text = f"{{'descr': {descr}, 'fortran_order': False, 'shape': ({len(ROWS)},), }}"
    text += " " * (-(len(text) + 11) % 64) + "\n"
    data = b"".join(struct.pack("<qdd", r.ns, r.velocity, r.torque) for r in ROWS)
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode() + data


def lvm():
    head = ("LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
            "Multi_Headings\tNo\nX_Columns\tOne\nTime_Pref\tRelative\nOperator\tlab\nDate\t2024/05/01\n"
            "Time\t12:30:00.1234567\n***End_of_Header***\t\n\t\nChannels\t3\t\t\t\n"
            f"Samples\t{len(ROWS)}\t{len(ROWS)}\t{len(ROWS)}\t\nDate\t2024/05/01\t2024/05/01\t2024/05/01\t\n"
            "Time\t12:30:00.1\t12:30:00.1\t12:30:00.1\t\nY_Unit_Label\tDeg/s\tNm\tDeg\t\n"
            "X_Dimension\tTime\tTime\tTime\t\nX0\t0.0\t0.0\t0.0\t\nDelta_X\t0.002\t0.002\t0.002\t\n"
            "***End_of_Header***\t\t\t\t\n")
    return table("X_Value|velocity|torque|position|Comment", "t|deg/s|Nm|deg", delimiter="\t", head=head)


def twincat(stamps):
    head = ("Name\tScope Project\nFile\tC:\\scope.svdx\nStarttime of export\t133600000000000000\n"
            "Endtime of export\t133600000090000000\n\n"
            "Name\tAxis1.ActVelo\tName\tAxis1.ActTorque\tName\tAxis1.ActPos\n"
            "SymbolComment\t\tSymbolComment\t\tSymbolComment\t\n"
            "Data-Type\tREAL64\tData-Type\tREAL64\tData-Type\tREAL64\n"
            "SampleTime[ms]\t2\tSampleTime[ms]\t2\tSampleTime[ms]\t2\n"
            "VariableSize\t8\tVariableSize\t8\tVariableSize\t8\n"
            "Unit\t°/s\tUnit\tNm\tUnit\t°\n\n")
    return table(None, f"{stamps}|deg/s|{stamps}|Nm|{stamps}|deg", delimiter="\t", head=head) + b"EOF\n"


def twincat_shared():
    """Channels of one rate that share their column of times."""
    head = ("Name\tScope Project\nFile\tC:\\scope.svdx\nStarttime of export\t133600000000000000\n"
            "Endtime of export\t133600000090000000\n\n"
            "Name\tAxis1.ActVelo\tAxis1.ActTorque\tAxis1.ActPos\nData-Type\tREAL64\tREAL64\tREAL64\n"
            "SampleTime[ms]\t2\t2\t2\nUnit\t°/s\tNm\t°\n\n")
    return table(None, "ms|deg/s|Nm|deg", delimiter="\t", head=head) + b"EOF\n"


def tidy():
    lines = ["time_ms,signal,value"]
    for r in ROWS:
        lines += [f"{2 * r.k},{name},{value:.6f}" for name, value in
                  (("velocity_deg_s", r.velocity), ("torque_nm", r.torque), ("position_deg", r.position))]
    return ("\n".join(lines) + "\n").encode()


def blocks():
    """One block of rows a variable, as controllers' traces are exported."""
    text = ""
    for name, of in (("PLC.fVelocity [deg/s]", lambda r: r.velocity), ("PLC.fTorque [Nm]", lambda r: r.torque)):
        text += f"Variable;{name}\nTimestamp [ms];Value\n" + "".join(f"{2 * r.k};{of(r):.6f}\n" for r in ROWS)
    return text.encode()


# name -> bytes, and the options that make it right where it may be refused
RAD, REFUSED_RAD = "t|rad/s|Nm|rad", ["--unit", "velocity=rad/s"]
DIALECTS = {
    "units in the header": (table("time_s|velocity_deg_s|torque_nm|position_deg", "t|deg/s|Nm|deg"), None),
    "brackets and radians": (table("t [s]|dq [rad/s]|tau [Nm]|q [rad]", RAD), None),
    "semicolon and decimal comma": (table("time_s|velocity_deg_s|torque_Nm|position_deg", "t|deg/s|Nm|deg",
                                          delimiter=";", decimal=","), None),
    "quoted decimal comma": (table("time_s|velocity_deg_s|torque_Nm", "t|deg/s|Nm", decimal=",", quote=True), None),
    "sep=;": (table("time_s|velocity_deg_s|torque_Nm|position_deg", "t|deg/s|Nm|deg", delimiter=";", decimal=",",
                    head="sep=;\n"), None),
    "tab and unit row": (table("time|velocity|torque|position", "t|rad/s|Nm|rad", delimiter="\t",
                               units="s|rad/s|Nm|rad"), None),
    "unit row in brackets, German": (table("Zeit;Drehzahl;Drehmoment;Winkel".split(";"), "ms|rpm|Nm|deg", delimiter=";",
                                           decimal=",", units="[ms]|[1/min]|[Nm]|[°]"), None),
    "Latin-1 degree signs": (table("t [s]|w [°/s]|M [Nm]|phi [°]".replace("w", "omega").replace("M [", "moment [")
                                   .replace("phi", "angle"), "t|deg/s|Nm|deg").decode().encode("latin-1"), None),
    "byte-order mark and CR LF": (b"\xef\xbb\xbf" + table("time_s|velocity_deg_s|torque_nm", "t|deg/s|Nm", end="\r\n"),
                                  None),
    "blanks": (table("time_s velocity_rad_s torque_Nm".split(), "t|rad/s|Nm", delimiter=" "), None),
    "savetxt comment": (table(None, "t|deg/s|Nm", delimiter=" ", head="# time_s velocity_deg_s torque_nm\n"), None),
    "no header": (table(None, "t|deg/s|Nm|deg"), ["--columns", "time,velocity,torque,position", "--unit", "velocity=deg/s,position=deg"]),
    "no time": (table("velocity_deg_s|torque_nm", "deg/s|Nm"), ["--sample-rate", "500Hz"]),
    "pandas index": (table("|time_s|velocity_deg_s|torque_nm", "k|t|deg/s|Nm"), None),
    "counter called time": (table("time|velocity_deg_s|torque_nm", "k|deg/s|Nm"), ["--sample-rate", "500Hz"]),
    # Radians that nobody names: five styles.
    "t,dq,tau_J,q": (table("t|dq|tau_J|q", RAD), None),
    "t,v,tau,q": (table("t|v|tau|q", RAD), None),
    "t,w,T,th": (table("t|w|T|th", RAD), None),
    "libfranka's log, ms": (table("time|state.q[0]|state.dq[0]|state.tau_J[0]", "ms|rad|rad/s|Nm"), None),
    "JointState names": (table("time|position|velocity|effort", "t|rad|rad/s|Nm"), None),
    "UR RTDE": (table("timestamp actual_q_0 actual_qd_0 actual_current_0 target_qd_0".split(), "t|rad|rad/s|A|rad/s",
                      delimiter=" "), None),
    "plain words": (table("time|velocity|torque|position", RAD), REFUSED_RAD),
    "plain words, no position": (table("time|velocity|torque", "t|rad/s|Nm"), REFUSED_RAD),
    "plain words in degrees": (table("time|velocity|torque|position", "t|deg/s|Nm|deg"),
                               ["--unit", "velocity=deg/s,position=deg"]),
    "plain words in degrees, no position": (table("time|velocity|torque", "t|deg/s|Nm"),
                                            ["--unit", "velocity=deg/s"]),
    "plain words in rpm, no position": (table("time|speed|torque", "t|rpm|Nm"), ["--unit", "velocity=rpm"]),
    "rpm beside degrees": (table("time|speed|torque|angle", "t|rpm|Nm|deg"), None),
    "rad/s beside degrees": (table("time|speed|torque|position_deg", "t|rad/s|Nm|deg"), None),
    "Kinova Kortex": (table("time|actuators[0].position|actuators[0].velocity|actuators[0].torque", "t|deg|deg/s|Nm"),
                      None),
    # Stamps.
    "timestamp in ns": (table("timestamp|velocity_deg_s|torque_nm", "ns|deg/s|Nm"), None),
    "timestamp in us": (table("timestamp|velocity_deg_s|torque_nm", "us|deg/s|Nm"), None),
    "timestamp in us since 1970": (table("timestamp|velocity_deg_s|torque_nm", "epoch_us|deg/s|Nm"), None),
    "timestamp in ms since 1970": (table("timestamp|velocity_deg_s|torque_nm", "epoch_ms|deg/s|Nm"), None),
    "timestamp in s since 1970": (table("timestamp|velocity_deg_s|torque_nm", "epoch_s|deg/s|Nm"), None),
    "milliseconds": (table("t|velocity_deg_s|torque_nm", "ms|deg/s|Nm"), None),
    "ISO 8601": (table("timestamp|velocity_deg_s|torque_nm", "iso|deg/s|Nm"), None),
    "time of day": (table("time|velocity_deg_s|torque_nm", "clock|deg/s|Nm"), None),
    "time steps": (table("dt|velocity_deg_s|torque_nm", "dt|deg/s|Nm"), None),
    "time steps in us": (table("k|timestep [us]|velocity_deg_s|torque_nm", "k|dt us|deg/s|Nm"), None),
    "German dates": (table("Zeit|velocity_deg_s|torque_nm", "german|deg/s|Nm", delimiter=";"), None),
    "American dates": (table("Timestamp|velocity_deg_s|torque_nm", "american|deg/s|Nm"), None),
    "Python's logging": (table("asctime|velocity_deg_s|torque_nm", "logging|deg/s|Nm", quote=True), None),
    "TimeUS": (table("TimeUS|velocity_deg_s|torque_nm", "us|deg/s|Nm"), None),
    "FILETIME": (table("timestamp|velocity_deg_s|torque_nm", "filetime|deg/s|Nm"), None),
    # ROS, flattened.
    "rostopic echo -p": (table("%time|field.header.seq|field.header.stamp|field.header.frame_id|field.position0|"
                               "field.velocity0|field.effort0", "ns|k|ns|frame|rad|rad/s|Nm"), None),
    "ROS 2, sec and nanosec": (table("header.stamp.sec|header.stamp.nanosec|header.frame_id|position[0]|velocity[0]|"
                                     "effort[0]", "sec|nanosec|frame|rad|rad/s|Nm"), None),
    "ROS 1, secs and nsecs": (table("rosbagTimestamp|header.seq|secs|nsecs|position_0|velocity_0|effort_0",
                                    "ns|k|sec|nanosec|rad|rad/s|Nm"), None),
    "PlotJuggler": (table("__time|/joint_states/elbow_joint/effort|/joint_states/elbow_joint/position|"
                          "/joint_states/elbow_joint/velocity", "epoch_s|Nm|rad|rad/s"), None),
    "PlotJuggler, arrays": (table("__time|/joint_states/position[0]|/joint_states/velocity[0]|/joint_states/effort[0]",
                                  "epoch_s|rad|rad/s|Nm"), None),
    # Angles that wrap, other sides of the gear, no velocity.
    "wrapped at 2 pi": (table("time|velocity|torque|position", "t|rad/s|Nm|wrapped rad"), REFUSED_RAD),
    "wrapped at 360": (table("time|velocity|torque|position", "t|deg/s|Nm|wrapped deg"), None),
    "position alone": (table("time_s|position_deg|torque_nm", "t|deg|Nm"), None),
    "motor velocity by name": (table("time_s|motor_velocity_rpm|torque_nm", "t|motor rpm|Nm"),
                               ["--gear-ratio", "100"]),
    "motor velocity by name, joint position": (table("time_s|motor_velocity_rpm|torque_nm|position_deg",
                                                     "t|motor rpm|Nm|deg"), None),
    "motor velocity by position": (table("time_s|velocity_deg_s|torque_nm|position_deg", "t|motor deg/s|Nm|deg"), None),
    "motor position by velocity": (table("time_s|velocity_deg_s|torque_nm|position_deg", "t|deg/s|Nm|motor deg"), None),
    "motor velocity too fast for a joint": (table("time_s|velocity_rpm|torque_nm", "t|motor rpm|Nm"),
                                            ["--gear-ratio", "100"]),
    "both of the motor": (table("time_s|motor_velocity_rpm|torque_nm|motor_position_deg", "t|motor rpm|Nm|motor deg"),
                          ["--gear-ratio", "100"]),
    # Heads and formats.
    "LabVIEW": (lvm(), None),
    "TwinCAT Scope": (twincat("ms"), None),
    "TwinCAT Scope, FILETIME": (twincat("filetime"), None),
    "TwinCAT Scope, one column of times": (twincat_shared(), None),
    "npy by rows": (npy(False, False), ["--unit", "velocity=deg/s"]),
    "npy in Fortran order": (npy(True, False), ["--unit", "velocity=deg/s"]),
    "npy with a row a signal": (npy(False, True), ["--unit", "velocity=deg/s"]),
    "npy with stamps": (npy_stamped(), None),
    "one value a row": (tidy(), None),
    "one block a variable": (blocks(), None),
    "trailing delimiters": (table("time_s|velocity_deg_s|torque_nm|", "t|deg/s|Nm|"), None),
    "a column of words": (table("time_s|state|velocity_deg_s|torque_nm", "t|text|deg/s|Nm"), None),
    "milli-units": (table("time_ms|velocity_rpm|torque_mNm", "ms|rpm|mNm"), None),
}


def identify(path, *options):
    return run("identify", path, "--json", "-q", "--require-conclusive", *options)


class OneLogInManyDialects(Case):

    def test_right_or_refused_with_the_option_that_makes_it_right(self):
        right, refused = [], []
        for name, (content, option) in DIALECTS.items():
            with self.subTest(name):
                path = self.folder / ("log.npy" if name.startswith("npy") else "log.csv")
                path.write_bytes(content)
                done = identify(path)
                if done.returncode == 0:
                    ratio = json.loads(done.stdout)["gear_ratio"]["value"]
                    self.assertIsNotNone(ratio, done.stdout[:600])
                    self.assertAlmostEqual(ratio, RATIO, delta=0.5, msg=done.stdout[:600])
                    right.append(name)
                    continue
                self.assertIn(done.returncode, (3, 5), done.stderr)
                said = done.stdout + done.stderr
                self.assertIsNotNone(option, f"refused: {said[:900]}")
                self.assertIn(option[0], said)
                if option[0] == "--unit":
                    self.assertIn(option[1], said)
                again = identify(path, *option)
                self.assertEqual(again.returncode, 0, again.stdout[:900] + again.stderr)
                self.assertAlmostEqual(json.loads(again.stdout)["gear_ratio"]["value"], RATIO, delta=0.5)
                refused.append(name)
        print(f"\n{len(right)} right without an option, {len(refused)} refused with it: {', '.join(refused)}")


class ChannelsWithClocksOfTheirOwn(unittest.TestCase):
    """TwinCAT Scope exports a column of times beside each channel."""

    def info(self, change=lambda row, cells: cells, *words):
        text = twincat("ms").decode()
        head, rows = text[:text.index("0\t")], text[text.index("0\t"):].splitlines()
        rows = ["\t".join(change(k, row.split("\t"))) for k, row in enumerate(rows) if "\t" in row]
        return run("info", "-", "--json", *words, stdin=head + "\n".join(rows) + "\nEOF\n")

    def test_one_clock_in_several_columns_is_read(self):
        done = ended(0, self.info())
        self.assertEqual([c["role"] for c in json.loads(done.stdout)["columns"]],
                         ["time", "velocity", "other", "torque", "other", "position"])

    def test_two_clocks_are_joined_by_time_and_that_is_said(self):
        for at_k in (lambda k: f"{4.0 * k}", lambda k: f"{2.0 * k + 100.0}"):  # half the rate; a later start
            done = ended(0, self.info(lambda k, cells: cells[:2] + [at_k(k)] + cells[3:]))
            told = json.loads(done.stdout)
            self.assertEqual([c["name"] for c in told["columns"]], ["3", "Axis1.ActTorque", "Axis1.ActVelo", "Axis1.ActPos"])
            self.assertIn("Axis1.ActVelo has a clock of its own: joined to the rows by --join linear", told["warnings"][0])

    def test_what_is_within_half_a_step_is_the_same_row(self):
        ended(0, self.info(lambda k, cells: cells[:2] + [f"{2.0 * k + 0.4}"] + cells[3:]))

    def test_a_clock_is_compared_in_every_row(self):
        late = lambda k, cells: cells[:2] + [f"{2.0 * k + (4.0 if k > 4000 else 0.0)}"] + cells[3:]  # noqa: E731
        self.assertIn("has a clock of its own", self.info(late).stdout)

    def test_the_clock_that_is_named_counts_and_the_option_line_names_it(self):
        slow = lambda k, cells: cells[:2] + [f"{4.0 * k}"] + cells[3:]  # noqa: E731
        for words, rate in (((), 250.0), (("--columns", "time=3"), 250.0), (("--columns", "time=1"), 500.0)):
            told = json.loads(self.info(slow, *words).stdout)
            self.assertAlmostEqual(told["sample_rate_hz"], rate)
            again = ended(0, self.info(slow, *shlex.split(told["options"])))
            self.assertEqual(json.loads(again.stdout)["joints"], told["joints"])


class WhatIsSaidWithoutAUnit(Case):

    def test_info_and_filter_read_the_same_units(self):
        for name in ("plain words", "motor velocity by position", "timestamp in ns", "ROS 2, sec and nanosec"):
            with self.subTest(name):
                (self.folder / "log.csv").write_bytes(DIALECTS[name][0])
                seen = json.loads(self.run_tool("info", "log.csv", "--json").stdout)
                ended(0, self.run_tool("filter", "log.csv", "--method", "none", "-o", "out.npy", "--force", "-q"))
                written = json.loads(self.run_tool("info", "out.npy", "--json").stdout)
                self.assertAlmostEqual(written["sample_rate_hz"], seen["sample_rate_hz"], delta=1e-6)
                for side in ("min", "max"):
                    self.assertAlmostEqual(written["speed_deg_s"][side], seen["speed_deg_s"][side], delta=1e-6)
                # Degrees were written: what was read is the truth, or not sure of itself.
                if seen["recording"]["assumptions"] == []:
                    self.assertAlmostEqual(seen["speed_deg_s"]["max"], 60.0, delta=0.2)

    def test_motion_of_the_motor_without_a_ratio_is_refused_where_it_would_be_misread(self):
        (self.folder / "log.csv").write_bytes(DIALECTS["motor velocity by name"][0])
        ended(3, self.run_tool("filter", "log.csv", "--method", "none", "-o", "out.csv"), "--gear-ratio")
        found = json.loads(self.run_tool("identify", "log.csv", "--json", "-q").stdout)
        self.assertTrue(found["verdict"].startswith("Cannot tell the gear ratio: "), found["verdict"])
        self.assertEqual(sorted(round(line["order"]) for line in found["lines"]), [1, 2])

    @unittest.skipIf(sanitized(TOOL), "sanitizers need address space of their own")
    def test_a_clock_in_a_wrong_unit_makes_no_memory_grow(self):
        (self.folder / "log.csv").write_bytes(DIALECTS["timestamp in ns"][0])
        limit = 1 << 30
        done = self.run_tool("identify", "log.csv", "--unit", "timestamp=s", "-q",
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        self.assertIn(done.returncode, (0, 3), done.stderr)

    def test_a_diagnosis_without_units_is_the_one_with_units_or_none(self):
        model = {"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [
            {"effect": "inertia"}, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]}
        (self.folder / "model.json").write_text(json.dumps(model))
        motion = ["--motion", "rest,duration=0.4s,from=0deg"]
        for target, seconds in ((120, 1.4), (-60, 1.9), (30, 2.4), (-40, 1.4)):
            motion += ["--motion", f"poly6,to={target}deg,duration={seconds}s", "--motion", "rest,duration=0.4s"]
        ended(0, self.run_tool("simulate", "--gear-ratio", "100", "--inertia", "0.4", "--ripple", "1:0.7Nm:30deg", "--ripple",
                           "2:0.4Nm:-60deg", "--effect", "coulomb-friction,torque_nm=0.8,width_deg_s=2", *motion,
                           "--sample-rate", "250Hz", "--noise", "0.05Nm", "--velocity-noise", "0.05deg/s", "--seed", "3",
                           "-o", "log.csv", "--force"))
        expected = json.loads(self.run_tool("diagnose", "log.csv", "--model", "model.json", "--json", "-q").stdout)
        for header in ("t,dq,tau_J,q", "time,velocity,torque,position"):
            with self.subTest(header=header):
                (self.folder / "bare.csv").write_text(in_radians(self.folder / "log.csv", header))
                done = ended(0, self.run_tool("diagnose", "bare.csv", "--model", "model.json", "--json", "-q"))
                found = json.loads(done.stdout)
                if found["verdict"] == "undecided":
                    self.assertIn("--unit velocity=", found["doubt"])
                    self.assertEqual(found["named"], [])
                else:
                    self.assertEqual((found["verdict"], found["named"]), (expected["verdict"], expected["named"]))
                self.assertTrue(header.startswith("time") or found["verdict"] != "undecided")


def in_radians(path, header):
    """time_s, velocity_deg_s, torque_nm, position_deg with motion in radians under another header."""
    lines = path.read_text().strip().split("\n")
    names = lines[0].split(",")
    place = [names.index(name) for name in ("time_s", "velocity_deg_s", "torque_nm", "position_deg")]
    rows = [header]
    for line in lines[1:]:
        cells = line.split(",")
        t, v, torque, q = (float(cells[i]) for i in place)
        rows.append(f"{t},{v * DEG!r},{torque},{q * DEG!r}")
    return "\n".join(rows) + "\n"


# Real logs, with and without their units: (file, joint or none).
REAL = [("gpl3/panda_gaz_j1.csv", None), ("gpl3/panda_gaz_j4.csv", None), ("neura_lara8_j3.csv", None),
        ("kuka_kr300_trajA_all.csv", "j4"), ("kuka_kr300_trajB_all.csv", "j5"),
        ("ur10_unisa_exciting_all.csv", "elbow_joint"), ("ur3e_rad_L1L2_j345.csv", "j3")]
SYMBOLS = {"velocity": "dq", "torque": "tau_J", "position": "q", "time": "t"}


def stripped(text, symbols):
    """The same log with a header that names no unit, and with symbols for words where asked."""
    header, rest = text.split("\n", 1)
    names = [re.sub(r"_(rad_s|deg_s|rad|deg|Nm|nm|A|s)$", "", name.strip()) for name in header.split(",")]
    if symbols:
        names = ["_".join(SYMBOLS.get(word, word) for word in name.split("_")) for name in names]
    return ",".join(names) + "\n" + rest


@unittest.skipUnless(LOGS.is_dir(), "the real logs are not here")
class RealLogsWithoutUnits(Case):
    def test_the_same_verdict_or_none(self):
        said = functools.cache(identify)  # of the log as it is: once for both ways to strip it
        for (name, joint), symbols in itertools.product(REAL, (True, False)):
            source = LOGS / name
            if not source.is_file():
                continue
            with self.subTest(log=name, joint=joint, symbols=symbols):
                words = ["--joint", joint] if joint else []
                path = self.folder / "log.csv"
                path.write_text(stripped(source.read_text(), symbols))
                with_units, without = said(source, *words), identify(path, *words)
                self.assertIn(with_units.returncode, (0, 5), with_units.stderr)
                if without.returncode == 0:
                    self.assertEqual(json.loads(without.stdout)["verdict"], json.loads(with_units.stdout)["verdict"])
                    continue
                self.assertEqual(without.returncode, 5, without.stderr)
                if with_units.returncode == 0:
                    verdict = json.loads(without.stdout)["verdict"]
                    self.assertTrue(verdict.startswith("Cannot tell"), verdict)
                    self.assertIn("--unit", verdict)


class OtherShapes(Case):
    def test_what_has_one_value_a_row_is_written_as_a_table(self):
        (self.folder / "log.csv").write_bytes(tidy())
        ended(0, self.run_tool("filter", "log.csv", "--method", "none", "-o", "out.csv", "-q"))
        self.assertEqual((self.folder / "out.csv").read_text().split("\n")[0], "time_s,velocity_deg_s,torque_nm,position_deg")

    def test_a_linear_axis_asks_for_its_lead_and_is_then_that_of_its_screw(self):
        lead_m = 0.005
        rows = [(r.t, r.position * lead_m / 360, r.velocity * lead_m / 360, r.torque * 2 * math.pi / lead_m) for r in ROWS]
        of_the_screw = "".join(f"{r.t:.4f},{r.position:.9f},{r.velocity:.9f},{r.torque:.9f}\n" for r in ROWS)
        (self.folder / "screw.csv").write_text("t_s,position_deg,velocity_deg_s,torque_nm\n" + of_the_screw)
        words = ["--gear-ratio", str(RATIO), "--json", "-q"]
        screw = json.loads(self.run_tool("identify", "screw.csv", *words).stdout)
        for header, per_m in (("t_s,pos_m,vel_m_s,force_N", 1), ("t_s,pos_m,vel_m/s,force_N", 1),
                              ("t_s,pos_mm,vel_mm_s,force_N", 1000), ("time [s],position [mm],velocity [mm/s],force [N]", 1000)):
            with self.subTest(header=header):
                text = "".join(f"{t:.4f},{q * per_m:.12f},{v * per_m:.12f},{f:.9f}\n" for t, q, v, f in rows)
                (self.folder / "axis.csv").write_text(header + "\n" + text)
                done = self.run_tool("identify", "axis.csv", *words)
                self.assertEqual((done.returncode, "use --lead 5mm" in done.stderr), (3, True), done.stderr)
                done = ended(0, self.run_tool("identify", "axis.csv", *words, "--lead", "5mm"))
                axis = json.loads(done.stdout)
                self.assertAlmostEqual(axis["gear_ratio"]["value"], screw["gear_ratio"]["value"], delta=1e-4)
                for one, other in zip(axis["lines"], screw["lines"], strict=True):
                    self.assertAlmostEqual(one["amplitude_nm"], other["amplitude_nm"], delta=1e-5)
                self.assertIn("--lead 5mm", self.run_tool("info", "axis.csv", "--lead", "5mm").stdout)
                done = self.run_tool("filter", "axis.csv", "--lead", "5mm", "--method", "none", "-o", "same.csv", "--force", "-q")
                self.assertEqual((self.folder / "same.csv").read_text(), (self.folder / "axis.csv").read_text(), done.stderr)
        (self.folder / "motor.csv").write_text("t_s,q_m,dq_m,tau_m\n" + of_the_screw)
        self.assertNotIn("lead", self.run_tool("identify", "motor.csv", *words).stderr)


# Clocks that a file or its reader states: the step in the head of a .lvm, and counters whose unit the user says.

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
