# SPDX-License-Identifier: MIT
"""A case: a joint with something hidden in it, and two logs of that joint.

The joint, the training log and the validation log are drawn from the case's name and number alone, so that any case
can be made again by itself.
"""

import dataclasses
import math
import zlib

import numpy as np

from . import disturbances, joint, motion, nulls, other_formulas, sensor, strengths, two_mass

SAMPLE_RATE_HZ = 1000.0


@dataclasses.dataclass
class Log:
    time_s: np.ndarray
    velocity_deg_s: np.ndarray
    torque_nm: np.ndarray
    position_deg: np.ndarray | None
    noise_rms_nm: float
    place_s: tuple | None  # of a disturbance

    def save(self, path, units=None):
        """units: {column: (its name in the file, factor)}, where they are not s, deg and Nm."""
        columns = {"time_s": self.time_s, "velocity_deg_s": self.velocity_deg_s, "torque_nm": self.torque_nm}
        if self.position_deg is not None:
            columns["position_deg"] = self.position_deg
        named = {name: (units or {}).get(name, (name, 1.0)) for name in columns}
        rows = np.empty(len(self.time_s), [(name, "<f8") for name, _ in named.values()])
        for name, values in columns.items():
            rows[named[name][0]] = named[name][1] * values
        np.save(path, rows)

    def part(self, first, last):
        """Rows from the share `first` to the share `last`; its clock goes on."""
        cut = slice(round(first * len(self.time_s)), round(last * len(self.time_s)))
        return dataclasses.replace(self, time_s=self.time_s[cut], velocity_deg_s=self.velocity_deg_s[cut],
                                   torque_nm=self.torque_nm[cut],
                                   position_deg=None if self.position_deg is None else self.position_deg[cut])


# The same log in other words: what is named must not change.
VARIANTS = ("other units", "list reversed", "first half", "second half")
OTHER_UNITS = {"velocity_deg_s": ("velocity [rad/s]", math.pi / 180), "torque_nm": ("torque [mNm]", 1000.0),
               "position_deg": ("position [rad]", math.pi / 180)}


# Columns as a program names and writes them, without a word about units.
HEADERS = {"libfranka": {"time_s": ("t", 1.0), "velocity_deg_s": ("dq", math.pi / 180), "torque_nm": ("tau_J", 1.0),
                         "position_deg": ("q", math.pi / 180)}}


@dataclasses.dataclass(frozen=True)
class Case:
    study: str
    label: str
    number: int
    noise: str = "white"
    motion: str = "rich"
    hidden: tuple = ()  # labels of strengths
    disturbance: str | None = None
    other: str | None = None
    physics: str | None = None  # of two_mass.JOINTS: the whole joint is another's
    position: bool = True
    seconds: float = 40.0
    variant: str = ""
    without: str = ""  # an effect that the tool may not try
    header: str = ""  # of HEADERS: how the logs are written
    recorded: str = ""  # of recordings.WAYS; the log itself is the same

    @property
    def name(self):
        words = (self.study, self.label, self.variant, self.header, self.recorded, self.motion, self.noise,
                 "" if self.position else "no-position", str(self.number))
        return "-".join(word.replace(" ", "_").replace(",", "") for word in words if word)

    @property
    def log_of(self):
        """Name of the case whose log it is: variants and logs with an effect taken out are those of the singles."""
        study = "single" if self.variant or self.without else self.study
        if study == "recorded":
            study = ("null", "single", "pair", "triple")[len(self.hidden)]
        return dataclasses.replace(self, study=study, variant="", header="", recorded="").name

    def rng(self, purpose):
        return np.random.default_rng([zlib.crc32(f"{self.log_of} {purpose}".encode())])

    def truth(self):
        """The complete joint: what the model knows and what is hidden from it."""
        rng = self.rng("joint")
        base = strengths.base_joint(rng)
        return base, [strengths.draw(rng, label) for label in self.hidden]

    def log(self, purpose):
        """purpose: 'train' or 'validate'; another motion, noise and chance of the same joint."""
        base, hidden = self.truth()
        other = other_formulas.OTHERS[self.other](self.rng("other")) if self.other else None
        rng = self.rng(purpose)
        start_deg = rng.uniform(-90.0, 90.0) if self.position else 0.0  # without position every log begins at one stop
        travel = motion.MOTIONS[self.motion](rng, start_deg, 3.0 if self.motion == "one stroke" else self.seconds)
        time = np.arange(round(travel.duration_s * SAMPLE_RATE_HZ)) / SAMPLE_RATE_HZ
        q, v, _ = travel.at(time)
        if self.physics:
            torque, q, v = two_mass.measured(two_mass.JOINTS[self.physics], self.rng("other"), travel, base, strengths.GEAR_RATIO, time)
        else:
            torque = joint.torque(travel, base + hidden, strengths.GEAR_RATIO, time, other)
        place = None
        if self.disturbance:
            disturbing, place = disturbances.DISTURBANCES[self.disturbance](rng, time)
            torque = torque + disturbing
        noise = sensor.noise(rng, self.noise, len(time), strengths.TORQUE_NOISE_NM)
        torque = sensor.convert(torque + noise, hidden, rng)
        q, v = joint.seen(q, v, hidden)
        v = v + strengths.VELOCITY_NOISE_DEG_S * rng.standard_normal(len(time))
        position = np.round(q * 2**19 / 360) * 360 / 2**19 if self.position else None  # an encoder of 19 bits
        return Log(time, v, torque, position, float(np.sqrt(np.mean(noise**2))), place)


# One number of the study "recorded": 37 logs with something hidden.
RECORDED = {"single": 1, "pair": 8, "triple": 8}


def without_hidden(case):
    """The same joint with nothing hidden, for the smallest residual that its logs allow."""
    return dataclasses.replace(case, hidden=(), disturbance=None, other=None, physics=None)


def studies(name, seeds, seed0=0):
    """The cases of one study; seeds: how many of each."""
    numbers = range(seed0, seed0 + seeds)
    if name == "single":
        return [Case(name, label, n, hidden=(label,)) for label in (*strengths.HIDDEN, *strengths.FURTHER) for n in numbers]
    if name == "rarer":
        return [Case(name, label, n, hidden=(label,), position=label != "velocity-bias")
                for label in strengths.RARER for n in numbers]
    if name in ("pair", "triple"):
        count = 2 if name == "pair" else 3
        several = [strengths.draw_several(np.random.default_rng([count, n]), count) for n in numbers]
        return [Case(name, "+".join(labels), n, hidden=tuple(labels)) for n, labels in zip(numbers, several)]
    if name == "nulls":
        return [Case(name, "nothing", n, noise=kind.noise, recorded=kind.recorded) for kind in nulls.KINDS for n in numbers]
    if name.startswith("null"):
        return [Case(name, "nothing", n, noise=name.partition(" ")[2] or "white") for n in numbers]
    if name == "outside":
        return [Case(name, label, n, disturbance=label) for label in disturbances.DISTURBANCES for n in numbers]
    if name == "outside+single":
        labels = list(strengths.HIDDEN)
        return [Case(name, label, n, disturbance=label, hidden=(labels[(7 * n + k) % len(labels)],))
                for k, label in enumerate(disturbances.DISTURBANCES) for n in numbers]
    if name == "formula":
        return [Case(name, label, n, other=label) for label in other_formulas.OTHERS for n in numbers]
    if name == "physics":
        return [Case(name, label, n, physics=label) for label in two_mass.JOINTS for n in numbers]
    if name == "noise":
        return [Case(name, label, n, noise=kind, hidden=(label,)) for kind in ("ar0.5", "t4")
                for label in strengths.HIDDEN for n in numbers]
    if name == "poor":
        return [Case(name, label, n, motion=kind, hidden=() if label == "nothing" else (label,))
                for kind in ("one way", "one stroke", "short travel")
                for label in ("nothing", "offset", "coulomb-friction", "viscous-friction", "gravity", "hysteresis", "delay",
                              "ripple", "gear-ratio") for n in numbers]
    if name == "variant":
        return [Case(name, label, n, hidden=(label,), variant=variant)
                for variant in VARIANTS for label in strengths.HIDDEN for n in numbers]
    if name == "recorded":
        return [dataclasses.replace(case, study=name) for n in numbers for kind, count in RECORDED.items()
                for case in studies(kind, count, n * count) if not set(case.hidden) & set(strengths.FURTHER)]
    if name == "without":
        return [Case(name, label, n, hidden=(label,), without=label) for label in strengths.HIDDEN for n in numbers]
    raise SystemExit(f"there is no study '{name}'")
