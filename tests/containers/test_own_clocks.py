# SPDX-License-Identifier: MIT
"""Arrays with a time beside each: what Simulink and dSPACE export, and HDF5 groups of devices."""

from container_case import Case, needs

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
