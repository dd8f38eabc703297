# SPDX-License-Identifier: MIT
"""Windows of logs of real robots: whole logs, and 10 and 5 s that overlap by half."""

import csv
import dataclasses
import functools

import numpy as np

WINDOWS_S = (None, 10.0, 5.0)
# File, unit of angle, its torque, ratio of each joint by the part of the column name before its quantity (None: nothing published).
LOGS = (
    ("gpl3/panda_gaz_all.csv", "rad", "torque_Nm", {**{f"panda_joint{k}": 120.0 for k in range(1, 5)}, "panda_joint5": 80.0,
                                                    "panda_joint6": 80.0, "panda_joint7": None}),
    *((f"kuka_kr300_traj{log}_all.csv", "deg", "torque_Nm", {"j1": 1798 / 7, "j2": 1872 / 7, "j3": 757 / 3, "j4": 221.0, "j5": 5032 / 21,
                                                            "j6": 206793 / 1340}) for log in "AB"),
    ("neura_lara8_j3.csv", "rad", "torque_Nm", {"": 101.0}),
    ("ur10_unisa_exciting_all.csv", "rad", "effort_Nm", {f"{name}_joint": None for name in (
        "shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")}),
    ("ur3e_rad_L1L2_j345.csv", "rad", "current_A", {"j3": 101.0, "j4": 101.0, "j5": 101.0}),
)
# Joints whose ripple was filtered out before publication: a line there is false.
SILENT = ("ur10_unisa_exciting_all",)


@dataclasses.dataclass
class Window:
    log: str
    joint: str
    ratio: float
    length: float  # None of a whole log
    time: np.ndarray
    speed: np.ndarray  # turns/s
    torque: np.ndarray
    turns: np.ndarray

    def name(self):
        return f"{self.log} {self.joint} {self.time[0]:.1f} to {self.time[-1]:.1f} s"

    @property
    def truth(self):
        return {"window": self.name(), "ratio": self.ratio}

    def csv(self, torque=None, stretch=None):
        """stretch: a factor of each row's motion."""
        turns, speed = self.turns, self.speed
        if stretch is not None:
            turns, speed = turns[0] + np.concatenate([[0.0], np.cumsum(np.diff(turns) * stretch[1:])]), speed * stretch
        rows = zip(self.time, 360 * speed, self.torque if torque is None else torque, 360 * turns)
        return "time_s,velocity_deg_s,torque_nm,position_deg\n" + "\n".join("%.9g,%.9g,%.9g,%.9g" % row for row in rows) + "\n"


def of(log):
    """A simulated log as a window; its angle is what an encoder of 14 bits and more would say."""
    return Window("simulated", str(log.truth["seed"]), None, None, log.time, log.velocity / 360, log.torque,
                  (log.angle if log.position is None else log.position) / 360)


def spans(begin, end, length):
    """Windows of a length that overlap by half, of a log that is half as long again; the whole log for None."""
    if length is None:
        return [(begin, end)]
    count = int((end - begin - length) / (length / 2) + 1.02) if end - begin > 1.5 * length else 0
    return [(begin + k * length / 2, begin + (k / 2 + 1) * length) for k in range(count)]


@functools.lru_cache(maxsize=1)
def windows(folder):
    """Of all logs that are there."""
    made = []
    for file, unit, torque, joints in LOGS:
        if not (folder / file).exists():
            continue
        with (folder / file).open(newline="") as stream:
            heads = next(csv.reader(stream))
        turn = 360.0 if unit == "deg" else 2 * np.pi
        for joint, ratio in joints.items():
            start = joint + "_" if joint else ""
            names = ("time_s", f"{start}velocity_{unit}_s", start + torque, f"{start}position_{unit}")
            columns = np.loadtxt(folder / file, delimiter=",", skiprows=1, usecols=[heads.index(name) for name in names], ndmin=2).T
            for length in WINDOWS_S:
                for begin, end in spans(columns[0, 0], columns[0, -1], length):
                    t, v, y, q = columns[:, (columns[0] >= begin) & (columns[0] <= end)]
                    made.append(Window((folder / file).stem, joint, ratio, length, t, v / turn, y, q / turn))
    return made
