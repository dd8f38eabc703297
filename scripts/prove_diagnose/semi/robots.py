# SPDX-License-Identifier: MIT
"""The robots whose logs lend motion, rigid bodies and residual. The logs are no part of this repository."""

import dataclasses
import math

import numpy as np

from . import chain

HEAD = "a_m,alpha_deg,d_m,theta_deg\n"


@dataclasses.dataclass(frozen=True)
class Robot:
    name: str
    log: str
    joints: tuple
    torque: str  # how the torque's column is called after the joint's name
    rate_hz: float
    kind: str  # of the table: mdh or dh
    table: tuple  # a (m), alpha (deg), d (m), theta (deg)
    ratios: tuple
    orders: tuple  # of ripple that its sample rate holds
    motion_hz: float  # the motion that the rigid bodies see is cut there
    pull: float  # of the inertial values towards 0

    def chain(self):
        return chain.of_table(self.kind, self.table)

    def table_text(self):
        return HEAD + "".join(",".join(map(str, row)) + "\n" for row in self.table)

    def read(self, folder):
        """Time (s), and angle, speed (rad) and torque of all joints, rows by joints, on a clock without jitter."""
        with open(folder / self.log) as file:
            head = file.readline().strip().split(",")
            rows = np.loadtxt(file, delimiter=",")
        column = dict(zip(head, rows.T))
        time = column["time_s"] - column["time_s"][0]
        clock = np.arange(math.floor(time[-1] * self.rate_hz) + 1) / self.rate_hz
        grid = [np.stack([np.interp(clock, time, column[f"{joint}_{what}"]) for joint in self.joints], 1)
                for what in ("position_rad", "velocity_rad_s", self.torque)]
        return (clock, *grid)


PANDA = Robot("panda", "gpl3/panda_gaz_all.csv", tuple(f"panda_joint{k}" for k in range(1, 8)), "torque_Nm", 1000.0, "mdh",
              ((0, 0, 0.333, 0), (0, -90, 0, 0), (0, 90, 0.316, 0), (0.0825, 90, 0, 0), (-0.0825, -90, 0.384, 0), (0, 90, 0, 0),
               (0.088, 90, 0, 0)), (120,) * 4 + (80,) * 3, (1, 2, 4), 6.0, 10.0)
UR10 = Robot("ur10", "ur10_unisa_exciting_all.csv",
             tuple(f"{name}_joint" for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")),
             "effort_Nm", 125.0, "dh",
             ((0, 90, 0.1273, 0), (-0.612, 0, 0, 0), (-0.5723, 0, 0, 0), (0, 90, 0.163941, 0), (0, -90, 0.1157, 0),
              (0, 0, 0.0922, 0)), (100,) * 6, (1,), 3.0, 1.0)
ROBOTS = {robot.name: robot for robot in (PANDA, UR10)}
