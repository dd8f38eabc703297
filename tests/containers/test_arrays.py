# SPDX-License-Identifier: MIT
"""Arrays in NPZ, MAT and HDF5, written by NumPy, SciPy, Octave and h5py."""

import os
import shutil
import struct
import subprocess
import unittest

from container_case import LOG, Case, needs


@needs("numpy")
class Npz(Case):
    def test_vectors_under_names(self):
        import numpy
        arrays = {name: numpy.array(values) for name, values in self.columns.items()}
        for save in (numpy.savez, numpy.savez_compressed):
            save(self.folder / "run.npz", **arrays)
            self.assert_same(self.folder / "run.npz")
        numpy.savez(self.folder / "other.npz", notes=numpy.array(["a", "b"]), short=numpy.arange(7), **arrays)
        self.assert_same(self.folder / "other.npz")

    def test_a_short_vector_with_a_name_of_a_signal_is_a_parameter(self):
        import numpy
        arrays = {name: numpy.array(values) for name, values in self.columns.items() if name != "torque_nm"}
        limits = numpy.linspace(1, 40, 48)
        numpy.savez(self.folder / "limits.npz", torque_limits=limits, tau_nm=limits, speed=limits, time=limits,
                    position_deg=arrays["position_deg"], velocity_deg_s=arrays["velocity_deg_s"])
        text = self.run_tool("info", self.folder / "limits.npz", "--sample-rate", "1kHz").stdout.decode()
        self.assertIn(f"{len(arrays['position_deg'])} rows", text.split("\n")[0])
        self.assertIn("tau_nm", text)  # listed among what the file holds

    def test_matrices_of_either_order(self):
        import numpy
        tau = numpy.array([[value, -value, 0.0] for value in self.columns["torque_nm"]])
        rest = {name: numpy.array(self.columns[name]) for name in ("time_s", "velocity_deg_s", "position_deg")}
        for kind, matrix in (("c", tau), ("fortran", numpy.asfortranarray(tau)), ("rows", numpy.ascontiguousarray(tau.T))):
            for save in (numpy.savez, numpy.savez_compressed):
                save(self.folder / f"{kind}.npz", torque_nm=matrix, **rest)
                path = "torque_nm[0,:]" if kind == "rows" else "torque_nm[:,0]"
                columns = f"time=time_s,velocity=velocity_deg_s,torque={path},position=position_deg"
                self.assert_same(self.folder / f"{kind}.npz", "--columns", columns, twin_options=())

    def test_damage(self):
        import numpy
        numpy.savez_compressed(self.folder / "run.npz", **self.columns)
        data = (self.folder / "run.npz").read_bytes()
        self.assertIn("cut off", self.refusal(self.write("cut.npz", data[:-200])))
        self.write("bad.npz", data[:300] + bytes(200) + data[500:])
        self.refusal(self.folder / "bad.npz")

    def test_numbers_that_do_not_have_their_checksum(self):
        """One bit of a torque, which is a number as good as the right one; packed in blocks that are stored."""
        import zipfile
        import numpy
        numpy.savez(self.folder / "run.npz", **{name: numpy.array(values) for name, values in self.columns.items()})
        data = (self.folder / "run.npz").read_bytes()
        with zipfile.ZipFile(self.folder / "run.npz") as whole, zipfile.ZipFile(self.folder / "packed.npz", "w") as packed:
            for member in whole.namelist():
                packed.writestr(member, whole.read(member), zipfile.ZIP_DEFLATED, 0)
        for stored in (data, (self.folder / "packed.npz").read_bytes()):
            at = stored.index(struct.pack("<2d", *self.columns["torque_nm"][2000:2002]))
            self.assert_same(self.write("good.npz", stored))
            flipped = self.write("flipped.npz", stored[:at + 2] + bytes([stored[at + 2] ^ 1]) + stored[at + 3:])
            self.assertRegex(self.refusal(flipped, command="identify"), r"checksum [0-9a-f]{8}, expected [0-9a-f]{8}")


@needs("scipy")
class Mat(Case):
    def savemat(self, name, values, **options):
        import scipy.io
        scipy.io.savemat(self.folder / name, values, **options)
        return self.folder / name

    def test_vectors_packed_or_not_of_either_direction(self):
        for packed in (False, True):
            for direction in ("row", "column"):
                path = self.savemat("run.mat", self.columns, do_compression=packed, oned_as=direction)
                self.assert_same(path)
        self.assertEqual(self.identified("-", stdin=path.read_bytes()), self.identified(path))

    def test_matrices_and_structs_by_path(self):
        import numpy
        tau = numpy.array([[-value, 0.0, value] for value in self.columns["torque_nm"]])
        log = {"t": self.columns["time_s"], "q_dot": numpy.array(self.columns["velocity_deg_s"]),
               "q": numpy.array(self.columns["position_deg"]), "note": "warm", "count": 7}
        units = ("--unit", "velocity=deg/s", "--unit", "position=deg", "--unit", "torque=Nm")
        for name, matrix, path in (("columns", tau, "log.tau(:,3)"), ("rows", tau.T, "log.tau(3,:)")):
            for packed in (False, True):
                file = self.savemat(f"{name}.mat", {"log": {**log, "tau": matrix}, "other": 3.0}, do_compression=packed, oned_as="column")
                columns = f"time=log.t,velocity=log.q_dot,torque={path},position=log.q"
                found = json_of(self.run_tool("identify", "--json", file, "--columns", columns, *units))
                twin = json_of(self.run_tool("identify", "--json", self.plain(), *units))
                self.assertEqual(found["gear_ratio"], twin["gear_ratio"])
                self.assertEqual(found["lines"], twin["lines"])

    def plain(self):
        lines = ["t,dq,q,tau"] + [f"{a!r},{b!r},{d!r},{c!r}" for a, b, c, d in self.rows]
        return self.write("plain.csv", ("\n".join(lines) + "\n").encode())

    def test_info_lists_what_is_there_and_marks_what_is_read(self):
        import numpy
        path = self.savemat("run.mat", {**self.columns, "image": numpy.zeros((80, 90)), "z": numpy.array([1 + 2j, 3]), "words": "warm"})
        said = self.run_tool("info", path).stdout.decode()
        self.assertRegex(said, r"torque_nm +read +4000 +float64")
        self.assertRegex(said, r"image +80 x 90 +numbers")
        self.assertRegex(said, r"z +.*complex")

    def test_integers_and_big_endian_files(self):
        import numpy
        path = self.savemat("run.mat", {**self.columns, "torque_nm": numpy.array(self.columns["torque_nm"], dtype=">f8")})
        self.assert_same(path)
        whole = {**self.columns, "velocity_deg_s": numpy.full(len(self.rows), 90, dtype=numpy.int16)}
        self.assert_same(self.savemat("whole.mat", whole))

    def test_damage_and_what_is_no_log(self):
        path = self.savemat("run.mat", self.columns, do_compression=True)
        data = path.read_bytes()
        self.assertIn("cut off", self.refusal(self.write("cut.mat", data[:-300])))
        damaged = bytearray(data)
        damaged[len(data) // 2] ^= 0xff
        self.refusal(self.write("bad.mat", bytes(damaged)))
        self.assertIn("arrays of numbers", self.refusal(self.savemat("none.mat", {"words": "warm", "one": 1.0})))
        said = self.run_tool("identify", path, "--columns", "torque=tauu", code=2).stderr.decode()
        self.assertIn("torque_nm", said)

    def test_what_is_written_is_read_by_scipy(self):
        import scipy.io
        for how in (("-o", "out.mat"), ("-o", "-", "--output-format", "mat")):
            done = self.run_tool("filter", LOG, "--method", "none", "-q", *how)
            path = self.folder / "out.mat" if done.stdout == b"" else self.write("piped.mat", done.stdout)
            found = scipy.io.loadmat(path)
            for name, values in self.columns.items():
                self.assertEqual(found[name].shape, (len(values), 1))
                self.assertEqual(found[name][:, 0].tolist(), values)
            self.assert_same(path)
        self.assertEqual((self.folder / "out.mat").read_bytes(), (self.folder / "piped.mat").read_bytes())

    def test_function_handles_and_objects_are_listed(self):
        def element(kind, data):
            return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)

        def head(code, *rest):
            return element(6, struct.pack("<II", code, 0)) + b"".join(rest)
        plain = self.savemat("run.mat", self.columns, oned_as="column").read_bytes()
        handle = element(14, head(16, element(5, struct.pack("<ii", 1, 1)), element(1, b"fun"), element(14, b"")))
        table = element(14, head(17, element(1, b"runs"), element(1, b"MCOS"), element(1, b"table"), element(14, b"")))
        path = self.write("odd.mat", plain[:128] + handle + table + plain[128:])
        self.assert_same(path)
        said = self.run_tool("info", path).stdout.decode()
        self.assertRegex(said, r"fun +1 x 1 +a function handle")
        self.assertRegex(said, r"runs +an object of class table; in MATLAB: s = table2struct\(runs")
        self.assertIn("expected arrays of numbers", self.refusal(self.write("none.mat", plain[:128] + handle + table)))
        deep = element(14, b"")
        for _ in range(20):
            deep = element(14, head(2, element(5, struct.pack("<ii", 1, 1)), element(1, b""), element(5, struct.pack("<i", 2)),
                                    element(1, b"a\0"), deep))
        self.assertIn("nested deeper", self.refusal(self.write("deep.mat", plain[:128] + deep)))

    @unittest.skipUnless(shutil.which("octave-cli"), "no Octave here")
    def test_octave_writes_the_same(self):
        (self.folder / "run.csv").write_bytes(b"\n".join(",".join(map(repr, row)).encode() for row in self.rows))
        script = ("m = csvread('run.csv'); time_s = m(:,1); velocity_deg_s = m(:,2); torque_nm = m(:,3); position_deg = m(:,4); "
                  "log.time_s = time_s; log.velocity_deg_s = velocity_deg_s; log.torque_nm = torque_nm; log.position_deg = position_deg; "
                  "save('-v6', 'six.mat', 'time_s', 'velocity_deg_s', 'torque_nm', 'position_deg'); "
                  "save('-v7', 'seven.mat', 'log'); save('-hdf5', 'struct.h5', 'log'); "
                  "save('-hdf5', 'plain.h5', 'time_s', 'velocity_deg_s', 'torque_nm', 'position_deg');")
        subprocess.run(["octave-cli", "--no-init-file", "--eval", script], cwd=self.folder, check=True, capture_output=True, timeout=60)
        self.assert_same(self.folder / "six.mat")
        self.assert_same(self.folder / "seven.mat")
        if "HDF5" not in os.environ["RIPPLENOTCH_LACKS"].split(","):
            self.assert_same(self.folder / "plain.h5")
            self.assert_same(self.folder / "struct.h5")


def json_of(done):
    import json
    return json.loads(done.stdout)


@needs("h5py")
class Hdf5(Case):
    libraries = ("HDF5",)

    def file(self, name="run.h5", **options):
        import h5py
        file = h5py.File(self.folder / name, "w", **options)
        self.addCleanup(file.close)
        return file

    def test_datasets_in_every_layout(self):
        for packed in ({}, {"chunks": (100,)}, {"chunks": (1000,), "compression": "gzip", "shuffle": True, "fletcher32": True}):
            for version in ("earliest", "latest"):
                file = self.file(libver=version)
                for name, values in self.columns.items():
                    file.create_dataset("robot/log/" + name, data=values, **packed)
                file.close()
                self.assert_same(self.folder / "run.h5")
        self.assertEqual(self.identified("-", stdin=(self.folder / "run.h5").read_bytes()), self.identified(self.folder / "run.h5"))

    def test_columns_members_types_and_units(self):
        import numpy
        file = self.file()
        file["tau"] = numpy.array([[0.0, value] for value in self.columns["torque_nm"]])
        file["table"] = numpy.array([(row[0], row[1], [row[3], 0.0]) for row in self.rows],
                                    dtype=[("time_s", ">f8"), ("velocity", "<f8"), ("position", "<f8", (2,))])
        file["velocity"] = numpy.radians(self.columns["velocity_deg_s"])
        file["velocity"].attrs["units"] = "rad/s"
        file.close()
        columns = "time=/table.time_s,velocity=/table.velocity,torque=/tau[:,1],position=/table.position[:,0]"
        self.assert_same(self.folder / "run.h5", "--columns", columns, "--unit", "velocity=deg/s,position=deg,torque=Nm",
                         twin_options=("--unit", "velocity=deg/s,position=deg,torque=Nm"))
        said = self.run_tool("info", self.folder / "run.h5", "--columns", columns).stdout.decode()
        self.assertRegex(said, r"/velocity +read +4000 +float64 +rad/s")

    def test_nothing_outside_of_the_file_is_followed(self):
        import h5py
        secret = self.file("secret.h5")
        for name, values in self.columns.items():
            secret[name] = values
        secret.close()
        file = self.file("links.h5")
        for name in ("time_s", "velocity_deg_s"):
            file[name] = self.columns[name]
        file["torque_nm"] = h5py.ExternalLink("secret.h5", "/torque_nm")
        layout = h5py.VirtualLayout(shape=(len(self.rows),), dtype="f8")
        layout[:] = h5py.VirtualSource("secret.h5", "position_deg", shape=(len(self.rows),))
        file.create_virtual_dataset("position_deg", layout)
        file.close()
        self.write("numbers.bin", struct.pack("<4000d", *self.columns["torque_nm"]))
        file = self.file("links.h5x")
        file.close()
        said = self.run_tool("info", self.folder / "links.h5").stdout.decode()
        self.assertRegex(said, r"/torque_nm +a link to another file, not followed")
        self.assertRegex(said, r"/position_deg +4000 +numbers outside of the file, not followed")
        self.assertIn("/torque_nm (a link to another file, not followed), expected a torque column",
                      self.refusal(self.folder / "links.h5", command="identify"))
        file = self.file("away.h5")
        file["torque_nm"] = h5py.ExternalLink("secret.h5", "/torque_nm")
        file.close()
        self.assertIn("/torque_nm (a link to another file", self.refusal(self.folder / "away.h5"))

    def test_matlab_head_and_paths(self):
        file = self.file("run.mat", userblock_size=512)
        group = file.create_group("log")
        import numpy
        for name, values in (*self.columns.items(), ("words", [119, 97, 114, 109])):
            data = numpy.array([values], dtype="u2" if name == "words" else "f8")
            dataset = group.create_dataset(name, data=data if name != "torque_nm" else numpy.array([values, values]))
            dataset.attrs["MATLAB_class"] = numpy.bytes_("char" if name == "words" else "double")
        file.close()
        path = self.folder / "run.mat"
        data = bytearray(path.read_bytes())
        data[:128] = b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\x02IM"
        path.write_bytes(bytes(data))
        said = self.run_tool("info", path, "--columns", "torque=log.torque_nm(:,2)").stdout.decode()
        self.assertIn("torque -0.7879 to 1.393 Nm", said)
        self.assertRegex(said, r"log.torque_nm +read +4000 x 2")

    def test_objects_of_matlab_say_what_they_are_and_how_to_save_their_numbers(self):
        import numpy
        for name, kind, lines in (("tau", "timeseries", "t = tau.Time; tau = tau.Data; save('run.mat', 't', 'tau')"),
                                  ("runs", "table", "s = table2struct(runs, 'ToScalar', true); save('run.mat', '-struct', 's')"),
                                  ("out", "Simulink.SimulationOutput", "x = out.logsout.get('tau').Values; t = x.Time")):
            file = self.file("run.mat", userblock_size=512)
            dataset = file.create_dataset(name, data=numpy.array([[0xdd000000, 2, 1, 1, 1, 1]], dtype="u4"))
            dataset.attrs["MATLAB_class"] = numpy.bytes_(kind)
            dataset.attrs["MATLAB_object_decode"] = numpy.int32(3)
            file.close()
            data = bytearray((self.folder / "run.mat").read_bytes())
            data[:128] = b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\x02IM"
            (self.folder / "run.mat").write_bytes(bytes(data))
            said = self.refusal(self.folder / "run.mat")
            self.assertIn(f"{name} (an object of class {kind}; in MATLAB", said)
            self.assertIn(lines, said)

    def test_what_is_written_is_read_by_h5py(self):
        import h5py
        self.run_tool("filter", LOG, "--method", "none", "-q", "-o", "out.h5")
        with h5py.File(self.folder / "out.h5") as found:
            for name, values in self.columns.items():
                self.assertEqual(found[name][:].tolist(), values)
        self.assert_same(self.folder / "out.h5")
        first = (self.folder / "out.h5").read_bytes()
        self.run_tool("filter", "out.h5", "--method", "none", "-q", "-o", "again.h5")
        self.assertEqual((self.folder / "again.h5").read_bytes(), first)

    def test_damage(self):
        file = self.file()
        for name, values in self.columns.items():
            file.create_dataset(name, data=values, chunks=(500,), compression="gzip")
        file.close()
        data = (self.folder / "run.h5").read_bytes()
        self.assertIn("cut off", self.refusal(self.write("cut.h5", data[:len(data) // 2])))
