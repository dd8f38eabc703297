# SPDX-License-Identifier: MIT
"""What a real log lends: the joints' motion, values of the rigid bodies that predict their torque, and at each joint what
the best description of it leaves.
"""

import dataclasses
import functools

import numpy as np

from .. import joint
from . import chain, robots

USUAL = np.array([5.0] + [0.5] * 3 + [0.1] * 6)  # kg, kg m, kg m2
SMOOTHED_MORE = 1.5  # the motion that a truth is computed along keeps more than that of the fit


def low_pass(values, cut_hz, rate_hz):
    """Without delay; ends are mirrored about their last value."""
    count = min(len(values) - 1, int(3 * rate_hz / cut_hz))
    front, back = 2 * values[0] - values[count:0:-1], 2 * values[-1] - values[-2 : -count - 2 : -1]
    longer = np.concatenate([front, values, back])
    hz = np.fft.rfftfreq(len(longer), 1 / rate_hz)
    keep = 1 / (1 + (hz / cut_hz) ** 8)
    return np.fft.irfft(np.fft.rfft(longer, axis=0) * keep.reshape(-1, *[1] * (values.ndim - 1)), len(longer), axis=0)[
        count : count + len(values)]


@dataclasses.dataclass
class Motion:
    """Of all joints, rows by joints: angle, speed, acceleration in rad."""

    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray

    def torque(self, robot, values):
        return chain.regressor(robot.chain(), self.q, self.dq, self.ddq) @ values


def smoothed(robot, q, dq, cut_hz):
    speed = low_pass(dq, cut_hz, robot.rate_hz)
    return Motion(low_pass(q, cut_hz, robot.rate_hz), speed, np.gradient(speed, 1 / robot.rate_hz, axis=0))


def friction_columns(speed):
    """Friction that differs by direction, so that the rigid bodies do not bend to it; speed in rad/s."""
    step = np.tanh(speed / np.radians(1.5))
    return np.stack([np.ones_like(speed), step, speed, step * np.exp(-((speed / 0.15) ** 2)), np.abs(step), np.abs(speed)], 1)


def inertial_values(robot, motion, speed, torque):
    """Least squares over all joints at once, drawn to 0 by the usual size of each value."""
    every = max(1, int(robot.rate_hz / (4 * robot.motion_hz)))
    columns = chain.regressor(robot.chain(), motion.q, motion.dq, motion.ddq)
    links, joints = columns.shape[2], columns.shape[1]
    scale, normal, right = np.tile(USUAL, joints), np.eye(links) * robot.pull, np.zeros(links)
    for j in range(joints):
        own = np.concatenate([friction_columns(speed[:, j]), motion.ddq[:, j : j + 1]], 1)
        both = low_pass(np.concatenate([columns[:, j] * scale, own, torque[:, j : j + 1]], 1), robot.motion_hz, robot.rate_hz)
        both = both[::every] / max(0.03 * np.sqrt(np.mean(torque[:, j] ** 2)), 1e-3)
        # What friction and the rotor's inertia take up is no matter of the links.
        basis, _ = np.linalg.qr(both[:, links:-1])
        both = both - basis @ (basis.T @ both)
        normal += both[:, :links].T @ both[:, :links]
        right += both[:, :links].T @ both[:, -1]
    return np.linalg.solve(normal, right) * scale


class Angles:
    """A joint's motion as the generator's formulas see it: joint.Instants, of a motion that was measured."""

    def __init__(self, time, angle, speed, load, gear_ratio):
        self.t, self.rad, self.q, self.v = time, angle, np.degrees(angle), np.degrees(speed)
        self.load, self.gear_ratio = np.abs(load), gear_ratio


def best_columns(x, columns):
    """The whole arm, friction of every kind and ripple: what they leave is left by anything."""
    own = [friction_columns(np.radians(x.v)), np.tanh(np.radians(x.v) / 0.02)[:, None] * x.load[:, None]]
    own += [joint.hysteresis(x, {"torque_nm": 1.0, "width_deg": width})[:, None] for width in (0.2, 1.0, 4.0)]
    own += [np.stack([np.cos(n * x.gear_ratio * x.rad), np.sin(n * x.gear_ratio * x.rad)], 1) for n in (1, 2, 3, 4)]
    return np.concatenate([columns, *own], 1)


@dataclasses.dataclass
class Real:
    robot: robots.Robot
    time: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    torque: np.ndarray
    values: np.ndarray  # inertial
    left: np.ndarray  # rows by joints
    rigid: np.ndarray  # torque of the rigid bodies along the truth's motion
    motion: Motion  # the truth's


@functools.lru_cache(maxsize=2)
def real(name, folder):
    """What the log of the robot lends."""
    robot = robots.ROBOTS[name]
    time, q, dq, torque = robot.read(folder)
    motion = smoothed(robot, q, dq, robot.motion_hz)
    values = inertial_values(robot, motion, dq, torque)
    columns, rigid, left = chain.regressor(robot.chain(), motion.q, motion.dq, motion.ddq), motion.torque(robot, values), []
    for j, ratio in enumerate(robot.ratios):
        speed = low_pass(dq[:, j], 40.0, robot.rate_hz) if robot.rate_hz > 200 else dq[:, j]
        best = best_columns(Angles(time, q[:, j], speed, rigid[:, j], ratio), columns[:, j])
        best = best / (np.sqrt(np.mean(best**2, axis=0)) + 1e-9)
        normal = best.T @ best / len(time) + 1e-6 * np.eye(best.shape[1])
        left.append(torque[:, j] - best @ np.linalg.solve(normal, best.T @ torque[:, j] / len(time)))
    true = smoothed(robot, q, dq, SMOOTHED_MORE * robot.motion_hz)
    return Real(robot, time, q, dq, torque, values, np.stack(left, 1), true.torque(robot, values), true)
