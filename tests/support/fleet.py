# SPDX-License-Identifier: MIT
"""A fleet of joints as lines of features, from a model of what moves them from week to week: the season and warm-up, load,
speed, weeks without a log, descriptors that a log does not tell, and an event in each joint where one is asked for.

Numbers are round ones of joints as in docs: 20 % of viscous friction between a cold and a warm joint, noise from log to log
of 1.5 % for Coulomb friction, 2 % for viscous friction and ripple, 0.5 % for inertia and weight.
"""

import datetime
import json
import random
import sys

FIRST = datetime.date(2025, 1, 6)
VERSION = "0.1.0"
# name: (usual value, relative spread from joint to joint, noise of a log, share of it where noise is relative)
DESCRIPTORS = {
    "gear_ratio": (100.0, 0.0, 0.003, False),
    "ripple_1_amplitude_nm": (0.5, 0.2, 0.02, True),
    "ripple_1_phase_deg": (40.0, 0.5, 2.0, False),
    "ripple_2_amplitude_nm": (0.8, 0.2, 0.02, True),
    "ripple_2_phase_deg": (-70.0, 0.5, 2.0, False),
    "coulomb_friction_nm": (4.0, 0.1, 0.015, True),
    "viscous_friction_nm_per_deg_s": (0.05, 0.1, 0.02, True),
    "load_friction_nm_per_nm": (0.04, 0.1, 0.04, True),
    "lost_motion_deg": (0.10, 0.1, 0.012, False),
    "inertia_kgm2": (2.0, 0.02, 0.005, True),
    "gravity_nm": (12.0, 0.02, 0.005, True),
    "sensor_zero_nm": (0.3, 0.5, 0.03, False),
    "noise_floor_nm": (0.05, 0.1, 0.03, True),
}
TORQUES = ("ripple_1_amplitude_nm", "ripple_2_amplitude_nm", "coulomb_friction_nm", "viscous_friction_nm_per_deg_s",
           "inertia_kgm2", "gravity_nm", "sensor_zero_nm", "noise_floor_nm")


class Event:
    def __init__(self, words, descriptors, change):
        self.words, self.descriptors, self.change = words, descriptors, change
        self.day = None

    def at(self, day):
        made = Event(self.words, self.descriptors, self.change)
        made.day = day.isoformat() + "T00:00:00Z"
        return made


EVENTS = (
    Event("Coulomb friction +10 %", ("coulomb_friction_nm",),
          lambda name, value: value * 1.1 if name == "coulomb_friction_nm" else value),
    Event("ripple of order 2 +20 %", ("ripple_2_amplitude_nm",),
          lambda name, value: value * 1.2 if name == "ripple_2_amplitude_nm" else value),
    Event("lost motion +0.05 deg", ("lost_motion_deg",),
          lambda name, value: value + 0.05 if name == "lost_motion_deg" else value),
    Event("gain of the torque sensor +2 %", TORQUES,
          lambda name, value: value * 1.02 if name in TORQUES else value),
)


class Joint:
    def __init__(self, robot, lines, event):
        self.robot, self.lines, self.event = robot, lines, event
        self.dates = [line["date"] for line in lines]

    def logs_between(self, one, other):
        low, high = sorted((one, other))
        return sum(low < date <= high for date in self.dates)


def moved(name, value, warm, load, speed):
    """What conditions make of a descriptor: warm 0 to 1, load 5 to 15 Nm, speed 20 to 60 deg/s."""
    if name == "viscous_friction_nm_per_deg_s":
        return value * 0.8 ** warm
    if name == "coulomb_friction_nm":
        return value * (1.0 - 0.05 * warm) * (1.0 + 0.01 * (load - 10.0)) * (1.0 - 0.001 * (speed - 40.0))
    if name == "load_friction_nm_per_nm":
        return value * (1.0 - 0.04 * warm)
    if name.startswith("ripple_") and name.endswith("_nm"):
        return value * (1.0 + 0.004 * (load - 10.0)) * (1.0 + 0.001 * (speed - 40.0))
    if name == "lost_motion_deg":
        return value * (1.0 + 0.005 * (load - 10.0))
    return value


def line(draw, robot, day, base, event):
    warm = min(1.0, max(0.0, 0.45 + 0.15 * draw.gauss(0, 1) + 0.3 * (day.timetuple().tm_yday / 365.0 - 0.5) + draw.choice((-0.3, 0.3))))
    load, speed = draw.uniform(5.0, 15.0), draw.uniform(20.0, 60.0)
    made = {"schema": "ripplenotch/features/1", "version": VERSION, "log": f"{robot}/{day}.csv", "sha256": "", "robot": robot,
            "joint": "J2", "date": f"{day}T00:00:00Z", "date_source": "name", "temperature_degc": round(20.0 + 25.0 * warm, 2),
            "temperature_source": "column motor_temp", "rows": 20000, "duration_s": 20.0, "moving_share": 0.9, "forward_share": 0.5,
            "speed_p10_deg_s": 0.3 * speed, "speed_p50_deg_s": speed, "speed_p90_deg_s": 1.8 * speed, "travel_deg": 180.0,
            "torque_rms_nm": 1.2 * load, "reversals": 20, "load_rms_nm": load}
    reasons = {}
    for name, (_, _, noise, relative) in DESCRIPTORS.items():
        if draw.random() < 0.03:
            made[name], reasons[name] = None, "the motion of this log does not show it"
            continue
        value = moved(name, base[name], warm, load, speed)
        if event is not None and made["date"] >= event.day:
            value = event.change(name, value)
        own = noise * (abs(base[name]) if relative else 1.0) * draw.uniform(0.7, 1.5)
        made[name] = round(value + draw.gauss(0, own), 6)
        stem, _, unit = name.partition("_nm") if "_nm" in name else name.partition("_deg") if "_deg" in name else name.partition("_kgm2")
        interval = name + "_ci95" if name == "gear_ratio" else f"{stem}_ci95{name[len(stem):]}"
        made[interval] = [round(made[name] - 1.96 * own, 6), round(made[name] + 1.96 * own, 6)]
    made["not_told"] = reasons
    return made


def fleet(joints, weeks, seed, events, logs_after=None):
    """Joints in turn of each event, or of none; with logs_after the lines end so many logs after the event."""
    draw = random.Random(seed)
    made = []
    for number in range(joints):
        robot = f"R{number:04}"
        base = {name: usual * (1.0 + spread * draw.gauss(0, 1)) for name, (usual, spread, _, _) in DESCRIPTORS.items()}
        days = [FIRST + datetime.timedelta(weeks=week) for week in range(weeks) if draw.random() > 0.1]
        event = None
        if events:
            event = EVENTS[number % len(EVENTS)].at(days[draw.randrange(len(days) // 2, len(days) - 4)])
            if logs_after is not None:
                after = [day for day in days if day.isoformat() >= event.day[:10]]
                days = [day for day in days if day not in after[logs_after:]]
        made.append(Joint(robot, [line(draw, robot, day, base, event) for day in days], event))
    return made


if __name__ == "__main__":  # data/fleet.ndjson
    for joint in fleet(4, 30, 6, events=True, logs_after=8):
        for one in joint.lines:
            sys.stdout.write(json.dumps(one, separators=(",", ":")) + "\n")
