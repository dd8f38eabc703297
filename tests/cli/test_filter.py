# SPDX-License-Identifier: MIT
"""ripplenotch filter as its users meet it: bytes that pass, decimals, threads."""

import json
import math
import re

import commands
from commands import DATA, ended
from logs import three_joints

LOWPASS = "lowpass,cutoff=13rad/s"


class Case(commands.Case):
    bytes_out = True

    def write(self, name, text):
        path = self.folder / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path


class Bytes(Case):
    def test_every_byte_but_the_torque_cells_passes(self):
        head = "# made by hand\ntime [s];note;velocity [deg/s];\"torque [Nm]\";position [deg]\n"
        rows = [f"{k / 1000:.3f};a{k}  ;  9{k % 10},5;{2 + (k % 7) / 10};+{k}e-1".replace(".", ",") for k in range(400)]
        for end in ("\n", "\r\n"):
            log = self.write("log.csv", end.join((head + "\n".join(rows)).split("\n")) + end)
            out = self.good("filter", log, "--method", LOWPASS, "-q").stdout.decode()
            source = log.read_bytes().decode()
            cut = re.compile(r"^((?:[^;\n]*;){3})[^;\n]*;", re.M)
            self.assertEqual(cut.sub(r"\1T;", out.split(end, 2)[2]), cut.sub(r"\1T;", source.split(end, 2)[2]))
            self.assertEqual(out.split(end, 2)[:2], source.split(end, 2)[:2])
            self.assertRegex(out, r"\d,\d+;\+399e-1")   # the decimal mark of the log

    def test_decimals_shortest_input_or_a_number(self):
        log = DATA / "paper_90deg_s.csv"
        def column(how):
            out = self.good("filter", log, "--method", LOWPASS, "--decimals", how).stdout.decode().splitlines()
            return [line.split(",")[2] for line in out[1:]]
        exact, as_input, two = column("shortest"), column("input"), column("2")
        for a, b, c in zip(exact, as_input, two):
            self.assertRegex(b, r"^-?\d+\.\d{4}$")
            self.assertRegex(c, r"^-?\d+\.\d{2}$")
            self.assertLessEqual(abs(float(a) - float(b)), 0.5000001e-4)
            self.assertLessEqual(abs(float(a) - float(c)), 0.5000001e-2)


class Threads(Case):
    """A log that is well beyond the 4 MiB that one thread takes alone, cut into blocks that are worked on side by side."""

    ROWS = 240_000

    @classmethod
    def setUpClass(cls):
        rows = ["time_s,velocity_deg_s,torque_nm,note"]
        for k in range(cls.ROWS):
            rows.append(f"{k / 1000:.3f},{60 * math.sin(k / 3000):.6f},{math.sin(k / 40) + math.sin(k / 7000):.6f},n{k}")
        for k, comment in ((2, "# between rows, with, commas"), (170_000, "# a line, longer"), (cls.ROWS, "EOF")):
            rows.insert(k, comment)
        cls.text = "\n".join(rows) + "\n"

    def test_any_number_of_threads_gives_the_same_bytes_from_file_and_pipe(self):
        rows = self.text.splitlines()
        rows.append(rows.pop(rows.index("EOF")))  # an end mark stands at the end
        text = "\n".join(rows) + "\n"
        log = self.write("ended.csv", text)
        expected = None
        for threads in (1, 2, 3, 8):
            for source, stdin in ((log, None), ("-", text.encode())):
                got = self.good("filter", source, "--method", LOWPASS, "--threads", threads, "-q", stdin=stdin).stdout
                expected = expected or got
                self.assertEqual(got, expected)
        lines = expected.decode().splitlines()
        self.assertEqual(len(lines), len(rows))
        for mine, theirs in zip(lines, rows):
            if theirs.startswith(("#", "EOF", "time")):
                self.assertEqual(mine, theirs)
            else:
                self.assertEqual([cell for i, cell in enumerate(mine.split(",")) if i != 2],
                                 [cell for i, cell in enumerate(theirs.split(",")) if i != 2])

    def test_a_bad_row_is_named_with_its_line_and_what_came_before_is_the_same(self):
        rows = self.text.splitlines()
        for line, bad, said in ((190_000, "oops", "5: read 1 cells, expected 4"),
                                (self.ROWS + 1, "9999,1,1,n", "1: read a row after the line EOF")):
            text = "\n".join([*rows[:line], bad, *rows[line + 1:]]).encode()
            outputs = set()
            for threads in (1, 2, 5):
                done = ended(3, self.run_tool("filter", "-", "--method", LOWPASS, "--threads", threads, "-q", stdin=text))
                self.assertIn(f"standard input:{line + 1}:{said}", done.stderr.decode())
                outputs.add(done.stdout)
            self.assertEqual(len(outputs), 1)

    def test_time_that_runs_backward_between_blocks_is_found_at_its_line(self):
        rows = self.text.splitlines()
        for line in range(20_000, 140_000, 30_000):
            row = rows[line - 1]
            text = "\n".join([*rows[:line], "0.001" + row[row.index(","):], *rows[line:]]).encode()
            for threads in (1, 4):
                done = ended(3, self.run_tool("filter", "-", "--method", LOWPASS, "--threads", threads, "-q", stdin=text))
                self.assertIn(f"standard input:{line + 1}:1: read the time 0.001 after", done.stderr.decode())


# Several joints of a log in one pass: the same bytes as one joint after another.

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
