# SPDX-License-Identifier: MIT
"""A case: a joint with something hidden in it, and two logs of that joint.

The joint, the training log and the validation log are drawn from the case's name and number alone, so that any case
can be made again by itself.
"""

import dataclasses
import zlib

import numpy as np

from . import disturbances, joint, motion, sensor

SAMPLE_RATE_HZ = 1000.0


@dataclasses.dataclass
class Log:
    time_s: np.ndarray
    velocity_deg_s: np.ndarray
    torque_nm: np.ndarray
    position_deg: np.ndarray | None
    place_s: tuple | None  # of a disturbance

    def save(self, path):
        columns = {"time_s": self.time_s, "velocity_deg_s": self.velocity_deg_s, "torque_nm": self.torque_nm}
        if self.position_deg is not None:
            columns["position_deg"] = self.position_deg
        rows = np.empty(len(self.time_s), [(name, "<f8") for name in columns])
        for name, values in columns.items():
            rows[name] = values
        np.save(path, rows)


@dataclasses.dataclass(frozen=True)
class Case:
    study: str
    label: str
    number: int
    noise: str = "white"
    hidden: tuple = ()  # labels of joint
    disturbance: str | None = None
    position: bool = True
    seconds: float = 40.0

    @property
    def name(self):
        words = (self.study, self.label, "rich", self.noise, "" if self.position else "no-position", str(self.number))
        return "-".join(word.replace(" ", "_").replace(",", "") for word in words if word)

    def rng(self, purpose):
        return np.random.default_rng([zlib.crc32(f"{self.name} {purpose}".encode())])

    def truth(self):
        """The complete joint: what the model knows and what is hidden from it."""
        rng = self.rng("joint")
        base = joint.base_joint(rng)
        return base, [joint.draw(rng, label) for label in self.hidden]

    def log(self, purpose):
        """purpose: 'train' or 'validate'; another motion, noise and chance of the same joint."""
        base, hidden = self.truth()
        rng = self.rng(purpose)
        start_deg = rng.uniform(-90.0, 90.0) if self.position else 0.0  # without position every log begins at one stop
        travel = motion.rich(rng, start_deg, self.seconds)
        time = np.arange(round(travel.duration_s * SAMPLE_RATE_HZ)) / SAMPLE_RATE_HZ
        q, v, _ = travel.at(time)
        torque = joint.torque(travel, base + hidden, joint.GEAR_RATIO, time)
        place = None
        if self.disturbance:
            disturbing, place = disturbances.DISTURBANCES[self.disturbance](rng, time)
            torque = torque + disturbing
        noise = sensor.noise(rng, self.noise, len(time), joint.TORQUE_NOISE_NM)
        torque = sensor.convert(torque + noise, hidden, rng)
        q, v = joint.seen(q, v, hidden)
        v = v + joint.VELOCITY_NOISE_DEG_S * rng.standard_normal(len(time))
        position = np.round(q * 2**19 / 360) * 360 / 2**19 if self.position else None  # an encoder of 19 bits
        return Log(time, v, torque, position, place)


# How many of each kind: 5 of each single effect, 40 pairs, 40 logs of each noise with nothing hidden, ...
SEEDS = {"single": 5, "rarer": 2, "pair": 40, "triple": 30, "null": 40, "outside": 15}


def studies(name, seeds, first=0):
    """The cases of one study, the first of every kind before the second of any; seeds: how many of each."""
    numbers = range(first, first + seeds)
    if name == "single":
        return [Case(name, label, n, hidden=(label,)) for n in numbers for label in (*joint.HIDDEN, *joint.FURTHER)]
    if name == "rarer":
        return [Case(name, label, n, hidden=(label,), position=label != "velocity-bias") for n in numbers for label in joint.RARER]
    if name in ("pair", "triple"):
        count = 2 if name == "pair" else 3
        several = [joint.draw_several(np.random.default_rng([count, n]), count) for n in numbers]
        return [Case(name, "+".join(labels), n, hidden=tuple(labels)) for n, labels in zip(numbers, several)]
    if name == "null":
        return [Case(name, "nothing", n, noise=kind) for n in numbers for kind in sensor.NOISES]
    if name == "outside":
        return [Case(name, label, n, disturbance=label) for n in numbers for label in disturbances.DISTURBANCES]
    raise SystemExit(f"prove-diagnose: there is no study '{name}'; there are: {', '.join(SEEDS)}")


def planned(names, seeds=None, first=0):
    """The cases of several studies in turns: a run that is cut off has the same share of each."""
    found = [(k / len(all_of), case) for name in names for all_of in [studies(name, seeds or SEEDS.get(name, 1), first)]
             for k, case in enumerate(all_of, 1)]
    return [case for _, case in sorted(found, key=lambda pair: pair[0])]
