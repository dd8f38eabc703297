# SPDX-License-Identifier: MIT
"""Logs as text, made without the tool: of the tests of commands, and of their cases (`make NAME = steady(60, 0.5)`)."""

import functools
import math
import random

HEADER = "time_s,velocity_deg_s,torque_nm,position_deg"
# Two links that hang in a plane: lengths, masses at their ends (m, kg).
LENGTH, MASS, G = (0.5, 0.4), (4.0, 2.5), 9.81


def table(header, rows):
    """Rows of numbers as CSV, as many columns as the header names."""
    count = header.count(",") + 1
    return header + "\n" + "".join(",".join(f"{cell:.6f}" for cell in row[:count]) + "\n" for row in rows)


def steady(speed, ripple_nm, seconds=4.0, rate=500.0, seed=1):
    """Ripple of order 100 of the joint at a constant speed, without a position."""
    noise = random.Random(seed)
    rows = ["time_s,velocity_deg_s,torque_nm"]
    for k in range(int(seconds * rate)):
        t = k / rate
        torque = 5.0 + ripple_nm * math.sin(2 * math.pi * 100 * speed / 360 * t) + noise.gauss(0, 0.05)
        rows.append(f"{t:.4f},{speed},{torque:.6f}")
    return "\n".join(rows) + "\n"


def sine(rows, rate=1000.0, speed=90.0, header="time_s,velocity_deg_s,torque_nm", gap_after=None):
    """A torque of 25 Hz; half a second is missing behind the row `gap_after`."""
    lines = [header]
    for k in range(rows):
        t = k / rate + (0.5 if gap_after is not None and k > gap_after else 0.0)
        lines.append(f"{t:.6f},{speed},{3 + math.sin(2 * math.pi * 25 * k / rate):.6f}")
    return "\n".join(lines) + "\n"


def rippled(seconds=20, speed=80.0, rate=1000, ratio=100.0):
    """0.8 Nm of order 1 and 0.5 Nm of order 2 at a constant speed, without noise."""
    rows = ["time_s,velocity_deg_s,torque_nm"]
    for k in range(seconds * rate):
        angle = math.radians(ratio * speed * k / rate)
        rows.append(f"{k / rate:.3f},{speed},{4 + 0.8 * math.sin(angle) + 0.5 * math.cos(2 * angle):.9f}")
    return "\n".join(rows) + "\n"


def two_lines(speed, slope=0.0, seconds=8.0, noise=0.0, chatter=0.0):
    """0.8 Nm of order 1 and 0.5 Nm of order 2 at a speed that changes by `slope` in a second and swings by `chatter` at 40 Hz."""
    rows, angle, state = [HEADER], 0.0, 12345
    for k in range(int(seconds * 1000)):
        t = k / 1000.0
        v = speed + slope * t + chatter * math.sin(2 * math.pi * 40 * t)
        motor = math.radians(100.0 * angle)
        state = (1103515245 * state + 12345) % 2**31
        torque = 2.0 + 0.8 * math.cos(motor + 0.3) + 0.5 * math.cos(2.0 * motor + 1.1) + noise * math.sqrt(12.0) * (state / 2**31 - 0.5)
        rows.append(f"{t:.3f},{v:.9g},{torque:.12g},{angle:.12g}")
        angle += v / 1000.0
    return "\n".join(rows) + "\n"


def swing(clock=1.0, rows=4000, torque=True):
    """A joint that swings by 100 deg, sampled at 500 Hz, its clock stretched by a factor."""
    def cells(t):
        return t * clock, 90 * math.cos(0.9 * t), 100 * math.sin(0.9 * t), 3 * math.sin(2.1 * t)
    return table("time_s,velocity_deg_s,position_deg" + (",torque_nm" if torque else ""), (cells(k / 500) for k in range(rows)))


@functools.cache
def to_and_fro(seed):
    """Row by row of 20 s at 1 kHz: time, velocity, position, slow torque, the motor's angle in rad, noise."""
    draw, position, before, rows = random.Random(seed), 3.0, None, []
    for k in range(20000):
        t = k / 1000.0
        v = 80 * math.sin(0.9 * t + seed) + 30 * math.sin(0.37 * t)
        position += 0.0 if before is None else (before + v) / 2000.0
        before = v
        rows.append((t, v, position, 6 * math.sin(0.5 * t), math.radians(100 * position), draw.gauss(0, 0.05)))
    return rows


def map_log(seed, shift_deg=0.0, ripple=1.0, header=HEADER):
    """Ripple of 0.8 Nm (order 1, phase 30 deg) and 0.5 Nm (order 2) at a gear ratio of 100."""
    return table(header, ((t, v, slow + ripple * (0.8 * math.cos(theta + math.radians(30)) + 0.5 * math.cos(2 * theta)) + noise, position + shift_deg)
                          for t, v, position, slow, theta, noise in to_and_fro(seed)))


def slow_log(seconds=16, ripple=1.0, noise=0.05, slow_nm=6.0, header=HEADER, speed=None, seed=1):
    """The same beside a slow torque of any size, or at one speed."""
    draw = random.Random(seed)
    position, before, rows = 3.0, None, []
    for k in range(int(seconds * 1000)):
        t = k / 1000.0
        v = speed if speed is not None else 80 * math.sin(0.9 * t + 1) + 30 * math.sin(0.37 * t)
        position += 0.0 if before is None else (before + v) / 2000.0
        before = v
        theta = math.radians(100 * position)
        nm = slow_nm * math.sin(0.5 * t) + ripple * (0.8 * math.cos(theta + 0.5) + 0.5 * math.cos(2 * theta)) + draw.gauss(0, noise)
        rows.append((t, v, nm, position))
    return table(header, rows)


def link_motion(t, phase):
    """Angle, speed and acceleration in radians: two sines, so that speed and posture are not one another."""
    q = 0.9 * math.sin(1.1 * t + phase) + 0.5 * math.sin(2.3 * t)
    v = 0.99 * math.cos(1.1 * t + phase) + 1.15 * math.cos(2.3 * t)
    return q, v, -1.089 * math.sin(1.1 * t + phase) - 2.645 * math.sin(2.3 * t)


def link_torques(a, b):
    """Of two point masses in a plane, as every textbook has them."""
    (q1, v1, a1), (q2, v2, a2) = a, b
    (l1, l2), (m1, m2) = LENGTH, MASS
    inertia, coupling = m2 * l2 * l2, m2 * l1 * l2
    one = ((m1 + m2) * l1 * l1 + inertia + 2 * coupling * math.cos(q2)) * a1 + (inertia + coupling * math.cos(q2)) * a2
    one += -coupling * math.sin(q2) * (2 * v1 * v2 + v2 * v2)
    one += (m1 + m2) * G * l1 * math.cos(q1) + m2 * G * l2 * math.cos(q1 + q2)
    two = (inertia + coupling * math.cos(q2)) * a1 + inertia * a2 + coupling * math.sin(q2) * v1 * v1
    return one, two + m2 * G * l2 * math.cos(q1 + q2)


def links_at(t, seed):
    one, (q, v, a) = link_motion(t, 0.3 * seed), link_motion(0.83 * t + seed, 1.0)
    return one, (q, 0.83 * v, 0.83 ** 2 * a)


def two_links(seed, coulomb_nm=0.0, seconds=30.0, rate=250.0, sign=(1, 1), delay_s=(0.0, 0.0)):
    """An arm of two links with Coulomb friction, noise of 0.05 Nm, signs of the torques and delays of their sensors."""
    noise = random.Random(seed)
    lines = ["time_s," + ",".join(f"j{j}_{kind}" for j in (1, 2) for kind in ("position_deg", "velocity_deg_s", "torque_nm"))]
    for k in range(int(seconds * rate)):
        t = k / rate
        cells = [f"{t:.4f}"]
        for joint, ((q, v, _), side, delay) in enumerate(zip(links_at(t, seed), sign, delay_s)):
            then = links_at(t - delay, seed)
            torque = link_torques(*then)[joint] + coulomb_nm * math.tanh(math.degrees(then[joint][1]) / 0.5)
            torque = side * (torque + noise.gauss(0.0, 0.05))
            cells += [f"{math.degrees(q):.6f}", f"{math.degrees(v) + noise.gauss(0.0, 0.02):.5f}", f"{torque:.5f}"]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def wide(joints, rows=4000, without=()):
    """Joints that move through all speeds, each with ripple of its own. `without`: columns that are not there."""
    names = [[f"{joint}_{name}" for name in ("velocity_deg_s", "torque_nm", "position_deg")] for joint in joints]
    lines = ["time_s," + ",".join(name for columns in names for name in columns if name not in without)]
    position = [0.0] * len(joints)
    for k in range(rows):
        cells = [f"{k / 1000:.3f}"]
        for j, columns in enumerate(names):
            speed = 90 + 60 * math.sin(k / 500 + j)
            ripple = 0.5 / (j + 1) * math.cos(math.radians(100 * position[j])) + 0.2 * math.cos(math.radians(200 * position[j]))
            values = speed, 3 * math.sin(k / 900) + ripple + 0.02 * math.sin(7.3 * k * k + j), position[j]
            cells += [f"{value:.5f}" for name, value in zip(columns, values) if name not in without]
            position[j] += speed / 1000
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def three_joints(rows=6000):
    """Joints whose speeds pass bands at different times, with ripple of their gears; j3 has no position."""
    lines = ["time_s,j1_velocity_deg_s,j1_torque_nm,j1_position_deg,note,j2_torque_nm,j2_velocity_deg_s,j2_position_deg,"
             "j3_velocity_deg_s,j3_torque_nm"]
    position = [0.0, 0.0, 0.0]
    for k in range(rows):
        speed = [90 + 60 * math.sin(k / 400), 100 - 50 * math.cos(k / 700), -60 - 30 * math.sin(k / 300)]
        torque = [1 + 0.5 * math.sin(math.radians(ratio * x)) for ratio, x in zip((100, 120, 80), position)]
        lines.append(f"{k / 1000},{speed[0]:.4f},{torque[0]:.5f},{position[0]:.5f},run,{torque[1]:.5f},{speed[1]:.4f},"
                     f"{position[1]:.5f},{speed[2]:.4f},{torque[2]:.5f}")
        position = [x + v / 1000 for x, v in zip(position, speed)]
    return "\n".join(lines) + "\n"
