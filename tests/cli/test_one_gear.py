# SPDX-License-Identifier: MIT
"""Methods that follow the gear: where they get it from, on the command line."""

import csv
import json

import commands
from commands import DATA, TAKES_A_GEAR, asked

MOVE = DATA / "paper_move_2s.csv"


def joint(ratio=100.0, orders=(1.0, 2.0), amplitudes=(0.8, 0.5), phases=(0.0, 0.0)):
    """A joint.json with lines that follow the motor, and a tone, as identify writes it."""
    lines = [
        {"kind": "order", "order": n, "order_output": n * 100.0, "order_output_stderr": None, "hz": None,
         "amplitude_nm": a, "phase_deg": p, "snr": 20.0, "speed_range_deg_s": [-171, -10], "amplitude_by_speed": []}
        for n, a, p in zip(orders, amplitudes, phases)
    ]
    lines.append({"kind": "tone", "order": None, "order_output": None, "order_output_stderr": None, "hz": 50.0,
                  "amplitude_nm": 0.1, "phase_deg": None, "snr": 9.0, "speed_range_deg_s": [0, 1],
                  "amplitude_by_speed": []})
    return json.dumps({
        "schema": "ripplenotch/joint/1", "tool": "ripplenotch", "version": "0", "command": "", "inputs": [],
        "verdict": "", "conclusive": True, "joint": "", "sample_rate_hz": 1000.0, "evidence": "order spectrum",
        "gear_ratio": {"value": ratio, "stderr": 0.01, "ci95": [99.9, 100.1], "candidates": []},
        "lines": lines, "notes": []})


class Case(commands.Case):
    def setUp(self):
        super().setUp()
        (self.folder / "joint.json").write_text(joint())


# One gear for every command: the same sources give the same ratio and orders, and the same refusals in the same words.
PAPER_60, PAPER_90 = DATA / "paper_60deg_s.csv", DATA / "paper_90deg_s.csv"
MODEL = DATA / "paper_model.json"


class Commands(Case):
    """How each command is asked, and where its JSON says the gear."""

    def filtered_by(self, method, words):
        done = self.run_tool("filter", MOVE, "--method", method, *words, "-o", "out.csv", "--metrics", "out.json", "--force")
        return done, lambda: json.loads((self.folder / "out.json").read_text())["gear"]

    def compared_by(self, method, words):
        done = self.run_tool("compare", MOVE, "--method", method, *words, "--json")
        return done, lambda: json.loads(done.stdout)["gear"]

    def json_said(self, name, words):
        done = self.run_tool(*asked(name, MOVE, words), "--json")
        return done, lambda: json.loads(done.stdout)["gear"]

    def every(self, words):
        """Each command with these words: its name, the run, and what it says the gear is."""
        for method in ("none", "lowpass,cutoff=13rad/s", "tracking", "oscillator"):
            yield f"filter {method}", *self.filtered_by(method, words)
            yield f"compare {method}", *self.compared_by(method, words)
        for name in TAKES_A_GEAR:
            if name not in ("filter", "compare", "map", "recommend", "features"):
                yield name, *self.json_said(name, words)


class SameSources(Commands):
    def setUp(self):
        super().setUp()
        self.good("identify", PAPER_90, "--gear-ratio", 100, "-o", "one_speed.json")
        found = json.loads((self.folder / "one_speed.json").read_text())
        self.one_speed = found["gear_ratio"]["value"], sorted(line["order"] for line in found["lines"] if line["order"])
        self.assertEqual({line["kind"] for line in found["lines"]}, {"unknown"})

    def test_every_command_takes_the_same_ratio_and_orders(self):
        cases = [
            (["--gear-ratio", 100], (100, [1, 2])),
            (["--gear-ratio", 100, "--orders", "2"], (100, [2])),
            (["--gear-ratio", 100, "--orders", "2,1"], (100, [1, 2])),
            (["--joint-file", "joint.json"], (100, [1, 2])),
            (["--joint-file", "joint.json", "--orders", "1"], (100, [1])),
            (["--joint-file", "joint.json", "--gear-ratio", 50], (50, [2, 4])),
            (["--joint-file", "one_speed.json"], self.one_speed),
        ]
        for words, (ratio, orders) in cases:
            sources = set()
            for name, done, gear in self.every(words):
                with self.subTest(command=name, words=words):
                    self.assertEqual(done.returncode, 0, done.stderr)
                    said = gear()
                    self.assertEqual((said["ratio"], said["orders"]), (ratio, orders))
                    sources.add(said["source"])
            self.assertEqual(len(sources), 1, f"{words}: {sources}")

    def test_verbose_says_the_gear_everywhere(self):
        for name, done, _ in self.every(["--gear-ratio", 100, "-v"]):
            self.assertIn("gear ratio 100, orders 1, 2 (--gear-ratio, orders by default)", done.stderr, name)

    def test_every_command_has_all_three_options_and_tells_the_default(self):
        for command in ("filter", "compare", "spectrum", "design"):
            text = " ".join(self.good(command, "--help-all").stdout.split())
            for piece in ("--gear-ratio NUMBER", "--orders NUMBER,...", "--joint-file FILE", "(default:"):
                self.assertIn(piece, text, command)


class SameRefusals(Commands):
    def test_every_command_refuses_in_the_same_words(self):
        (self.folder / "nothing.json").write_text(joint(ratio=None, orders=()))
        (self.folder / "no_lines.json").write_text(joint(orders=()))
        cases = [
            (["--gear-ratio", 0], 2, "--gear-ratio 0 is not above 0 and at most 100000"),
            (["--gear-ratio", -3], 2, "--gear-ratio -3 is not above 0 and at most 100000"),
            (["--gear-ratio", 100, "--orders", "0"], 2, "--orders: 0 is not above 0"),
            (["--gear-ratio", 100, "--orders", "1,1"], 2, "--orders: 1 is listed twice"),
            (["--joint-file", "nothing.json"], 3,
             "nothing.json: its gear ratio is null, because identify found none; give --gear-ratio, "
             "or lines per turn of the joint, for example --orders 200/turn"),
            (["--joint-file", "no_lines.json"], 3,
             "no_lines.json: it has no line that follows the motor; give --orders"),
            (["--joint-file", ""], 2, "--joint-file: the name is empty"),
        ]
        for words, code, message in cases:
            for name, done, _ in self.every(words):
                with self.subTest(command=name, words=words):
                    self.assertEqual(done.returncode, code, done.stderr)
                    self.assertEqual(done.stderr, f"ripplenotch {name.split()[0]}: {message}\n")

    def test_orders_without_a_ratio_ask_for_one_in_the_same_words(self):
        for name, done, _ in self.every(["--orders", "1,2"]):
            with self.subTest(command=name):
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertRegex(done.stderr, r"^ripplenotch \w+: --orders: 1 counts by turns of the motor, which takes a "
                                              r"gear ratio; give --gear-ratio, for example 100, or count by turns of the "
                                              r"joint: 100/turn\n$")


class InEveryDocument(Commands):
    """Each command that knows a gear says it in its JSON as `gear`: ratio, orders, source."""

    def said(self, *words):
        return json.loads(self.good(*words).stdout)["gear"]

    def test_the_block_has_the_same_keys_everywhere(self):
        self.good("simulate", MOVE, "--model", MODEL, "-o", "copy.csv", "--json")
        gears = {name: gear() for name, _, gear in self.every(["--gear-ratio", 100])}
        gears["identify"] = self.said("identify", PAPER_90, PAPER_60, "--json")
        gears["simulate"] = self.said("simulate", MOVE, "--model", MODEL, "-o", "copy.csv", "--force", "--json")
        gears["diagnose"] = self.said("diagnose", MOVE, "--model", MODEL, "--json")
        for name, gear in gears.items():
            with self.subTest(command=name):
                self.assertEqual(list(gear), ["ratio", "orders", "source"])
                self.assertAlmostEqual(gear["ratio"], 100, delta=0.001)
                self.assertEqual(gear["orders"], [1, 2])


class BeforeTheGear(Commands):
    """A log of the motor's motion is read by the ratio, whoever states it."""

    def setUp(self):
        super().setUp()
        rows = list(csv.DictReader(PAPER_90.read_text().splitlines()))
        # No ratio of 500 is told by a position that turns so much more; a motor's velocity alone tells none.
        for name, ratio, head, column in (("speed", 100, "time_s,motor_velocity_rpm,torque_nm", "velocity_deg_s"),
                                          ("turns", 500, "time_s,velocity_deg_s,torque_nm,position_deg", "position_deg")):
            with (self.folder / f"{name}.csv").open("w") as log:
                log.write(head + "\n")
                for row in rows:
                    cells = [row["time_s"], row["velocity_deg_s"], row["torque_nm"], row["position_deg"]]
                    cells[1 if name == "speed" else 3] = f"{float(row[column]) * ratio / (6 if name == 'speed' else 1):.9g}"
                    log.write(",".join(cells[:head.count(",") + 1]) + "\n")
        for ratio in (100, 500):
            (self.folder / f"joint_{ratio}.json").write_text(joint().replace('"value": 100.0', f'"value": {ratio}.0'))
            (self.folder / f"model_{ratio}.json").write_text(MODEL.read_text().replace(": 100,", f": {ratio},"))
            self.good("design", "--gear-ratio", ratio, "--sample-rate", "1kHz", "--speed", "18:90:18", "-o", f"table_{ratio}.json")

    def json_said(self, log, ratio):
        """Each command with each source of the ratio."""
        out = ["-o", "out.csv", "--json", "--force"]
        for source in (["--gear-ratio", ratio], ["--joint-file", f"joint_{ratio}.json"]):
            yield ["spectrum", log, "--track", *source, "--json"]
            yield ["spectrum", log, "--map", "campbell", *source, "--json"]
            yield ["compare", log, "--method", "lowpass,cutoff=5Hz", *source, "--json"]
            yield ["filter", log, "--method", "lowpass,cutoff=5Hz", *source, *out]
        for method in (f"switching,table=table_{ratio}.json", f"tracking,gear-ratio={ratio},orders=1"):
            yield ["filter", log, "--method", method, *out]
            yield ["compare", log, "--method", method, "--json"]
        yield ["filter", log, "--method", f"tracking,joint=joint_{ratio}.json", *out]
        yield ["simulate", log, "--gear-ratio", ratio, *out]
        yield ["simulate", log, "--model", f"model_{ratio}.json", *out]
        # What is asked is how the log is read; the search for names has its own tests.
        effects = [one["effect"] for one in json.loads(self.good("diagnose", "--effects", "--json").stdout)["effects"]]
        untried = [word for effect in effects for word in ("--without", effect)]
        yield ["diagnose", log, "--model", f"model_{ratio}.json", "--json", *untried]

    def recordings(self, name, ratio):
        for words in self.json_said(f"{name}.csv", ratio):
            with self.subTest(words=words):
                yield json.loads(self.good(*words, "-q").stdout)["recording"]

    def test_a_motors_velocity_is_divided_by_the_ratio_of_any_source(self):
        for recording in self.recordings("speed", 100):
            self.assertEqual([one["reason"] for one in recording["inferences"]], ["named as the motor's; divided by the ratio 100"])

    def test_a_motors_position_is_known_by_the_ratio_of_any_source(self):
        for recording in self.recordings("turns", 500):
            self.assertEqual([recording["angle"]["source"], recording["assumptions"]], ["position", []])
            self.assertIn("motor side", " ".join(one["assumed"] for one in recording["inferences"]))
