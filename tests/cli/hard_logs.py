# SPDX-License-Identifier: MIT
"""Logs as robots write them and readers take them wrong: each breaks one thing that a log says about itself.

usage: hard_logs.py FOLDER      writes them all, one CSV each

What is broken is told by the function's docstring; everything else is a clean recording of a joint with gear ratio 100
and ripple of order 1 (0.8 Nm) and 2 (0.4 Nm) that swings to and fro.
"""

import collections.abc
import functools
import math
import pathlib
import random
import sys

RATIO, RIPPLE_NM = 100, {1: 0.8, 2: 0.4}


class Row:
    def __init__(self, time_s, noise):
        w = 0.9
        self.time_s = time_s
        self.position_deg = 100 * math.sin(w * time_s)
        self.velocity_deg_s = 100 * w * math.cos(w * time_s) + 0.05 * noise.gauss(0, 1)
        motor = math.radians(RATIO * self.position_deg)
        ripple = 0.0
        for n, a in RIPPLE_NM.items():
            ripple += a * math.sin(n * motor + n)
        self.torque_nm = 3 * math.sin(1.3 * time_s) + ripple + 0.05 * noise.gauss(0, 1)


def swing(times_s):
    noise = random.Random(7)
    return [Row(t, noise) for t in times_s]


def even(rows=20000, rate_hz=1000.0):
    return [k / rate_hz for k in range(rows)]


def text(rows, position=True):
    head = "time_s,velocity_deg_s,torque_nm" + (",position_deg" if position else "")
    line = "%.6f,%.6f,%.6f,%.6f" if position else "%.6f,%.6f,%.6f"
    lines = [line % ((row.time_s, row.velocity_deg_s, row.torque_nm) + ((row.position_deg,) if position else ())) for row in rows]
    return "\n".join([head, *lines]) + "\n"


@functools.cache
def clean_lines():
    """Rows of the clean swing, and the text of each up to its position: most logs differ from it in the position alone."""
    rows = swing(even())
    return [(row, "%.6f,%.6f,%.6f," % (row.time_s, row.velocity_deg_s, row.torque_nm)) for row in rows]


def moved(change):
    lines = ["%s%.6f" % (start, change(row)) for row, start in clean_lines()]
    return "\n".join(["time_s,velocity_deg_s,torque_nm,position_deg", *lines]) + "\n"


def clean():
    """Nothing is wrong."""
    return moved(lambda row: row.position_deg)


def another_joints_position():
    """The position goes 0.3 times as far as the velocity says."""
    return moved(lambda row: 0.3 * row.position_deg)


def unrelated_position():
    """The position is that of a joint that moves on its own."""
    return moved(lambda row: 60 * math.sin(2.3 * row.time_s + 1))


def motor_side_position():
    """The position is the motor's, 100 times as far."""
    return moved(lambda row: RATIO * row.position_deg)


def reversed_position():
    """The position counts the other way round."""
    return moved(lambda row: -row.position_deg)


def standing_position():
    """The position never changes."""
    return moved(lambda row: 12.5)


def wrapped_position():
    """The position starts again at a full turn."""
    rows = swing(even())
    noise = random.Random(3)
    for row in rows:
        row.velocity_deg_s = 90 + 0.05 * noise.gauss(0, 1)
        row.position_deg = 90 * row.time_s % 360
        motor = math.radians(RATIO * 90 * row.time_s)
        row.torque_nm = 3 + sum(a * math.sin(n * motor + n) for n, a in RIPPLE_NM.items()) + 0.05 * noise.gauss(0, 1)
    return text(rows)


def position_stops_on_the_way():
    """The position stands still from row 12000 on."""
    stop = clean_lines()[12000][0]
    return moved(lambda row: min(row, stop, key=lambda one: one.time_s).position_deg)


def no_position():
    return text(swing(even()), position=False)


def every_second_torque_held():
    """The torque is written twice each time, at a speed that is commanded and constant, and there is no position."""
    noise = random.Random(5)
    rows = swing(even(4000))
    for k, row in enumerate(rows):
        row.velocity_deg_s = 60.0
        motor = math.radians(RATIO * 60 * row.time_s)
        row.torque_nm = 3 + 0.8 * math.sin(motor) + 0.05 * noise.gauss(0, 1)
        if k % 2:
            row.torque_nm = rows[k - 1].torque_nm
    return text(rows, position=False)


def clock_coarser_than_the_rows():
    """Each time stands there three times."""
    rows = swing(even())
    for k, row in enumerate(rows):
        row.time_s = (k - k % 3) / 1000
    return text(rows)


def clock_that_stands():
    """Every row has the same time: no filter can run."""
    rows = swing(even(2000))
    for row in rows:
        row.time_s = 5.0
    return text(rows)


def rate_falls_on_the_way():
    """2 kHz up to row 17000, 167 Hz from there on."""
    times = [k / 2000 for k in range(17001)]
    times += [times[-1] + k / 167 for k in range(1, 23000)]
    return text(swing(times))


def rate_rises_on_the_way():
    """167 Hz up to row 1000, 2 kHz from there on."""
    times = [k / 167 for k in range(1001)]
    times += [times[-1] + k / 2000 for k in range(1, 30000)]
    return text(swing(times))


def lost_rows():
    """1 kHz with 2.2 % of the rows lost, here and there."""
    chance = random.Random(11)
    return text(swing([k / 1000 for k in range(20000) if chance.random() > 0.022 or k < 10]))


def gaps():
    """Pauses of 0.4 and 3 s."""
    return text(swing([k / 1000 + (0.4 if k > 6000 else 0) + (3 if k > 15000 else 0) for k in range(20000)]))


def jitter():
    """Stamps off by up to 0.3 ms."""
    chance = random.Random(13)
    return text(swing([k / 1000 + chance.uniform(-3e-4, 3e-4) for k in range(20000)]))


def a_clock_of_years():
    """A step of three years between two rows that go on as before."""
    return text(swing([k / 1000 + (1e8 if k > 9000 else 0) for k in range(20000)]))


LOGS = {case.__name__: case for case in (
    clean, another_joints_position, unrelated_position, motor_side_position, reversed_position, standing_position,
    wrapped_position, position_stops_on_the_way, no_position, every_second_torque_held, clock_coarser_than_the_rows,
    clock_that_stands, rate_falls_on_the_way, rate_rises_on_the_way, lost_rows, gaps, jitter, a_clock_of_years)}


class Written(collections.abc.Mapping):
    """Paths of all logs by name; each is written when it is first asked for."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def __iter__(self):
        return iter(LOGS)

    def __len__(self):
        return len(LOGS)

    def __getitem__(self, name):
        make, path = LOGS[name], self.folder / f"{name}.csv"
        if not path.exists():
            path.write_text(make())
        return path


if __name__ == "__main__":
    for path in Written(sys.argv[1]).values():
        print(path)
