# SPDX-License-Identifier: MIT
"""Simulated logs of an arm's joints: gravity, friction, noise, ripple of the own motors and, where it is asked for, of others.

Every joint follows a sum of sines of its own. Its gear ratio is one of catalogues; its own ripple has orders 1, 2 and 4 on both
combs, with amplitudes that change with speed, direction and load, which no map describes exactly.
"""

import math
import random

RATIOS = (50, 80, 100, 120, 160)
ORDERS = (1, 2, 4)


class Joint:
    def __init__(self, rng, own_nm):
        self.start = rng.uniform(-60, 60)
        self.sines = [(2 * math.pi * rng.uniform(0.05, 0.35), rng.uniform(8, 30), rng.uniform(0, 2 * math.pi)) for _ in range(4)]
        self.ratio = rng.choice(RATIOS)
        self.weight, self.weight_at = rng.uniform(0, 30), rng.uniform(0, 360)
        self.coulomb, self.viscous = rng.uniform(0.3, 3), rng.uniform(0, 0.03)
        self.noise = rng.uniform(0.01, 0.08)
        self.lines = []
        size = own_nm * rng.uniform(0.3, 2.0)
        for order in ORDERS:
            for comb, share in ((0, 1.0), (rng.choice((1, -1)), rng.uniform(0.2, 1.0))):
                self.lines.append((order * (self.ratio + comb), size * rng.uniform(0.2, 1.0) * share / order,
                                   rng.uniform(-0.3, 1.0), rng.uniform(0.6, 1.4), rng.uniform(-0.4, 0.4),
                                   rng.uniform(0, 2 * math.pi)))

    def at(self, t):
        """Position and velocity, deg and deg/s."""
        position, velocity = self.start, 0.0
        for w, size, phase in self.sines:
            position += size * math.sin(w * t + phase)
            velocity += size * w * math.cos(w * t + phase)
        return position, velocity

    def torque(self, position, velocity, rng):
        load = self.weight * math.sin(math.radians(position + self.weight_at))
        total = load + self.coulomb * math.tanh(velocity / 0.5) + self.viscous * velocity + rng.gauss(0.0, self.noise)
        for cycles, amplitude, by_speed, backward, by_load, phase in self.lines:
            size = amplitude * (1 + by_speed * abs(velocity) / 100) * (1 if velocity > 0 else backward)
            size *= 1 + by_load * load / 30
            total += size * math.cos(math.radians(cycles * position) + phase)
        return total


def write_arm_log(path, seed, joints=7, seconds=20.0, rate=500.0, own_nm=0.3, others=(), ratios=None):
    """`others`: (sensor, motor, amplitude in Nm, order), joints counted from 1. Returns the gear ratios."""
    rng = random.Random(f"arm {seed}")
    arm = [Joint(rng, own_nm) for _ in range(joints)]
    for joint, ratio in zip(arm, ratios or ()):
        joint.lines = [(line[0] / joint.ratio * ratio, *line[1:]) for line in joint.lines]
        joint.ratio = ratio
    with open(path, "w", encoding="ascii") as out:
        names = ["time_s"]
        for j in range(1, joints + 1):
            names += [f"j{j}_position_deg", f"j{j}_velocity_deg_s", f"j{j}_torque_nm"]
        out.write(",".join(names) + "\n")
        for k in range(int(seconds * rate)):
            t = k / rate
            motion = [joint.at(t) for joint in arm]
            torques = [joint.torque(*at, rng) for joint, at in zip(arm, motion)]
            for sensor, motor, amplitude, order in others:
                angle = math.radians(order * arm[motor - 1].ratio * motion[motor - 1][0])
                torques[sensor - 1] += amplitude * math.cos(angle + 1.0)
            cells = [f"{t:.4f}"]
            for (position, velocity), torque in zip(motion, torques):
                cells += [f"{position:.4f}", f"{velocity:.4f}", f"{torque:.4f}"]
            out.write(",".join(cells) + "\n")
    return [joint.ratio for joint in arm]


if __name__ == "__main__":
    # data/arm/three_joints.csv: made by `python3 tests/support/arm_log.py data/arm/three_joints.csv`.
    import sys

    write_arm_log(sys.argv[1], 4, joints=3, seconds=10.0, rate=200.0, own_nm=0.3, others=[(3, 1, 0.25, 2), (1, 3, 0.15, 2)], ratios=[100, 80, 50])
