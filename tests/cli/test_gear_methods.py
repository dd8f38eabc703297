# SPDX-License-Identifier: MIT
"""Methods that follow the gear: where they get it from, on the command line."""

import json

import commands
from commands import DATA, ended

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

    def filtered(self, *words):
        self.good("filter", MOVE, *words, "-o", "out.csv", "--metrics", "out.json", "--force")
        return (self.folder / "out.csv").read_bytes(), json.loads((self.folder / "out.json").read_text())


class WhereTheGearComesFrom(Case):
    def test_keys_options_and_joint_file_give_the_same_bytes(self):
        by_keys, metrics = self.filtered("--method", "tracking,gear-ratio=100,orders=1:2")
        self.assertEqual([100.0, [1, 2]], [metrics["gear_ratio"], [o["order"] for o in metrics["orders"]]])
        for words in (["--method", "tracking", "--gear-ratio", 100, "--orders", "1,2"],
                      ["--method", "tracking,joint=joint.json"], ["--method", "tracking", "--joint-file", "joint.json"],
                      ["--method", "tracking,joint=joint.json,gear-ratio=100"]):
            self.assertEqual(self.filtered(*words)[0], by_keys, words)

    def test_metrics_spell_out_what_the_joint_file_said_and_record_it(self):
        _, metrics = self.filtered("--method", "tracking,q=3,joint=joint.json")
        self.assertEqual(metrics["method"], "tracking,q=3,gear-ratio=100,orders=1:2")
        self.assertEqual(metrics["inputs"][1]["name"], "joint.json")
        again, _ = self.filtered("--method", metrics["method"])
        self.assertEqual(again, self.filtered("--method", "tracking,q=3,joint=joint.json")[0])

    def test_keys_that_are_given_win_over_the_joint_file(self):
        _, metrics = self.filtered("--method", "tracking,orders=2,joint=joint.json")
        self.assertEqual(metrics["method"], "tracking,orders=2,gear-ratio=100")

    def test_without_a_gear_it_says_what_to_give(self):
        ended(2, self.run_tool("filter", MOVE, "--method", "tracking"),
              "method tracking needs to know where the ripple is: give --gear-ratio, for example 100")

    def test_a_joint_file_without_a_ratio_gives_its_lines_by_turns_of_the_joint(self):
        (self.folder / "lines.json").write_text(joint(ratio=None))
        _, metrics = self.filtered("--method", "tracking,joint=lines.json")
        self.assertEqual(metrics["method"], "tracking,orders=100/turn:200/turn")
        self.assertIsNone(metrics["gear_ratio"])

    def test_a_joint_file_that_found_nothing_is_refused_with_the_way_out(self):
        (self.folder / "nothing.json").write_text(joint(ratio=None, orders=()))
        ended(3, self.run_tool("filter", MOVE, "--method", "tracking,joint=nothing.json"), "give --gear-ratio")
        (self.folder / "no_lines.json").write_text(joint(orders=()))
        ended(3, self.run_tool("filter", MOVE, "--method", "tracking,joint=no_lines.json"), "give --orders")
        self.assertFalse((self.folder / "out.csv").exists())

    def test_compare_knows_the_lines_from_the_method_alone(self):
        done = self.good("compare", MOVE, "--method", "tracking,gear-ratio=100,orders=1:2", "--json")
        figures = json.loads(done.stdout)["methods"][1]
        self.assertEqual([1, 2], [line["order"] for line in figures["attenuation_db"]])


class Warm(Case):
    def test_a_joint_file_starts_the_oscillator_warm(self):
        _, metrics = self.filtered("--method", "oscillator,joint=joint.json")
        self.assertEqual(metrics["method"],
                         "oscillator,gear-ratio=100,orders=1:2,amplitudes=0.8:0.5,phases=0:0")
        # The log begins at rest with 1.3 Nm of ripple: known and taken out from the first row on.
        first = float((self.folder / "out.csv").read_text().splitlines()[1].split(",")[2])
        self.assertLess(abs(first), 0.3)
        self.filtered("--method", "oscillator,gear-ratio=100,orders=1:2")
        first = float((self.folder / "out.csv").read_text().splitlines()[1].split(",")[2])
        self.assertGreater(abs(first), 1.0)

    def test_phases_that_identify_does_not_know_are_left_out(self):
        (self.folder / "joint.json").write_text(joint(phases=(None, 0.0)))
        _, metrics = self.filtered("--method", "oscillator,joint=joint.json")
        self.assertEqual(metrics["method"], "oscillator,gear-ratio=100,orders=1:2,amplitudes=0.8:0.5")

    def test_other_orders_than_the_files_get_no_amplitudes_from_it(self):
        _, metrics = self.filtered("--method", "oscillator,orders=2,joint=joint.json")
        self.assertEqual(metrics["method"], "oscillator,orders=2,gear-ratio=100")


class Delay(Case):
    def test_the_delay_of_a_tracking_notch_is_listed_by_speed_and_falls_with_it(self):
        _, metrics = self.filtered("--method", "tracking,gear-ratio=100,orders=1:2,q=2.5")
        speeds = [entry["speed_from_deg_s"] for entry in metrics["delays"]]
        delays = [entry["dc_delay_ms"] for entry in metrics["delays"]]
        self.assertEqual(speeds, [5, 10, 20, 50, 100, 200])
        self.assertEqual(delays[2:], sorted(delays[2:], reverse=True))
        self.assertAlmostEqual(delays[4], 1.5 / (2 * 3.14159265 * 27.7778 * 2.5) * 1e3, delta=0.05)

    def test_without_q_no_notch_of_tracking_delays_by_more_than_four_and_a_half_milliseconds(self):
        _, metrics = self.filtered("--method", "tracking,gear-ratio=100,orders=1:2")
        delays = [entry["dc_delay_ms"] for entry in metrics["delays"]]
        self.assertLess(max(delays), 2 * 4.5 + 0.05)
        self.assertAlmostEqual(delays[2], 9.0, delta=0.05)
