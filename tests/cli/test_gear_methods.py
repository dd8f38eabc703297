# SPDX-License-Identifier: MIT
"""Methods that follow the gear: where they get it from, on the command line."""

import json

import commands
from commands import DATA

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
