# SPDX-License-Identifier: MIT
"""Recorded messages that name their fields: JSON in MCAP, written by tests/support/bags.py from the published layout."""

import json

from test_messages import NAMES, Messages
import bags


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
