# SPDX-License-Identifier: MIT
"""Raw dumps, written by struct."""

import struct

from container_case import LOG, Case


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
