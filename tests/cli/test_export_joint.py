# SPDX-License-Identifier: MIT
"""export model.json: what simulators and Python are handed over, run along a log against `simulate`."""

import json
import pathlib
import subprocess
import sys
import unittest

from commands import DATA, SOURCE, Case, ended

PYTHONS = [python for python in (sys.executable, "/usr/bin/python3")
           if pathlib.Path(python).exists() and not subprocess.run([python, "-c", "import numpy"], capture_output=True).returncode]
# Of each file the largest difference from a torque along a motion: {"motion": {...}, "torques": {file: [...]}} on standard input.
ALONG = """
import json, runpy, sys
import numpy as np
told = json.load(sys.stdin)
m = {name: np.array(values) for name, values in told["motion"].items()}
print(json.dumps({name: float(np.max(np.abs(np.array(torque) - runpy.run_path(name)["torque_nm"](m["q"], m["v"], m["a"], m["t"]))))
                  for name, torque in told["torques"].items()}))
"""
# Values added to the catalogue's first guesses, with which the torque of an effect differs from none.
VALUES = {"payload-change": {"time_s": 1.0, "ramp_s": 0.1, "cosine_nm": 0.4, "sine_nm": -0.3}, "tone": {"frequency_hz": 7.0, "phase_deg": 30.0},
          "drift": {"rate_nm_s": -0.2}, "gear-ratio": {"error_percent": 0.5}}
NOT_IN_PYTHON = {"hysteresis", "backlash", "start-stop-ringing", "simulation-scale", "coupled-joint-friction"}


class Joint(Case):
    def setUp(self):
        super().setUp()
        self.good("simulate", "--gear-ratio", 100, "--inertia", 1, "--motion", "poly6,to=120deg,duration=1s", "--motion",
                  "sine,amplitude=40deg,frequency=0.8Hz,duration=2s", "--sample-rate", "500Hz", "-o", "log.csv")

    def model(self, *effects):
        document = {"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": list(effects)}
        (self.folder / "model.json").write_text(json.dumps(document))

    def torque(self, name="torque_nm"):
        self.good("simulate", "log.csv", "--model", "model.json", "-o", "one.csv", "--force")
        head, *rows = [row.split(",") for row in (self.folder / "one.csv").read_text().splitlines()]
        return [float(row[head.index(name)]) for row in rows]

    def motion(self):
        """As simulate takes it from the log: each is the torque of an effect of size 1."""
        self.model({"effect": "inertia", "inertia_kgm2": 1})
        motion = {"a": [57.29577951308232 * one for one in self.torque()], "t": self.torque("time_s"), "q": self.torque("position_deg")}
        self.model({"effect": "viscous-friction", "coefficient_nm_per_deg_s": 1})
        return {**motion, "v": self.torque()}

    @unittest.skipUnless(PYTHONS, "no NumPy")
    def test_numpy_has_the_torque_of_each_effect_of_a_joint(self):
        motion, torques = self.motion(), {}
        effects = json.loads(self.good("diagnose", "--effects", "--json").stdout)["effects"]
        base = [{"effect": "inertia", "inertia_kgm2": 0.5}, {"effect": "gravity", "amplitude_nm": 3, "phase_deg": 20},
                {"effect": "ripple", "order": 2, "amplitude_nm": 0.7, "phase_deg": -50}]
        for effect in effects:
            values = {one["name"]: one["first_guess"] or (0.3 if one["linear"] else 0.0) for one in effect["parameters"]} | VALUES.get(effect["effect"], {})
            self.model(*base, {"effect": effect["effect"], **values})
            name = f"{effect['effect']}.py"
            told = self.good("export", "model.json", "--to", "numpy", "-o", name).stdout
            self.assertIn(f"held: {effect['effect']}: ", told)
            if f"not held: {effect['effect']}: " not in told:
                torques[name] = self.torque()
            elif effect["side"] == "joint":
                self.assertIn(effect["effect"], NOT_IN_PYTHON)
        self.assertGreaterEqual(len(torques), 17)
        done = subprocess.run([PYTHONS[0], "-c", ALONG], input=json.dumps({"motion": motion, "torques": torques}), cwd=self.folder,
                              capture_output=True, text=True)
        for name, difference in json.loads(ended(0, done).stdout).items():
            self.assertLess(difference, 1e-8, name)

    def test_an_actuator_has_friction_delay_limit_and_armature(self):
        motion = self.motion()
        friction = [{"effect": "coulomb-friction", "torque_nm": 0.7, "width_deg_s": 0.5},
                    {"effect": "viscous-friction", "coefficient_nm_per_deg_s": 0.004}]
        self.model(*friction)
        ours = self.torque()
        self.model(*friction, {"effect": "inertia", "inertia_kgm2": 0.45}, {"effect": "saturation", "limit_nm": 9},
                   {"effect": "delay", "delay_s": 0.011}, {"effect": "ripple", "order": 1, "amplitude_nm": 1, "phase_deg": 0})
        told = self.good("export", "model.json", "--to", "actuator,joint=elbow,step=4ms,link-inertia=0.3", "-o", "a.json").stdout
        self.assertIn("not held: ripple: actuators have no place for it", told)
        found = json.loads((self.folder / "a.json").read_text())
        isaac, mjlab = found["isaac_lab"], found["mjlab"]
        self.assertEqual((isaac["min_delay"], isaac["max_delay"], mjlab["delay_max_lag"], isaac["effort_limit"]), (3, 3, 3, 9))
        self.assertEqual((isaac["armature"], isaac["joint_names_expr"]), (0.15, ["elbow"]))
        for sliding, viscous in ((isaac["dynamic_friction"], isaac["viscous_friction"]), (mjlab["frictionloss"], mjlab["viscous_damping"])):
            for speed, torque in zip(motion["v"], ours):
                if abs(speed) > 10:
                    self.assertAlmostEqual(torque, (sliding if speed > 0 else -sliding) + viscous * speed / 57.29577951308232, delta=1e-9)

    def test_what_cannot_be_handed_over_is_refused(self):
        self.model({"effect": "coulomb-friction"})
        ended(3, self.run_tool("export", "model.json", "--to", "numpy"), "does not state effects[0].torque_nm of coulomb-friction")
        self.model({"effect": "inertia", "inertia_kgm2": 0.2})
        ended(2, self.run_tool("export", "model.json", "--to", "actuator,link-inertia=0.3"), "the joint has 0.2 kgm2 in all")
        ended(2, self.run_tool("export", "model.json", "--to", "c-header"), "no joint export target 'c-header'; targets: mjcf, actuator, numpy")
        ended(2, self.run_tool("export", DATA / "paper_model.json", "--to", "numpy,name=2x"), "name")


class Page(unittest.TestCase):
    def test_every_target_has_a_row(self):
        page = (SOURCE / "docs/export/joints.md").read_text()
        for name in ("mjcf", "actuator", "numpy"):
            self.assertIn(f"| `{name}` |", page)
