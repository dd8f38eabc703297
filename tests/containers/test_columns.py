# SPDX-License-Identifier: MIT
"""Raw dumps, written by struct."""

import json
import struct

import bags
from container_case import LOG, needs, Case
from test_messages import NAMES, Messages


class Raw(Case):
    libraries = ()

    def dump(self, code, names, scale=None):
        return b"".join(struct.pack(code, *(self.columns[name][k] for name in names)) for k in range(len(self.rows)))

    def test_records_are_read_as_told(self):
        data = self.dump("<4d", self.names)
        layout = ",".join(f"f8:{name}" for name in self.names)
        self.assert_same(self.write("run.bin", data), "--format", "raw", "--layout", layout)
        self.assertEqual(self.identified("-", "--format", "raw", "--layout", layout, stdin=data), self.identified(LOG))
        big = self.dump(">4d", self.names)
        self.assert_same(self.write("big.bin", big), "--format", "raw", "--layout", ">" + layout)
        padded = b"".join(struct.pack("<d4xd", row[0], row[1]) + struct.pack(">dd", row[2], row[3]) for row in self.rows)
        self.assert_same(self.write("pad.bin", padded), "--format", "raw", "--layout",
                         "f8:time_s,x4,f8:velocity_deg_s,>f8:torque_nm,f8:position_deg")

    def test_fields_without_names_are_taken_by_place(self):
        path = self.write("run.bin", self.dump("<4d", self.names))
        said = self.run_tool("info", path, "--format", "raw", "--layout", "f8,f8,f8,f8").stdout.decode()
        self.assertIn("4000 rows over 3.999 s at 1000 Hz, speed 90 to 90 deg/s", said)
        self.assertIn("by place", said)

    def test_scaled_integers(self):
        data = b"".join(struct.pack("<Iihh", k, 90000, round(1000 * row[2]) - 5, -7) for k, row in enumerate(self.rows))
        path = self.write("run.bin", data)
        said = self.run_tool("filter", path, "--method", "none", "--format", "raw", "--output-format", "csv", "-q", "--layout",
                             "u4*1e-3:time_s,i4*1e-3:velocity_deg_s,i2*0.001+0.005:torque_nm,i2:spare").stdout.decode().split()
        for line, row in list(zip(said[1:], self.rows))[::400]:
            time, velocity, torque = map(float, line.split(","))
            self.assertAlmostEqual(time, row[0], 12)
            self.assertAlmostEqual(velocity, 90.0, 9)
            self.assertAlmostEqual(torque, row[2], delta=0.000501)

    def test_a_size_that_does_not_fit_names_layouts_that_do(self):
        data = self.dump("<4d", self.names)
        cut = self.refusal(self.write("cut.bin", data[:-5]), "--format", "raw", "--layout", "f8,f8,f8,f8")
        self.assertIn("27 bytes of one more", cut)
        self.assertIn(f"head -c {len(data) - 32}", cut)
        wrong = self.refusal(self.write("run.bin", data), "--format", "raw", "--layout", "f8,f8,f4,f4,f4")
        self.assertRegex(wrong, r"fit: f8,f8,f4,f4,f4,x4 or f8,f8,f4,f4,f4,x\d+|f8,f8")
        self.assertIn("one more", self.refusal_of_pipe(data[:-5]))

    def refusal_of_pipe(self, data):
        return self.run_tool("info", "-", "--format", "raw", "--layout", "f8,f8,f8,f8", stdin=data, code=3).stderr.decode()

    def test_words_that_are_no_layout(self):
        path = self.write("run.bin", b"\0" * 64)
        for layout in ("", "f3", "f8*x", "x0", "f8,,f8", "x99999999"):
            said = self.run_tool("info", path, "--format", "raw", "--layout", layout, code=2).stderr.decode()
            self.assertIn("--layout", said)
        self.assertIn("--layout", self.run_tool("info", path, "--format", "raw", code=2).stderr.decode())


# Recorded messages that name their fields: JSON in MCAP, written by tests/support/bags.py from the published layout.

def parts(ns):
    return ns // 10**9, ns % 10**9


class Json(Messages):
    CHANNEL = [("/joint_states", "JointState", "", "json", "")]

    def texts(self, change=None):
        states = []
        for k, (ns, position, velocity, effort) in enumerate(self.states):
            sec, nanosec = parts(ns)
            state = {"header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": "base"}, "name": NAMES, "position": position,
                     "velocity": velocity, "effort": effort}
            states.append(json.dumps((change or (lambda k, state: state))(k, state)).encode())
        return states

    def recorded(self, change=None, texts=None):
        messages = [(0, ns + 300_000, data) for (ns, *_), data in zip(self.states, texts or self.texts(change))]
        return self.write("run.mcap", bags.mcap(self.CHANNEL, messages))

    def test_it_gives_what_the_text_gives(self):
        self.assert_same(self.recorded(), "--joint", "elbow", twin=self.twin(), twin_options=("--joint", "elbow"))
        self.assert_same(self.recorded(), "--joint", "elbow", "--clock", "log", twin=self.twin(late_ns=300_000),
                         twin_options=("--joint", "elbow"))

    def test_the_order_of_fields_and_fields_that_come_later_change_nothing(self):
        def change(k, state):
            names = list(state)
            names = names[k % len(names):] + names[:k % len(names)]
            more = {"spare": {"deep": [k, [k], {"x": None}]}} if k % 3 else {}
            return {**{name: state[name] for name in names}, **more}
        self.assert_same(self.recorded(change), "--joint", "elbow", twin=self.twin(), twin_options=("--joint", "elbow"))

    def test_paths_of_any_object(self):
        def change(k, state):
            sec, nsec = parts(self.states[k][0])
            return {"timestamp": {"sec": sec, "nsec": nsec}, "arm": [{"tau": 0}, {"tau": self.rows[k][2], "dq": self.rows[k][1]}],
                    "on": True, "large": list(range(100))}
        path = self.recorded(change)
        said = self.run_tool("info", path, "--columns", "torque=/joint_states.arm[1].tau,velocity=/joint_states.arm[1].dq").stdout.decode()
        self.assertIn("torque -0.7879 to 1.393 Nm", said)
        self.assertIn("/joint_states.timestamp", said)
        self.assertNotIn("/joint_states.large", said)

    def test_messages_of_another_shape_are_refused_with_their_number(self):
        def broken(**values):
            return lambda k, state: {**state, **values} if k == 3000 else state
        for change, words in (
                (broken(effort=[1.0]), "no number as effort[1], expected one"),
                (broken(effort=[1.0, 2.0, 3.0]), "3 elements of effort and more, expected 2"),
                (broken(effort=[1.0, None]), "no number as effort[1]"),
                (broken(effort=["1.0", 2.0]), "no number as effort[0]"),
                (broken(name=NAMES[::-1]), "'wrist_1_joint' as name[0], expected 'elbow'")):
            said = self.refusal(self.recorded(change), "--joint", "elbow", command="identify")
            self.assertIn("message 3001, /joint_states: read", said)
            self.assertIn(words, said)
        for text, words in ((b'{"header": ', "a message in JSON"), (b"[1]", "expected an object"), (b"7", "no object"),
                            (b'{"effort":' + b"[" * 100 + b"]" * 100 + b"}", "deeper than 32"), (b'{"effort": [1e999, 0]}', "a message in JSON")):
            texts = self.texts()
            texts[3000] = text
            self.assertIn(words, self.refusal(self.recorded(texts=texts), "--joint", "elbow", command="identify"))


# Arrays with a time beside each: what Simulink and dSPACE export, and HDF5 groups of devices.
UNITS = ("--unit", "velocity=deg/s,position=deg,torque=Nm,time=s")
SIGNALS = {"tau": "torque_nm", "q_dot": "velocity_deg_s", "q": "position_deg"}


@needs("scipy")
class StructsOfMatlab(Case):
    def save(self, name, variables):
        import scipy.io
        scipy.io.savemat(self.folder / name, variables, oned_as="column")
        return self.folder / name

    def array(self, column):
        import numpy
        return numpy.array(self.columns[column])

    def test_a_timeseries_as_struct_is_a_signal(self):
        for word, data in (("Time", "Data"), ("time", "data")):
            path = self.save("run.mat", {"out": {name: {word: self.array("time_s"), data: self.array(column)}
                                                 for name, column in SIGNALS.items()}})
            self.assert_same(path, *UNITS, twin_options=UNITS)
        said = self.run_tool("info", path).stdout.decode()
        self.assertRegex(said, r"out.tau.time +read +4000")
        self.assertRegex(said, r"out.q.time +4000")  # the same clock once more
        self.assertNotIn("2 joints", said)

    def test_a_structure_with_time(self):
        path = self.save("run.mat", {name: {"time": self.array("time_s"), "signals": {"values": self.array(column), "label": name}}
                                     for name, column in SIGNALS.items()})
        self.assert_same(path, *UNITS, twin_options=UNITS)

    def test_what_controldesk_writes(self):
        import numpy
        names = ("torque_nm", "velocity_deg_s", "position_deg")
        y = numpy.zeros((1, 3), dtype=[(field, object) for field in ("Name", "Unit", "Data", "XIndex")])
        for k, name in enumerate(names):
            unit = name.split("_", 1)[1].replace("_", "/").replace("nm", "Nm")
            y[0, k] = f'"Model Root"/"Joint"/{name.split("_")[0]}', unit, self.array(name).reshape(1, -1), numpy.ones((1, 1))
        x = numpy.zeros((1, 1), dtype=[("Name", object), ("Data", object)])
        x[0, 0] = "HostService", self.array("time_s").reshape(1, -1)
        path = self.save("run.mat", {"run_001": {"X": x, "Y": y}})
        self.assert_same(path, "--unit", "time=s", twin_options=("--unit", "time=s"))
        self.assertRegex(self.run_tool("info", path).stdout.decode(), r"run_001.Y\(2\).Data +velocity +deg/s")


@needs("h5py")
class GroupsOfDevices(Case):
    libraries = ("HDF5",)
    columns_option = ("--columns", "torque=/sensor/torque_nm,velocity=/drive/velocity_deg_s,position=/drive/position_deg")

    def two_clocks(self, every=1, late_s=0.0, skip=range(0), times=None, value="velocity_deg_s", name="time_s"):
        """The torque at every row, velocity and position at each `every`th."""
        import h5py
        import numpy
        rows = numpy.array([k for k in range(0, len(self.rows), every) if k not in skip])
        path = self.folder / "two.h5"
        with h5py.File(path, "w") as file:
            file["sensor/time_s"], file["sensor/torque_nm"] = self.columns["time_s"], self.columns["torque_nm"]
            own = numpy.array(self.columns["time_s"])[rows] + late_s
            with numpy.errstate(divide="ignore"):
                file["drive/" + name] = own if times is None else times(own)
            file["drive/velocity_deg_s"] = numpy.array(self.columns[value])[rows]
            file["drive/position_deg"] = numpy.array(self.columns["position_deg"])[rows]
        return path

    def rows_of(self, path, *options):
        text = self.run_tool("filter", path, *self.columns_option, *options, "--method", "none", "-q", "--output-format", "csv")
        return [[float(cell) for cell in line.split(",")] for line in text.stdout.decode().splitlines()[1:]]

    def test_groups_of_one_clock_are_one_log(self):
        import h5py
        path = self.two_clocks()
        self.assert_same(path)
        with h5py.File(path) as file:
            self.assertEqual(file["drive/time_s"][:].tolist(), file["sensor/time_s"][:].tolist())

    def test_clocks_of_their_own_are_joined(self):
        for how in ("linear", "hold", "nearest"):  # at the same moments all are one
            late = self.rows_of(self.two_clocks(late_s=1e-12), "--join", how)
            for found, row in zip(late, self.rows, strict=True):
                self.assertEqual(found[1:], [row[1], row[2], row[3]])
        # The position is a straight line, so that a third of its values say all of it.
        slow = self.two_clocks(3, value="position_deg")
        linear = self.rows_of(slow)
        self.assertEqual(len(linear), 4000)  # 3999 is a multiple of 3
        for found, row in zip(linear, self.rows):
            self.assertAlmostEqual(found[1], row[3], 9)
        for k, found in enumerate(self.rows_of(slow, "--join", "hold")):
            self.assertEqual(found[1], self.rows[k - k % 3][3])
        for k, found in enumerate(self.rows_of(slow, "--join", "nearest")):
            self.assertEqual(found[1], self.rows[k + (0, -1, 1)[k % 3]][3])
        said = self.run_tool("info", slow, *self.columns_option).stdout.decode()
        self.assertIn("by --join linear, from values that are up to 9 ms away", said)
        self.assertRegex(said, r"/drive/position_deg +read +1334")

    def test_units_of_clocks(self):
        plain = self.rows_of(self.two_clocks(3))
        for name, times in (("time_ms", lambda own: 1e3 * own), ("time_ns", lambda own: (1e9 * own).round().astype("i8"))):
            self.assertEqual(self.rows_of(self.two_clocks(3, name=name, times=times)), plain)
        said = self.refusal(self.two_clocks(3, name="time", times=lambda own: (1e3 * own).round().astype("i8")), *self.columns_option)
        self.assertIn("whole numbers without a unit in /drive/time", said)

    def test_what_cannot_be_joined(self):
        gap = self.two_clocks(skip=range(2000, 2050))
        self.assertRegex(self.refusal(gap, *self.columns_option, command="identify"),
                         r"read no value of /drive/position_deg within 0\.003\d* s of the row at")
        back = self.two_clocks(3, times=lambda own: own[::-1])
        self.assertIn("older than the one before", self.refusal(back, *self.columns_option, command="identify"))
        broken = self.two_clocks(3, times=lambda own: own / (own - own[7]))
        self.assertIn("no number of seconds", self.refusal(broken, *self.columns_option, command="identify"))
        other = "time=/drive/time_s,torque=/sensor/torque_nm,velocity=/drive/velocity_deg_s"
        said = self.run_tool("info", self.two_clocks(3), "--columns", other, code=2).stderr.decode()
        self.assertIn("/drive/time_s is not the clock of the torque", said)

    def test_without_a_clock_lengths_must_fit(self):
        import h5py
        with h5py.File(self.folder / "run.h5", "w") as file:
            file["torque_nm"], file["velocity_deg_s"] = self.columns["torque_nm"], self.columns["velocity_deg_s"][::2]
        said = self.run_tool("info", "run.h5", "--columns", "torque=/torque_nm,velocity=/velocity_deg_s", code=2).stderr.decode()
        self.assertIn("their clocks differ", said)
