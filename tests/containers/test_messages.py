# SPDX-License-Identifier: MIT
"""Recorded messages: MCAP written from its published layout by tests/support/bags.py, rosbag2 by SQLite."""

import json
import math
import shutil
import subprocess
import sys
import unittest

from commands import SOURCE
from container_case import LOG, Case, there
import bags

NAMES = ["elbow", "wrist_1_joint"]
RAD = math.pi / 180.0
EPOCH = 1_700_000_000_123_456_789


class Messages(Case):
    """Joint elbow does what data/paper_90deg_s.csv says, the wrist its half."""

    def setUp(self):
        super().setUp()
        self.states = []
        for k, row in enumerate(self.rows):
            motion = [[row[3] * RAD, 0.5 * row[3] * RAD], [row[1] * RAD, 0.5 * row[1] * RAD], [row[2], 0.5 * row[2]]]
            self.states.append((EPOCH + 1_000_000 * k, *motion))

    made = {}  # by options: every test has the same log

    def joint_states(self, **options):
        key = tuple(sorted(options.items()))
        if key not in self.made:
            self.made[key] = [bags.joint_state(ns, NAMES, *motion, **options) for ns, *motion in self.states]
        return list(self.made[key])

    def channels(self):
        return [("/joint_states", "sensor_msgs/msg/JointState", bags.JOINT_STATE), ("/hello", "std_msgs/msg/String", "string data\n"),
                ("/load", "std_msgs/msg/Float64", "float64 data\n"), ("/log", "rcl/Log", "{}", "json", "jsonschema")]

    def messages(self, states=None, late_ns=300_000):
        found = []
        for k, data in enumerate(states or self.joint_states()):
            found.append((0, self.states[k][0] + late_ns, data))
            if k % 100 == 0:
                found.append((1, self.states[k][0], bags.Cdr().text("hello").bytes()))
                found.append((2, self.states[k][0], bags.Cdr().number("d", 1.5).bytes()))
                found.append((3, self.states[k][0], b"{}"))
        return found

    def bag(self, name="run.mcap", states=None, channels=None, **options):
        return self.write(name, bags.mcap(channels or self.channels(), self.messages(states), **options))

    def twin(self, late_ns=0):
        lines = ["stamp_ns," + ",".join(f"{joint} {word}" for word in ("position", "velocity", "effort") for joint in NAMES)]
        for ns, *motion in self.states:
            lines.append(",".join([str(ns + late_ns), *(repr(value) for part in motion for value in part)]))
        return self.write("twin.csv", ("\n".join(lines) + "\n").encode())


class Mcap(Messages):
    def test_every_packing_gives_what_the_text_gives(self):
        twin = self.twin()
        for packing, module in (("", None), ("zstd", "zstandard"), ("lz4", "lz4")):
            if module and not there(module):
                print(f"skipped: no {module} here to pack", file=sys.stderr)
                continue
            for options in ({}, {"crc": False}, {"summary": False}, {"chunk_bytes": 100}, {"chunk_bytes": 10**9}):
                path = self.bag(compression=packing, **options)
                self.assert_same(path, "--joint", "elbow", twin=twin, twin_options=("--joint", "elbow"))
        path = self.bag(chunked=False)
        self.assert_same(path, "--joint", "wrist_1_joint", twin=twin, twin_options=("--joint", "wrist_1_joint"))
        piped = self.identified("-", "--joint", "elbow", stdin=path.read_bytes())
        self.assertEqual(piped, self.identified(twin, "--joint", "elbow"))

    def test_all_that_follows_is_the_same(self):
        twin, path = self.twin(), self.bag()
        for command in (("spectrum",), ("spectrum", "--track", "--gear-ratio", "100", "--orders", "1,2"), ("diagnose", "--model", "auto")):
            got, expected = (self.identified(log, "--joint", "elbow", command=command) for log in (path, twin))
            self.assertEqual(got, expected, command[0])
        method = ("--joint", "elbow", "--method", "oscillator,gear-ratio=100,orders=1:2", "--output-format", "npy")
        self.assertEqual(self.run_tool("filter", path, *method).stdout, self.run_tool("filter", twin, *method).stdout)

    def test_either_byte_order_and_texts_of_any_length(self):
        states = [bags.joint_state(ns, NAMES, *motion, big_endian=k % 2 == 0, frame="b" * (k % 5)) for k, (ns, *motion) in enumerate(self.states)]
        self.assert_same(self.bag(states=states), "--joint", "elbow", twin=self.twin(), twin_options=("--joint", "elbow"))

    def test_the_clock_is_the_stamp_or_the_time_of_recording(self):
        path = self.bag()
        late = self.twin(late_ns=300_000)
        self.assert_same(path, "--joint", "elbow", "--clock", "log", twin=late, twin_options=("--joint", "elbow"))
        unstamped = [bags.joint_state(0, NAMES, *motion) for _, *motion in self.states]
        self.assert_same(self.bag(states=unstamped), "--joint", "elbow", twin=late, twin_options=("--joint", "elbow"))
        said = self.run_tool("info", path, "--columns", "torque=/load.data", "--clock", "header", code=2).stderr.decode()
        self.assertIn("no header", said)

    def test_info_lists_topics_and_marks_the_one_that_is_read(self):
        said = self.run_tool("info", self.bag()).stdout.decode()
        self.assertRegex(said, r"/joint_states.effort\[0..1\] +read +4000 messages +float64 +1000")
        self.assertRegex(said, r"/load.data +40 messages +float64")
        self.assertRegex(said, r"/log +.*rcl/Log, no numbers")
        self.assertIn("elbow", said)
        found = json.loads(self.run_tool("info", self.bag(), "--json").stdout)
        self.assertEqual([e["read"] for e in found["contents"] if e["path"] == "/load.data"], [False])

    def test_paths_and_other_types(self):
        schema = "Point[2] points\nfloat32 spare\nint32[<=5] codes\n" + "=" * 80 + "\nMSG: my_msgs/Point\nfloat64 tau # Nm\nfloat64 dq\nuint8 LIMIT=3\n"
        states = [bags.Cdr().number("d", 0.0, 0.0, row[2], row[1] * RAD).number("f", 1.0).numbers("i", [1] * (k % 4)).bytes()
                  for k, row in enumerate(self.rows)]
        path = self.bag(states=states, channels=[("/state", "my_msgs/msg/Point2", schema), *self.channels()[1:]])
        columns = "torque=/state.points[1].tau,velocity=/state.points[1].dq"
        said = self.run_tool("info", path, "--columns", columns).stdout.decode()
        self.assertIn("torque -0.7879 to 1.393 Nm", said)

    def two_topics(self, every, skip=(), late_ns=0, value=lambda row: row[1]):
        """Torque at every row, velocity and position at each `every`th."""
        channels = [("/torque", "std_msgs/msg/Float64", "float64 data\n"),
                    ("/motion", "my_msgs/msg/Motion", "float64 velocity_deg_s\nfloat64 position_deg\n")]
        messages = []
        for k, row in enumerate(self.rows):
            messages.append((0, EPOCH + 1_000_000 * k, bags.Cdr().number("d", row[2]).bytes()))
            if k % every == 0 and k not in skip:
                messages.append((1, EPOCH + 1_000_000 * k + late_ns, bags.Cdr().number("d", value(row), row[3]).bytes()))
        return self.write("two.mcap", bags.mcap(channels, messages, chunk_bytes=1000))

    def test_topics_with_clocks_of_their_own_are_joined(self):
        columns = ("--columns", "torque=/torque.data,velocity=/motion.velocity_deg_s,position=/motion.position_deg", "--unit", "torque=Nm")

        def rows(path, *options):
            text = self.run_tool("filter", path, *columns, *options, "--method", "none", "-q", "--output-format", "csv").stdout.decode()
            return [[float(cell) for cell in line.split(",")] for line in text.splitlines()[1:]]
        for how in ("linear", "hold", "nearest"):  # at the same moments all are one
            for found, row in zip(rows(self.two_topics(1), "--join", how), self.rows, strict=True):
                self.assertEqual(found[1:], [row[1], row[2], row[3]])
        # The position is a straight line, so that a third of its messages say all of it.
        slow = self.two_topics(3, value=lambda row: row[3])
        linear = rows(slow)
        self.assertEqual(len(linear), 4000)  # 3999 is a multiple of 3
        for found, row in zip(linear, self.rows):
            self.assertAlmostEqual(found[1], row[3], 9)
        for k, found in enumerate(rows(slow, "--join", "hold")):
            self.assertEqual(found[1], self.rows[k - k % 3][3])
        for k, found in enumerate(rows(slow, "--join", "nearest")):
            self.assertEqual(found[1], self.rows[k + (0, -1, 1)[k % 3]][3])
        said = self.run_tool("info", slow, *columns).stdout.decode()
        self.assertIn("by --join linear, from messages that are up to 9 ms away", said)
        self.assertRegex(said, r"/motion.position_deg +read +1334 messages")
        late = rows(self.two_topics(1, late_ns=250_000), "--join", "hold")
        self.assertEqual((len(late), late[0][2], late[0][1]), (3999, self.rows[1][2], self.rows[0][1]))

    def test_what_cannot_be_joined(self):
        columns = ("--columns", "torque=/torque.data,velocity=/motion.velocity_deg_s", "--unit", "torque=Nm")
        gap = self.two_topics(1, skip=range(2000, 2050))
        for how in ("linear", "hold", "nearest"):
            said = self.refusal(gap, *columns, "--join", how, command="identify")
            self.assertRegex(said, r"read no message of /motion.velocity_deg_s within 0\.003\d* s")
        self.assertIn("none of nearest, hold, linear", self.run_tool("info", gap, "--join", "cubic", code=2).stderr.decode())

    def test_filtering_writes_text(self):
        text = self.run_tool("filter", self.bag(), "--joint", "elbow", "--method", "none", "--output-format", "csv").stdout.decode().split("\n")
        self.assertTrue(text[0].startswith("time_s,velocity_deg_s,torque_nm"))
        self.assertEqual(float(text[5].split(",")[2]), self.rows[4][2])
        part = self.run_tool("filter", self.bag(), "--joint", "elbow", "--method", "none", "--output-format", "csv", "--from", "1s",
                             "--to", "1.5s", "-q").stdout.decode()
        self.assertIn(len(part.split("\n")) - 2, (500, 501))

    def test_what_is_wrong_is_said_with_its_place(self):
        whole = self.bag().read_bytes()
        self.assertIn("cut off", self.refusal(self.write("cut.mcap", whole[:len(whole) // 2]), command="identify"))
        damaged = bytearray(whole)
        damaged[len(whole) // 2] ^= 1
        self.assertRegex(self.refusal(self.write("bad.mcap", bytes(damaged)), "--joint", "elbow", command="identify"), "checksum|read at byte")
        odd = bags.mcap(self.channels(), self.messages()[:50])
        self.refusal(self.write("odd.mcap", odd[:60] + b"\xff" * 30 + odd[90:]))

    def test_unknown_packing(self):
        path = self.write("run.mcap", bags.mcap(self.channels(), self.messages()[:50], compression="brotli"))
        self.assertIn("'brotli', expected zstd, lz4 or none", self.refusal(path))

    def test_messages_that_change(self):
        shorter = self.joint_states()
        ns, *motion = self.states[3000]
        shorter[3000] = bags.joint_state(ns, NAMES[:1], *[part[:1] for part in motion])
        self.assertIn("expected 2", self.refusal(self.bag(states=shorter), "--joint", "elbow", command="identify"))
        swapped = self.joint_states()
        swapped[3000] = bags.joint_state(ns, NAMES[::-1], *motion)
        self.assertIn("expected 'elbow'", self.refusal(self.bag(states=swapped), "--joint", "elbow", command="identify"))
        ended = self.joint_states()
        ended[3000] = ended[3000][:-9]
        self.assertIn("ends after", self.refusal(self.bag(states=ended), "--joint", "elbow", command="identify"))
        back = self.joint_states()
        back[3000] = back[2000]
        self.assertIn("time to run forward", self.refusal(self.bag(states=back), "--joint", "elbow", command="identify"))
        nan = self.joint_states()
        nan[3000] = bags.joint_state(ns, NAMES, motion[0], motion[1], [math.nan, 0.0])
        self.assertIn("finite", self.refusal(self.bag(states=nan), "--joint", "elbow", command="identify"))

    def test_types_that_cannot_be_read(self):
        def channel(schema):
            return [("/joint_states", "a/msg/B", schema), *self.channels()[1:]]
        for schema, words in (("B inner\n", "holds itself"), ("c/Unknown x\n", "not defined"), ("wstring w\n", "wide text")):
            path = self.write("run.mcap", bags.mcap(channel(schema), self.messages()[:200]))
            said = self.run_tool("info", path, "--columns", "torque=/joint_states.x", code=2).stderr.decode()
            self.assertIn(words, said)

    def test_no_topic_of_numbers(self):
        path = self.write("run.mcap", bags.mcap(self.channels()[3:], [(0, 1, b"{}")]))
        self.assertIn("expected a topic of numbers", self.refusal(path))


WRITER = SOURCE / "tests/containers/mcap_core"


@unittest.skipUnless(shutil.which("node") and (WRITER / "node_modules/@mcap/core").is_dir(), "no node with @mcap/core here")
class McapCore(Messages):
    def test_what_the_formats_own_writer_writes(self):
        schema = self.write("JointState.msg", bags.JOINT_STATE.encode())
        subprocess.run(["node", "write.mjs", schema, LOG, self.folder / "run.mcap"], cwd=WRITER, check=True, timeout=60)
        epoch = 1_700_000_000 * 10**9
        lines = ["stamp_ns,elbow position,elbow velocity,elbow effort"]
        lines += [f"{epoch + round(1e9 * t)},{q * math.pi / 180!r},{v * math.pi / 180!r},{tau!r}" for t, v, tau, q in self.rows]
        twin = self.write("twin.csv", ("\n".join(lines) + "\n").encode())
        self.assert_same(self.folder / "run.mcap", "--joint", "elbow", twin=twin)


class Rosbag2(Messages):
    libraries = ("SQLITE",)

    def test_it_is_read_as_mcap_with_definitions_and_without(self):
        twin = self.twin()
        for definitions in (True, False):
            path = self.folder / f"run_{definitions}.db3"
            bags.db3(path, self.channels()[:3], [m for m in self.messages() if m[0] < 3], definitions)
            self.assert_same(path, "--joint", "elbow", twin=twin, twin_options=("--joint", "elbow"))
        self.assertEqual(self.identified("-", "--joint", "elbow", stdin=path.read_bytes()), self.identified(path, "--joint", "elbow"))
        self.assertRegex(self.run_tool("info", path).stdout.decode(), r"/joint_states.effort\[0..1\] +read +4000 messages")

    def test_damage_and_other_databases(self):
        import sqlite3
        path = self.folder / "run.db3"
        bags.db3(path, self.channels()[:1], [m for m in self.messages() if m[0] == 0])
        data = path.read_bytes()
        self.assertIn("SQLite", self.refusal(self.write("cut.db3", data[:len(data) // 2]), "--joint", "elbow", command="identify"))
        # A page of a tree's inside, whose first cell is told to lie beyond it: SQLite by itself does not mind.
        page_size = int.from_bytes(data[16:18], "big")
        inside = next(at for at in range(page_size, len(data), page_size) if data[at] == 5)
        beyond = bytearray(data)
        beyond[inside + 12] |= 0x20
        self.assertIn("malformed", self.refusal(self.write("beyond.db3", bytes(beyond)), "--joint", "elbow", command="identify"))
        other = sqlite3.connect(self.folder / "other.db3")
        other.execute("CREATE TABLE topics(id INTEGER)")
        other.execute("CREATE VIEW messages AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x FROM n")
        other.commit()
        other.close()
        self.assertIn("without the table messages", self.refusal(self.folder / "other.db3"))
