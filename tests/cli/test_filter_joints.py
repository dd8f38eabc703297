# SPDX-License-Identifier: MIT
"""Several joints of a log in one pass: the same bytes as one joint after another."""

import json

from logs import three_joints
from test_filter import Case


class Joints(Case):
    def setUp(self):
        super().setUp()
        self.log = self.write("wide.csv", three_joints())
        for joint, ratio in (("j1", 100), ("j2", 120), ("j3", 80)):
            self.good("design", "--gear-ratio", ratio, "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "20:180:20",
                      "--q", "1", "-o", f"{joint}.json")

    def one_after_another(self, log, name, *words):
        for joint in ("j1", "j2", "j3"):
            done = f"{name}_{joint}{log.suffix}"
            self.good("filter", log, "--joint", joint, *[w.replace("{joint}", joint) for w in words], "-o", done)
            log = self.folder / done
        return log.read_bytes()

    def test_one_pass_gives_the_bytes_of_one_joint_after_another(self):
        for name, words in (("own", ("--method", "switching,table={joint}.json")), ("low", ("--method", "lowpass,cutoff=5Hz,order=2")),
                            ("fixed", ("--method", "fixed,centers=20Hz,q=1", "--decimals", "4")),
                            ("parallel", ("--method", "switching,table={joint}.json,transition=parallel,hysteresis=2deg/s"))):
            with self.subTest(name):
                together = self.good("filter", self.log, "--joint", "all", *words).stdout
                self.assertTrue(together == self.one_after_another(self.log, name, *words), "not the same bytes")
                self.assertTrue(together != self.log.read_bytes(), "nothing was filtered")

    def test_any_number_of_threads_gives_the_same_bytes(self):
        log = self.write("long.csv", three_joints(80_000))
        self.assertGreater(log.stat().st_size, 6 << 20)  # threads start behind 4 MiB
        outputs = {self.good("filter", log, "--joint", "all", "--method", "switching,table={joint}.json", "--threads", threads).stdout
                   for threads in (1, 2, 3)}
        self.assertEqual(len(outputs), 1)

    def test_arrays_too(self):
        self.good("filter", self.log, "--joint", "all", "--method", "none", "-o", "wide.npy")
        together = self.good("filter", "wide.npy", "--joint", "all", "--method", "switching,table={joint}.json", "-o", "all.npy")
        self.assertEqual(together.stdout, b"")
        one_by_one = self.one_after_another(self.folder / "wide.npy", "array", "--method", "switching,table={joint}.json")
        self.assertTrue((self.folder / "all.npy").read_bytes() == one_by_one, "not the same bytes")

    def test_added_columns_bear_the_joints_names(self):
        text = self.good("filter", self.log, "--joint", "all", "--method", "none", "--append").stdout.decode().splitlines()
        self.assertTrue(text[0].endswith(",j1_torque_filtered_nm,j2_torque_filtered_nm,j3_torque_filtered_nm"), text[0])
        cells = text[1].split(",")
        self.assertEqual([float(c) for c in cells[-3:]], [float(cells[2]), float(cells[5]), float(cells[9])])
        # What was added is read again, by name.
        self.write("added.csv", "\n".join(text) + "\n")
        self.good("filter", "added.csv", "--joint", "j2", "--columns", "torque=j2_torque_filtered_nm,velocity=j2_velocity_deg_s",
                  "--method", "none")

    def test_each_joint_has_metrics_of_its_own_and_they_are_those_of_one_joint(self):
        self.good("filter", self.log, "--joint", "all", "--method", "switching,table={joint}.json", "--metrics", "m_{joint}.json", "-o", "all.csv")
        for joint, ratio in (("j1", 100), ("j2", 120), ("j3", 80)):
            alone = self.good("filter", self.log, "--joint", joint, "--method", f"switching,table={joint}.json", "--json", "-o", f"x_{joint}.csv")
            first, second = json.loads((self.folder / f"m_{joint}.json").read_text()), json.loads(alone.stdout)
            for metrics in (first, second):
                metrics.pop("provenance", None)
                metrics.pop("created_by", None)
            self.assertEqual(first["joint"], joint)
            self.assertEqual(first["gear_ratio"], ratio)
            self.assertGreater(first["switch_count"], 0)
            for key in set(first) | set(second):
                if key not in ("command", "inputs", "tool"):
                    self.assertEqual(first.get(key), second.get(key), key)

    def test_motion_before_the_gears_is_divided_by_each_joints_own_ratio(self):
        text = three_joints()
        head, *rows = (line.split(",") for line in text.splitlines())
        columns = [(head.index(f"{joint}_velocity_deg_s"), ratio) for joint, ratio in (("j1", 100), ("j2", 120), ("j3", 80))]
        for column, _ in columns:
            head[column] = head[column].replace("velocity_deg_s", "motor_velocity_rpm")
        for row in rows:
            for column, ratio in columns:
                row[column] = f"{float(row[column]) * ratio / 6:.4f}"
        before = self.write("motors.csv", "\n".join(",".join(row) for row in (head, *rows)) + "\n")
        words = ("--joint", "all", "--method", "switching,table={joint}.json")
        self.good("filter", before, *words, "--metrics", "m_{joint}.json", "-o", "motors_done.csv", "--decimals", "9")
        self.good("filter", self.log, *words, "--metrics", "n_{joint}.json", "-o", "joints_done.csv", "--decimals", "9")
        for joint in ("j1", "j2", "j3"):
            motor, behind = (json.loads((self.folder / f"{m}_{joint}.json").read_text()) for m in "mn")
            # The speeds have four decimals: one in the last place moves a switch by no row.
            self.assertEqual(motor["switch_count"], behind["switch_count"], joint)
        torques = [[[float(c) for i, c in enumerate(line.split(",")) if head[i].endswith("torque_nm")]
                    for line in (self.folder / name).read_text().splitlines()[1:]] for name in ("motors_done.csv", "joints_done.csv")]
        self.assertLess(max(abs(a - b) for m, n in zip(*torques) for a, b in zip(m, n)), 1e-4)
