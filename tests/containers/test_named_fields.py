# SPDX-License-Identifier: MIT
"""Recorded messages that name or number their fields: JSON and Protobuf in MCAP, written by tests/support/bags.py from the published
layouts, and by Protobuf's own library where it is."""

import json
import struct

from container_case import needs
from test_messages import EPOCH, NAMES, Messages
import bags

TIMESTAMP = {"Timestamp": [("seconds", 1, "int64"), ("nanos", 2, "int32")]}


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


class Protobuf(Messages):
    TYPES = {"States": [("timestamp", 1, "tests.Timestamp"), ("name", 2, "string", "repeated"), ("position", 3, "double", "repeated"),
                        ("velocity", 4, "double", "repeated"), ("effort", 5, "double", "repeated")], **TIMESTAMP}

    def channel(self, types=None, kind="tests.States", syntax="proto3"):
        return [("/joint_states", kind, bags.protobuf_schema("tests", types or self.TYPES, syntax), "protobuf", "protobuf")]

    def stamp(self, ns):
        sec, nanos = parts(ns)
        return bags.Protobuf().whole(1, sec).whole(2, nanos)

    def state(self, ns, position, velocity, effort, packed=True):
        one = bags.Protobuf().counted(1, self.stamp(ns))
        for name in NAMES:
            one.counted(2, name)
        for number, values in ((3, position), (4, velocity), (5, effort)):
            if packed:
                one.counted(number, b"".join(struct.pack("<d", value) for value in values))
            else:
                for value in values:
                    one.fixed(number, "d", value)
        return one.body

    def recorded(self, messages, channel=None):
        return self.write("run.mcap", bags.mcap(channel or self.channel(), [(0, ns + 300_000, data) for ns, data in messages]))

    def test_it_gives_what_the_text_gives(self):
        twin = self.twin()
        for packed in (True, False):
            path = self.recorded([(ns, self.state(ns, *motion, packed=packed)) for ns, *motion in self.states])
            self.assert_same(path, "--joint", "elbow", twin=twin, twin_options=("--joint", "elbow"))

    def numbers(self, kind, put, values):
        """What comes out of a field of this type that holds these values, one a message."""
        types = {"One": [("velocity_deg_s", 1, "double"), ("x", 2, kind)], **TIMESTAMP}
        messages = [(EPOCH + 10**6 * k, put(bags.Protobuf().fixed(1, "d", 1.0 + k), value).body) for k, value in enumerate(values)]
        path = self.recorded(messages, self.channel(types, "tests.One"))
        columns = ("--columns", "torque=/joint_states.x,velocity=/joint_states.velocity_deg_s", "--unit", "torque=Nm")
        text = self.run_tool("filter", path, *columns, "--method", "none", "-q", "--output-format", "csv").stdout.decode()
        return [float(line.split(",")[2]) for line in text.splitlines()[1:]]

    def test_numbers_of_every_type(self):
        def whole(one, value):
            return one.whole(2, value)

        def zigzag(one, value):
            return one.whole(2, 2 * value if value >= 0 else -2 * value - 1)
        for kind, put, values in (
                ("double", lambda one, v: one.fixed(2, "d", v), [0.0, -1.25, 1e-300]),
                ("float", lambda one, v: one.fixed(2, "f", v), [0.0, -1.25, 3.5]),
                ("int32", whole, [1, -7, 2**31 - 1]), ("int64", whole, [1, -7, 2**52]), ("uint32", whole, [0, 7, 2**32 - 1]),
                ("uint64", whole, [0, 7, 2**52]), ("bool", whole, [0, 1, 1]), ("enum", whole, [0, 5, -1]),
                ("sint32", zigzag, [0, -7, 2**31 - 1]), ("sint64", zigzag, [-(2**40), 7, 0]),
                ("fixed32", lambda one, v: one.fixed(2, "I", v), [0, 7, 2**32 - 1]),
                ("sfixed32", lambda one, v: one.fixed(2, "i", v), [0, -7, 2**31 - 1]),
                ("fixed64", lambda one, v: one.fixed(2, "Q", v), [0, 7, 2**52]), ("sfixed64", lambda one, v: one.fixed(2, "q", v), [0, -7, 9])):
            with self.subTest(kind):
                self.assertEqual(self.numbers(kind, put, values), [float(value) for value in values])

    def test_what_proto3_leaves_out_is_zero(self):
        def put(one, value):
            return one.fixed(2, "d", value) if value else one
        self.assertEqual(self.numbers("double", put, [0.0, 2.0, 0.0, 3.0]), [0.0, 2.0, 0.0, 3.0])

    def test_what_is_optional_and_not_there_is_no_zero(self):
        for syntax, marks in (("proto3", ("optional",)), ("proto2", ())):
            types = {"One": [("velocity_deg_s", 1, "double", *marks), ("torque_nm", 2, "double", *marks)]}
            messages = []
            for k in range(10):
                one = bags.Protobuf().fixed(1, "d", 1.0)
                messages.append((EPOCH + 10**6 * k, (one if k == 7 else one.fixed(2, "d", 1.0)).body))
            said = self.refusal(self.recorded(messages, self.channel(types, "tests.One", syntax)))
            self.assertIn("message 8, /joint_states: read no number as torque_nm", said)

    def test_messages_that_are_broken_are_refused_with_their_number(self):
        good = [(ns, self.state(ns, *motion)) for ns, *motion in self.states]
        ns, *motion = self.states[3000]
        for data, words in ((good[3000][1][:-3], "ends, expected 3 bytes more"),
                            (self.state(ns, motion[0], motion[1], [1.0]), "no number as effort[1]"),
                            (self.state(ns, motion[0], motion[1], [1.0] * 3), "3 elements of effort and more"),
                            (bags.Protobuf().whole(5, 1).body, "bytes of another type"), (b"\x0b", "a group"), (b"\x00", "without a number"),
                            (b"\x28" + b"\xff" * 11, "more than ten bytes")):
            messages = [*good]
            messages[3000] = (ns, data)
            said = self.refusal(self.recorded(messages), "--joint", "elbow", command="identify")
            self.assertIn("message 3001, /joint_states: read", said)
            self.assertIn(words, said)

    def test_types_that_cannot_be_read(self):
        for schema, kind, words in ((b"", "tests.States", "not defined in the recording"), (b"\x0a\x7f", "tests.States", "not read"),
                                    (self.channel()[0][2], "tests.Other", "type tests.Other is not defined")):
            path = self.recorded([(EPOCH, b"")], [("/joint_states", kind, schema, "protobuf", "protobuf")])
            self.assertIn(words, self.run_tool("info", path, "--columns", "torque=/joint_states.x", code=2).stderr.decode())
        # A type that holds itself has no end in its definition, but its messages have.
        endless = {"Node": [("x", 1, "double"), ("next", 2, "tests.Node")]}
        one = bags.Protobuf()
        for _ in range(40):
            one = bags.Protobuf().counted(2, one)
        path = self.recorded([(EPOCH, one.body)], self.channel(endless, "tests.Node"))
        self.assertIn("deeper than 32", self.run_tool("info", path, "--columns", "torque=/joint_states.x", code=2).stderr.decode())

    @needs("google.protobuf")
    def test_what_protobufs_own_library_writes(self):
        from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
        # Its name in newer versions is another.
        class_of = getattr(message_factory, "GetMessageClass", None) or message_factory.MessageFactory().GetPrototype
        declared = descriptor_pb2.FileDescriptorSet.FromString(self.channel()[0][2])
        pool = descriptor_pool.DescriptorPool()
        for file in declared.file:
            pool.Add(file)
        States = class_of(pool.FindMessageTypeByName("tests.States"))
        messages = []
        for ns, position, velocity, effort in self.states:
            one = States(name=NAMES, position=position, velocity=velocity, effort=effort)
            one.timestamp.seconds, one.timestamp.nanos = parts(ns)
            messages.append((ns, one.SerializeToString()))
        channel = [("/joint_states", "tests.States", declared.SerializeToString(), "protobuf", "protobuf")]
        self.assert_same(self.recorded(messages, channel), "--joint", "elbow", twin=self.twin(), twin_options=("--joint", "elbow"))
