# SPDX-License-Identifier: MIT
"""One semi-synthetic log: which joint, which residual, what is hidden and how large."""

import dataclasses
import pathlib
import zlib

import numpy as np

from .. import joint
from . import real, robots

KINDS = ("nothing", "coulomb-friction", "viscous-friction", "stribeck-friction", "hysteresis", "load-friction", "ripple",
         "output-ripple", "drift", "coulomb-friction+viscous-friction", "coulomb-friction+ripple",
         "hysteresis+viscous-friction", "coulomb-friction+stribeck-friction", "ripple+drift")
DISTURBANCES = {"contact": 0.4, "burst": 1.0}  # s; in no catalogue
LEAST, MOST = 0.7, 4.0  # size of a hidden effect, of the residual's rms
INERTIA_OFF = 0.2  # standard deviation of what each inertial value is off by, of the value
LOAD_PART = 0.15  # a load friction is at most so much of what the joint bears


@dataclasses.dataclass(frozen=True)
class Case:
    robot: str
    kind: str
    number: int

    @property
    def label(self):
        return self.kind

    @property
    def name(self):
        return f"semi-{self.robot}-{self.kind}-{self.number}"


@dataclasses.dataclass
class Log:
    """What is written, and what is true of it."""

    case: Case
    joint: int
    columns: dict  # name of the column: values
    hidden: list  # as in model.json, sizes included
    sizes: list  # of each, of the residual's rms
    left_nm: float
    seconds: float

    @property
    def least(self):
        return min(self.sizes, default=None)


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def shape_of(rng, name, fastest_deg_s, log):
    """Parameters but for the size, drawn."""
    if name == "coulomb-friction":
        return {"width_deg_s": rng.uniform(0.2, 2.0)}
    if name == "stribeck-friction":
        return {"stribeck_speed_deg_s": fastest_deg_s * rng.uniform(0.04, 0.18)}
    if name == "hysteresis":
        return {"width_deg": rng.uniform(0.5, 5.0)}
    if name == "load-friction":
        return {"exponent": 1.0}
    if name == "ripple":
        return {"order": float(rng.choice(log.robot.orders)), "phase_deg": rng.uniform(-180, 180)}
    if name == "output-ripple":
        return {"order": float(rng.choice([2, 3])), "phase_deg": rng.uniform(-180, 180)}
    if name == "drift":
        return {"time_constant_s": rng.uniform(4, 12) if rng.random() < 0.5 else 1e6}
    return {}


SIZE = {"viscous-friction": "coefficient_nm_per_deg_s", "ripple": "amplitude_nm", "output-ripple": "amplitude_nm",
        "drift": "rate_nm_s"}


def unit_torque(x, effect):
    """Torque of the effect with a size of 1."""
    if effect["effect"] == "ripple":
        return joint.ripple(x, effect, [])
    return joint.TORQUES[effect["effect"]](x, effect)


def chosen_joint(rng, log, kind):
    bearing = [rms(log.rigid[:, j]) * LOAD_PART > LEAST * rms(log.left[:, j]) for j in range(log.q.shape[1])]
    able = np.flatnonzero(bearing) if "load-friction" in kind else np.arange(log.q.shape[1])
    return int(rng.choice(able))


def disturbing(rng, time, length_s, left_nm):
    """A pulse, or a second of noise, of 3 to 8 times the residual."""
    count = round(length_s / (time[1] - time[0]))
    first = int(rng.uniform(0.1, 0.85) * len(time))
    shape = np.hanning(count) * (rng.standard_normal(count) if length_s > 0.5 else 1.0)
    torque = np.zeros(len(time))
    torque[first : first + count] = rng.uniform(3, 8) * left_nm * rng.choice([-1, 1]) * shape
    return torque


def most_of(name, unit, left_nm):
    if name != "load-friction":
        return MOST
    return max(1.1 * LEAST, min(MOST, LOAD_PART * np.std(unit) / left_nm))


def hide(rng, case, x, left_nm, log):
    """Effects with their sizes, and the torque of all of them."""
    hidden, sizes, total = [], [], np.zeros(len(x.t))
    for name in case.kind.split("+") if case.kind not in ("nothing", *DISTURBANCES) else ():
        size = SIZE.get(name, "torque_nm")
        effect = {"effect": name, size: 1.0, **shape_of(rng, name, float(np.abs(x.v).max()), log)}
        unit = unit_torque(x, effect)
        share = rng.uniform(LEAST, most_of(name, unit, left_nm))
        effect[size] = share * left_nm / max(float(np.std(unit)), 1e-9) * (rng.choice([-1.0, 1.0]) if name == "drift" else 1.0)
        total += effect[size] * unit
        hidden.append(effect)
        sizes.append(share)
    return hidden, sizes, total


def made(case, folder):
    """The log of the case; folder: where the real logs are."""
    log = real.real(case.robot, pathlib.Path(folder))
    rng = np.random.default_rng([zlib.crc32(case.name.encode())])
    j = chosen_joint(rng, log, case.kind)
    values = log.values * (1 + INERTIA_OFF * rng.standard_normal(len(log.values)))
    rigid = log.motion.torque(log.robot, values)
    rows = len(log.time)
    left = np.roll(log.left[:, j], int(rng.integers(rows // 10, 9 * rows // 10))) * rng.choice([-1, 1])
    x = real.Angles(log.time, log.motion.q[:, j], log.motion.dq[:, j], rigid[:, j], log.robot.ratios[j])
    hidden, sizes, extra = hide(rng, case, x, rms(left), log)
    if case.kind in DISTURBANCES:
        extra = extra + disturbing(rng, log.time, DISTURBANCES[case.kind], rms(left))
    # Other joints keep what is real about them; their links are those of the truth.
    torque = log.torque + rigid - log.rigid
    torque[:, j] = rigid[:, j] + left + extra
    columns = {"time_s": log.time}
    for k, name in enumerate(log.robot.joints):
        columns |= {f"{name}_position_rad": log.q[:, k], f"{name}_velocity_rad_s": log.dq[:, k],
                    f"{name}_torque_Nm": torque[:, k]}
    return Log(case, j, columns, hidden, sizes, rms(left), float(log.time[-1]))


def planned(seeds, first=0, kinds=(*KINDS, *DISTURBANCES)):
    """Every kind on every robot once, then again."""
    return [Case(robot, kind, n) for n in range(first, first + seeds) for kind in kinds for robot in robots.ROBOTS]
