# SPDX-License-Identifier: MIT
"""Lines that turn with the joint are enough: no command needs the gear ratio that names them."""

import json
import unittest

from test_gear_methods import MOVE, Case

PER_TURN = ("--orders", "200/turn,400/turn")
NAMED = ("--gear-ratio", 100, "--orders", "2,4")


class SameLines(Case):
    def filtered(self, method, words):
        self.good("filter", MOVE, "--method", method, *words, "-o", "out.csv", "--force", "-q")
        return (self.folder / "out.csv").read_bytes()

    def test_the_filtered_log_does_not_depend_on_what_names_the_lines(self):
        for name, words in (("turn", PER_TURN), ("named", NAMED)):
            self.good("map", MOVE, *words, "-o", f"{name}.json", "-q")
            self.good("design", *words, "--sample-rate", "1kHz", "--speed", "18:90:18", "-o", f"table_{name}.json", "-q")
        self.assertIsNone(json.loads((self.folder / "turn.json").read_text())["gear_ratio"])
        self.assertIsNone(json.loads((self.folder / "table_turn.json").read_text())["gear_ratio"])
        for method in ("tracking", "oscillator"):
            with self.subTest(method=method):
                self.assertEqual(self.filtered(method, PER_TURN), self.filtered(method, NAMED))
        self.assertEqual(self.filtered("switching,table=table_turn.json", ()),
                         self.filtered("switching,table=table_named.json", ()))

    def test_every_command_states_the_lines_by_the_joint(self):
        for words in (["filter", MOVE, "--method", "tracking", "-o", "x.csv", "--metrics", "out.json"],
                      ["compare", MOVE, "--method", "tracking"],
                      ["design", "--sample-rate", "1kHz", "--speed", "18:90:18"],
                      ["spectrum", MOVE, "--map", "order"]):
            with self.subTest(command=words[0]):
                json_words = [] if words[0] == "filter" else ["--json"]
                done = self.good(*words, *PER_TURN, *json_words)
                text = (self.folder / "out.json").read_text() if words[0] == "filter" else done.stdout
                gear = json.loads(text)["gear"]
                self.assertEqual((gear["ratio"], gear["orders"]), (None, [200, 400]))

    def test_a_ratio_names_lines_that_are_stated_by_the_joint(self):
        self.assertEqual(self.filtered("tracking,orders=200/turn:400/turn", ("--gear-ratio", 100)),
                         self.filtered("tracking", NAMED))

    def test_what_is_no_order_is_refused(self):
        for words, message in ((("--orders", "200/tun"), "'200/tun' is no order"),
                               (("--orders", "1,200/turn"), "1 counts by turns of the motor"),
                               (("--orders", "200/turn,200/turn"), "listed twice"),
                               (("--orders", "-1/turn"), "-1/turn is not above 0")):
            done = self.run_tool("filter", MOVE, "--method", "tracking", *words, "-o", "x.csv")
            self.assertEqual(done.returncode, 2, words)
            self.assertIn(message, done.stderr)


class Exported(Case):
    def test_code_takes_the_angle_of_the_joint(self):
        for method, shaft, whole in (("oscillator,orders=200/turn", "joint_turns", "the fraction of the turn is enough"),
                                     ("oscillator,gear-ratio=100,orders=2", "motor_turns", "the fraction"),
                                     ("oscillator,gear-ratio=120.05,orders=1:726/turn", "joint_turns", "whole turns count")):
            done = self.good("export", "--method", method, "--sample-rate", "1kHz", "--to", "c-header", "-o", "x.h", "--force")
            header = (self.folder / "x.h").read_text()
            self.assertIn(shaft, header)
            self.assertIn(whole, header)
            difference = float(done.stdout.split("largest difference")[1].split()[0])
            self.assertLess(difference, 1e-3, method)

    def test_a_drive_that_counts_by_its_motor_refuses_a_map_without_a_ratio(self):
        self.good("map", MOVE, *PER_TURN, "-o", "map.json", "-q")
        if not json.loads((self.folder / "map.json").read_text())["orders"]:
            self.skipTest("the move is too short for a map")
        done = self.run_tool("export", "map.json", "--to", "moteus,kt=1", "-o", "x.txt")
        self.assertEqual(done.returncode, 2)
        self.assertIn("states no gear ratio", done.stderr)
        self.good("export", "map.json", "--to", "c-header", "-o", "x.h")


if __name__ == "__main__":
    unittest.main()
