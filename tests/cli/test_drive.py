# SPDX-License-Identifier: MIT
"""--drive: the torque of a control law in logs that have a command and no torque."""

import json
import math
import random
import unittest

from commands import LOGS, Case, ended

DEG = 180.0 / math.pi
KP, KD, INERTIA, COULOMB, VISCOUS, WEIGHT = 220.0, 9.0, 0.8, 3.0, 4.0, 9.0
LAW = f"pd,kp={KP},kd={KD},command=target_rad"
SAGE, BAM = LOGS.parent / "benchmarks/sage-so101", LOGS.parent / "benchmarks/bam-erob"


def target(t):
    return 0.8 * math.sin(1.3 * t) + 0.35 * math.sin(3.1 * t + 1.0) - 0.2 * math.sin(5.3 * t)


def write_log(path, delay_s, limit_nm=1e9, seconds=24.0, rate=250.0, fine=40, coulomb=COULOMB, viscous=VISCOUS):
    """A joint that follows its command by itself: semi-implicit steps, forty to a row. Gives its positions."""
    noise, q, v, step = random.Random(1), target(0.0), 0.0, 1.0 / (rate * fine)
    positions = []
    with open(path, "w") as log:
        log.write("time_s,target_rad,position_rad\n")
        for k in range(int(seconds * rate)):
            t = k / rate
            positions.append(q)
            log.write(f"{t:.4f},{target(t):.6f},{q + noise.gauss(0.0, 2e-5):.6f}\n")
            for i in range(fine):
                drive = max(-limit_nm, min(limit_nm, KP * (target(max(t + i * step - delay_s, 0.0)) - q) - KD * v))
                v += step / INERTIA * (drive - coulomb * math.tanh(v * DEG / 0.3) - viscous * v - WEIGHT * math.cos(q))
                q += step * v
    return positions


def sizes_of(found):
    return {one["effect"]: next(iter(one["parameters"].values()))["value"] for one in found["rounds"]}


class Drive(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "m.json").write_text('{"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": '
                                            '[{"effect": "inertia"}, {"effect": "gravity"}]}')

    def diagnosed(self, log, law, *words):
        return json.loads(ended(0, self.run_tool("diagnose", str(log), "--drive", law, "--json", "-q", *words)).stdout)

    def test_friction_and_the_delay_of_the_command_come_from_command_and_position(self):
        for delay_s, limit_nm in ((0.0063, 1e9), (0.0, 1e9), (0.0171, 14.0)):
            with self.subTest(delay_s=delay_s, limit_nm=limit_nm):
                write_log(self.folder / "log.csv", delay_s, limit_nm)
                law = LAW + ",delay=fit" + (f",limit={limit_nm}Nm" if limit_nm < 1e9 else "")
                found = self.diagnosed("log.csv", law, "--model", "m.json")
                # A quarter of a sample of 4 ms.
                self.assertAlmostEqual(found["drive"]["delay_s"], delay_s, delta=0.001)
                low, high = found["drive"]["ci95_s"]
                self.assertLess(high - low, 0.001)
                self.assertEqual(found["drive"]["limited"] > 0, limit_nm < 1e9)
                self.assertEqual(set(found["named"]), {"coulomb-friction", "viscous-friction"}, found["named"])
                sizes = sizes_of(found)
                self.assertAlmostEqual(sizes["coulomb-friction"] / COULOMB, 1.0, delta=0.05)
                self.assertAlmostEqual(sizes["viscous-friction"] * DEG / VISCOUS, 1.0, delta=0.05)

    def test_what_of_the_position_an_effect_explains_is_what_the_joint_without_it_does(self):
        whole = write_log(self.folder / "log.csv", 0.0063)
        found = self.diagnosed("log.csv", LAW + ",delay=fit", "--model", "m.json")["drive"]
        told = {"both": found["position_before_deg"], **found["position_of_deg"]}
        for name, lacks in (("both", {"coulomb": 0.0, "viscous": 0.0}), ("coulomb-friction", {"coulomb": 0.0}),
                            ("viscous-friction", {"viscous": 0.0})):
            without = write_log(self.folder / "without.csv", 0.0063, **lacks)
            moved = DEG * math.sqrt(sum((a - b) ** 2 for a, b in zip(whole, without)) / len(whole))
            # The inertia of the joint, which the answer leaves out, makes 4 to 7 %.
            self.assertAlmostEqual(told[name] / moved, 1.0, delta=0.1)
        self.assertLess(found["position_after_deg"], 0.03 * found["position_before_deg"])

    def test_info_and_simulate_make_the_same_torque(self):
        write_log(self.folder / "log.csv", 0.0063, seconds=8.0)
        law = LAW + ",delay=6.3ms"
        text = ended(0, self.run_tool("info", "log.csv", "--drive", law)).stdout
        (words,) = [line for line in text.splitlines() if line.startswith("drive: ")]
        self.assertRegex(words, r"^drive: [\d.]+ Nm rms by its law; delay of the command 6.3 ms$")
        self.assertRegex(text, r"(?m)^  diagnose +yes  a second log with ")
        told = json.loads(ended(0, self.run_tool("info", "log.csv", "--drive", law, "--json")).stdout)["joints"][0]["drive"]
        again = self.run_tool("simulate", "log.csv", "--gear-ratio", "100", "--inertia", "0.8", "--drive", law, "-o", "again.csv", "--json", "-q")
        self.assertAlmostEqual(json.loads(again.stdout)["along_log"]["measured_rms_nm"], told["rms_nm"], delta=1e-4)
        self.assertAlmostEqual(told["rms_nm"], float(words.split()[1]), delta=0.01)

    @unittest.skipUnless(BAM.is_dir(), "the logs of published models are not here")
    def test_a_published_model_is_found_behind_its_control_law(self):
        # BAM's M1 of eRob80:100 at its first gain; truth: 5.611 Nm, 8.392 Nm s/rad, 40.21 Nm.
        found = self.diagnosed(BAM / "erob80_100_m1.csv", "pd,kp=153.16,kd=68.49,command=target_rad,delay=fit", "--model", "auto",
                               "--gear-ratio", "100", "--to", "22s")
        self.assertEqual(set(found["named"]), {"coulomb-friction", "viscous-friction", "gravity"})
        sizes = sizes_of(found)
        self.assertAlmostEqual(sizes["coulomb-friction"] / 5.611, 1.0, delta=0.05)
        self.assertAlmostEqual(sizes["viscous-friction"] * DEG / 8.392, 1.0, delta=0.05)
        self.assertAlmostEqual(sizes["gravity"] / 40.21, 1.0, delta=0.05)
        self.assertAlmostEqual(found["drive"]["delay_s"], 0.0, delta=0.001)

    @unittest.skipUnless(SAGE.is_dir(), "the real logs are not here")
    def test_a_real_servo_has_a_delay_and_its_friction_as_a_position(self):
        # Lists in cells and microseconds, as that project writes its logs; the kp that torque over deviation has.
        rows = [line.split(",") for line in (SAGE / "chirp_sweep.csv").read_text().splitlines()[1:]]
        lines = ["timestamp,positions,commands"]
        for row in rows:
            lines.append(f'{1e6 * float(row[0]):.0f},"[{", ".join(row[4:7])}]","[{", ".join(row[1:4])}]"')
        (self.folder / "sage.csv").write_text("\n".join(lines) + "\n")
        for joint, low_s, high_s in (("0", 0.1, 0.16), ("1", 0.18, 0.25), ("2", 0.18, 0.24)):
            with self.subTest(joint=joint):
                found = self.diagnosed("sage.csv", "pd,kp=5.4,command=commands[{joint}],delay=fit", "--joint", joint, "--model", "auto",
                                       "--gear-ratio", "345", "--unit", "time=us", "--unit", "position=rad")
                self.assertTrue(low_s < found["drive"]["delay_s"] < high_s, found["drive"])
                self.assertLess(found["drive"]["position_after_deg"], 0.85 * found["drive"]["position_before_deg"])
        # Too slow to tell a delay, which is said and not guessed.
        ended(3, self.run_tool("diagnose", str(SAGE / "friction_gravity.csv"), "--joint", "2", "--model", "auto", "--gear-ratio", "345", "--drive",
                               "pd,kp=5.4,command=cmd{joint}_rad,delay=fit", "-q"), "does not determine one delay")
