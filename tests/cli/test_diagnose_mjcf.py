# SPDX-License-Identifier: MIT
"""diagnose --improved-model improved.xml: what is written for MuJoCo, and that MuJoCo itself leaves of the log what was said."""

import json
import math
import os
import pathlib
import random
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

from commands import SOURCE, Case, ended

# A folder with node_modules/@mujoco/mujoco: RIPPLENOTCH_MUJOCO, or that of the repository.
NODE = pathlib.Path(os.environ.get("RIPPLENOTCH_MUJOCO", SOURCE))
MUJOCO = shutil.which("node") and (NODE / "node_modules/@mujoco/mujoco").is_dir()
MOVES = " ".join(f"--motion poly6,to={to}deg,duration={time}s --motion rest,duration=0.5s"
                 for to, time in ((80, 1.5), (-40, 3), (60, 6), (-70, 1.2), (10, 2.5))).split()
EFFECTS = ("inertia,inertia_kgm2=0.45", "gravity,amplitude_nm=3,phase_deg=25", "coulomb-friction,torque_nm=0.7,width_deg_s=0.6",
           "viscous-friction,coefficient_nm_per_deg_s=0.004", "hysteresis,torque_nm=0.8,width_deg=4",
           "output-ripple,order=3,amplitude_nm=0.5,phase_deg=70")
BODY = """<?xml version="1.0"?>
<!-- <mujoco> of an arm -->
<mujoco><compiler angle="radian"/><worldbody><body name="upper">
<joint name="shoulder" axis="0 1 0" damping="7" armature="0.3"/><inertial pos="0.2 0 0.01" mass="3" diaginertia="0.02 0.05 0.05"/>
<body name="lower" pos="0.4 0 0"><joint frictionloss='9'
 name="elbow" axis="0 1 0"/><inertial pos="0.15 0.02 0" mass="2" diaginertia="0.01 0.03 0.03"/></body>
</body></worldbody></mujoco>
"""


class Joint(Case):
    RATE = "500Hz"

    def run_tool(self, *words, code=0):
        done = ended(code, super().run_tool(*words))
        return done

    def logged(self, *effects, name="log.csv"):
        words = [word for effect in effects for word in ("--effect", effect)]
        self.run_tool("simulate", "--gear-ratio", 100, "--ripple", "1:0.6Nm:20deg", "--ripple", "2:0.4Nm:250deg", *words, *MOVES,
                      "--sample-rate", self.RATE, "--noise", "0.05Nm", "--seed", 4, "--decimals", 7, "-o", name)

    def model(self, *effects):
        (self.folder / "model.json").write_text(json.dumps({
            "schema": "ripplenotch/model/1", "gear_ratio": 100,
            "effects": [{"effect": "inertia"}, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}, *effects]}))

    def diagnosed(self, output, *words):
        return json.loads(self.run_tool("diagnose", "log.csv", "--model", "model.json", "--improved-model", output, "--json", "--force", *words).stdout)

    def root(self, name):
        return xml.etree.ElementTree.parse(self.folder / name).getroot()

    def along_log(self, effect, log="log.csv"):
        """The torque of one effect along the log's motion, as simulate has it."""
        self.run_tool("simulate", "--gear-ratio", 100, "--effect", effect, log, "-o", "one.csv", "--force", "--decimals", 12)
        rows = (self.folder / "one.csv").read_text().splitlines()
        place = rows[0].split(",").index("torque_nm")
        return [float(row.split(",")[place]) for row in rows[1:]]

    def motion(self):
        """Time, angle, speed, acceleration in rad, row by row, as the model moves: each is the torque of an effect of size 1."""
        acceleration = self.along_log("inertia,inertia_kgm2=1")
        speed = [math.radians(v) for v in self.along_log("viscous-friction,coefficient_nm_per_deg_s=1")]
        rows = [row.split(",") for row in (self.folder / "log.csv").read_text().splitlines()]
        time, position = rows[0].index("time_s"), rows[0].index("position_deg")
        return [[float(row[time]), math.radians(float(row[position])), v, a] for row, v, a in zip(rows[1:], speed, acceleration)]

    def mujocos_torque(self, name, joint, rows):
        told = json.dumps({"xml": (self.folder / name).read_text(), "joint": joint, "rows": rows})
        done = ended(0, subprocess.run(["node", SOURCE / "tests/cli/along.mjs"], input=told, cwd=NODE, capture_output=True,
                                       text=True))
        return json.loads(done.stdout)

    def gap(self, name, rows, joint="joint"):
        table = [row.split(",") for row in (self.folder / "log.csv").read_text().splitlines()]
        column = table[0].index("torque_nm")
        left = [float(row[column]) - nm for row, nm in zip(table[1:], self.mujocos_torque(name, joint, rows))]
        return math.sqrt(sum(nm * nm for nm in left) / len(left))


class Written(Joint):
    RATE = "250Hz"  # what is written is read here, not driven along the log

    def test_what_has_no_place_is_in_the_story_the_json_and_the_file(self):
        self.logged("inertia,inertia_kgm2=0.45", "offset,torque_nm=0.5", "delay,delay_s=6ms")
        self.model()
        found = self.diagnosed("improved.mjcf")
        self.assertEqual(found["named"].sort(), ["delay", "offset"].sort())
        self.assertEqual(sorted(part["effect"] for part in found["mjcf"]["not_held"]), ["delay", "offset"])
        self.assertGreater(found["mjcf"]["gap_after_nm"], 0.4)
        comment = (self.folder / "improved.mjcf").read_text()
        story = self.run_tool("diagnose", "log.csv", "--model", "model.json", "--improved-model", "improved.mjcf", "--force").stdout
        for part in found["mjcf"]["not_held"]:
            self.assertIn(f"not held: {part['effect']}: {part['reason']}", comment)
            self.assertIn(f"improved.mjcf: not held: {part['effect']}: {part['reason']}", story)


@unittest.skipUnless(MUJOCO, "no node with @mujoco/mujoco; RIPPLENOTCH_MUJOCO names a folder that has it")
class AlongLog(Joint):
    def test_mujoco_leaves_before_and_after_what_was_said_within_1_percent(self):
        self.logged(*EFFECTS)
        self.model()
        after = self.diagnosed("after.xml")
        found = {entry["effect"] for entry in after["rounds"]}
        before = self.diagnosed("before.xml", *(word for name in found for word in ("--without", name)))
        self.assertEqual(before["named"], [])
        rows = self.motion()
        self.assertLess(after["gap"]["after_nm"], 0.06)
        for name, said in (("after.xml", after["gap"]["after_nm"]), ("before.xml", after["gap"]["before_nm"]),
                           ("after.xml", after["mjcf"]["gap_after_nm"]), ("before.xml", after["mjcf"]["gap_before_nm"])):
            self.assertAlmostEqual(self.gap(name, rows) / said, 1.0, delta=0.01, msg=name)

    def test_an_exported_model_has_the_torque_of_simulate_within_1_percent(self):
        self.logged(*EFFECTS)
        effects = [{"effect": name, **{key: float(value) for key, value in (pair.split("=") for pair in pairs)}}
                   for name, *pairs in (effect.split(",") for effect in EFFECTS)]
        for effect in effects:
            if effect["effect"] == "hysteresis":
                effect["initial_state"] = 0
        (self.folder / "model.json").write_text(json.dumps({"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": effects}))
        self.run_tool("export", "model.json", "--to", "mjcf", "-o", "exported.xml")
        self.run_tool("simulate", "log.csv", "--model", "model.json", "-o", "one.csv", "--force")
        table = [row.split(",") for row in (self.folder / "one.csv").read_text().splitlines()]
        ours = [float(row[table[0].index("torque_nm")]) for row in table[1:]]
        theirs = self.mujocos_torque("exported.xml", "joint", self.motion())
        size = math.sqrt(sum(nm * nm for nm in ours))
        self.assertLess(math.sqrt(sum((one - other) ** 2 for one, other in zip(ours, theirs))), 0.01 * size)

    def test_so_it_does_for_what_it_holds_of_a_model_that_it_cannot_hold_whole(self):
        self.logged(*EFFECTS, "offset,torque_nm=0.5", "quadratic-viscous-friction,coefficient_nm_per_deg2_s2=1e-4")
        self.model({"effect": "offset"}, {"effect": "gear-ratio", "error_percent": 0}, {"effect": "quadratic-viscous-friction"})
        after = self.diagnosed("after.xml")
        self.assertEqual([part["effect"] for part in after["mjcf"]["not_held"]], ["offset"])
        self.assertGreater(after["mjcf"]["gap_after_nm"], 0.4)
        self.assertAlmostEqual(self.gap("after.xml", self.motion()) / after["mjcf"]["gap_after_nm"], 1.0, delta=0.01)
        damping = self.root("after.xml").find(".//joint").get("damping").split()
        self.assertEqual(len(damping), 2)

    def test_a_bristle_begins_at_rest_and_that_is_told_and_counted(self):
        self.logged("inertia,inertia_kgm2=0.45", "hysteresis,torque_nm=2,width_deg=10,initial_state=-0.8")
        self.model({"effect": "hysteresis", "initial_state": -0.8})
        found = self.diagnosed("after.xml", "--without", "hysteresis")
        self.assertIn("set act of friction_1 to -0.13", found["mjcf"]["not_held"][0]["reason"])
        self.assertGreater(found["mjcf"]["gap_after_nm"], found["gap"]["after_nm"])
        self.assertAlmostEqual(self.gap("after.xml", self.motion()) / found["mjcf"]["gap_after_nm"], 1.0, delta=0.01)


@unittest.skipUnless(MUJOCO, "no node with @mujoco/mujoco; RIPPLENOTCH_MUJOCO names a folder that has it")
class Arm(Joint):
    def torque(self, tree, joint, rows):
        (self.folder / "truth.xml").write_text(tree)
        return self.mujocos_torque("truth.xml", joint, rows)

    def test_the_joint_of_a_tree_gets_what_was_found_and_all_else_stays(self):
        truth = BODY.replace('damping="7" ', "").replace("frictionloss='9'", 'frictionloss="0.6" damping="0.3" solreffriction="0.004 1"')
        rows, noise = [], random.Random(5)
        for k in range(10000):
            row = [k / 250]
            for phase, slower in ((0.3, 1.0), (1.9, 0.83)):
                t = slower * k / 250
                q = 0.9 * math.sin(1.1 * t + phase) + 0.5 * math.sin(2.3 * t)
                v = 0.99 * math.cos(1.1 * t + phase) + 1.15 * math.cos(2.3 * t)
                a = -1.089 * math.sin(1.1 * t + phase) - 2.645 * math.sin(2.3 * t)
                row += [q, slower * v, slower**2 * a]
            rows.append([row[0], row[1], row[4], row[2], row[5], row[3], row[6]])
        torques = [self.torque(truth, name, rows) for name in ("shoulder", "elbow")]
        torques = [[nm + noise.gauss(0.0, 0.05) for nm in column] for column in torques]
        with open(self.folder / "log.csv", "w") as log:
            log.write("time_s," + ",".join(f"{name}_{kind}" for name in ("shoulder", "elbow")
                                           for kind in ("position_deg", "velocity_deg_s", "torque_nm")) + "\n")
            for row, one, two in zip(rows, *torques):
                q1, q2, v1, v2 = map(math.degrees, row[1:5])
                log.write(f"{row[0]:.4f},{q1:.6f},{v1:.6f},{one:.6f},{q2:.6f},{v2:.6f},{two:.6f}\n")
        (self.folder / "arm.xml").write_text(BODY)
        found = json.loads(self.run_tool("diagnose", "log.csv", "--joint", "elbow", "--arm", "mjcf,file=arm.xml", "--gear-ratio", 100,
                                         "--improved-model", "improved.xml", "--json").stdout)
        self.assertEqual(sorted(found["named"]), ["coulomb-friction", "viscous-friction"])
        self.assertEqual([part["effect"] for part in found["mjcf"]["not_held"]], ["arm"])
        text = (self.folder / "improved.xml").read_text()
        joints = {joint.get("name"): joint for joint in xml.etree.ElementTree.fromstring(text.partition("?>")[2]).iter("joint")}
        self.assertEqual(joints["elbow"].get("solreffriction"), "0.004 1")
        self.assertEqual(joints["shoulder"].attrib, {"name": "shoulder", "axis": "0 1 0", "damping": "7", "armature": "0.3"})
        self.assertAlmostEqual(float(joints["elbow"].get("frictionloss")), 0.6, delta=0.02)
        self.assertAlmostEqual(float(joints["elbow"].get("damping")), 0.3, delta=0.02)
        left = [nm - mine for nm, mine in zip(torques[1], self.mujocos_torque("improved.xml", "elbow", rows))]
        rms = math.sqrt(sum(nm * nm for nm in left) / len(left))
        self.assertAlmostEqual(rms / found["gap"]["after_nm"], 1.0, delta=0.1)

    def test_a_joint_without_a_name_is_refused_with_what_to_do(self):
        (self.folder / "arm.xml").write_text(BODY.replace(' name="elbow"', "").replace('<body name="lower"', '<body name="elbow"'))
        with open(self.folder / "log.csv", "w") as log:
            log.write("time_s," + ",".join(f"{name}_{kind}" for name in ("shoulder", "elbow")
                                           for kind in ("position_deg", "velocity_deg_s", "torque_nm")) + "\n")
            noise = random.Random(3)
            for k in range(3000):
                t = k / 250
                log.write(f"{t},{40 * math.sin(t)},{40 * math.cos(t)},{math.sin(t) + noise.gauss(0, 0.05)},"
                          f"{30 * math.sin(1.3 * t)},{39 * math.cos(1.3 * t)},{math.cos(2 * t) + noise.gauss(0, 0.05)}\n")
        done = self.run_tool("diagnose", "log.csv", "--joint", "elbow", "--arm", "mjcf,file=arm.xml", "--gear-ratio", 100, "--improved-model", "b.xml",
                             code=2)
        self.assertIn('no joint with name="elbow"', done.stderr)
