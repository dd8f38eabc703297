# SPDX-License-Identifier: MIT
"""One case: a joint, the effects hidden in it, two logs, and the user's model or simulation.

Everything is drawn from the case's name, so that any case can be made again by itself. The joint and its motions are the same in
every form of the same label and number.
"""

import dataclasses
import functools
import json
import math
import zlib

import numpy as np

from . import catalogue, integrator, motions, plant, rough as rough_logs

FORMS = ("model", "simulated", "simulated_scale1")
COLUMN, SIMULATED_ANGLE = "tau_sim_nm", "q_sim_deg"
OUTSIDE = ("contact", "position-bump", "chirp-torque", "random-walk")
RATES = {500: 40.0, 1000: 30.0, 2000: 20.0}  # Hz: duration in s
LEAST_SIZE, MOST_SIZE = 1.0, 8.0  # rms of what is hidden, of the noise


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@dataclasses.dataclass
class Setting:
    """A joint with what is hidden in it, as drawn, and how its logs are recorded."""

    plant: plant.Plant
    hidden: list
    strengths: list
    sizes: list  # rms torque of each hidden effect, of the noise; None where that is no measure
    rate_hz: int
    memory: float  # of the noise, from one millisecond to the next
    velocity: str  # how the drive makes it
    kinds: tuple  # of motion, of the two logs
    soft: bool  # the gear

    def joint(self, with_hidden=True):
        p = dict(self.plant.parameters)
        for hidden, s in zip(self.hidden, self.strengths):
            hidden.prepare(p, s)
        for hidden, s in zip(self.hidden, self.strengths):
            if with_hidden:
                hidden.apply(p, s)
        return p


@dataclasses.dataclass(frozen=True)
class Case:
    form: str
    friction: str  # "friction": the simulation has that of the joint; "frictionless": it has none
    kind: str  # single, pair, null or outside
    label: str
    number: int
    rough: bool = False  # with a careless logger and, in half of the joints, a soft gear

    @property
    def name(self):
        return f"{'rough' if self.rough else 'dynamics'}-{self.form}-{self.friction}-{self.kind}-{self.label}-{self.number}"

    @property
    def labels(self):
        return tuple(self.label.split("+")) if self.kind in ("single", "pair") and self.label != "friction" else ()

    def rng(self, purpose):
        return np.random.default_rng([zlib.crc32(f"dynamics {self.kind} {self.label} {self.number} {purpose}".encode())])

    def setting(self):
        return _setting(self)

    def log(self, purpose):
        """(columns, noise-free torque, converter's limit) of the training or validation log."""
        setting, rng = self.setting(), self.rng(purpose)
        reference = _reference(setting, rng, setting.kinds[purpose == "validate"])
        p, rate = setting.joint(), setting.rate_hz
        if self.kind == "outside":
            _disturb(self.label, rng, self.rng("disturbance"), setting, p, reference)
        found = integrator.run(plant.finished(p | {"log_rate": rate}), reference)
        sensor = functools.reduce(dict.__or__, (h.sensor for h in setting.hidden), {})
        clean = found["torque"] + sensor.get("offset", 0.0)
        torque, limit = converted(clean + noise(rng, len(clean), setting, rate), sensor, rng, rate)
        step = 360 / 2**19
        angle = np.degrees(found["motor_angle"])
        if "eccentric_deg" in sensor:
            angle = angle + sensor["eccentric_deg"] * np.cos(found["motor_angle"] + sensor["eccentric_angle"])
        position = step * np.floor(angle / step + 0.5)
        speed = velocity(setting, rng, position, np.degrees(found["motor_speed"]), rate) + sensor.get("velocity_bias", 0.0)
        columns = {"time_s": np.arange(len(torque)) / rate, "velocity_deg_s": speed, "torque_nm": torque}
        if all(h.position for h in setting.hidden):
            columns["position_deg"] = position
        if self.form != "model":
            simulated = self.simulation(setting, reference)
            columns[COLUMN] = simulated["torque"]
            if "position_deg" in columns:  # else the tool would take it for the log's own
                columns[SIMULATED_ANGLE] = np.degrees(simulated["motor_angle"])
        if self.rough:
            columns = rough_logs.recorded(self.rng("logger " + purpose), columns, rate)
        return columns, clean, limit

    def simulation(self, setting, reference):
        """The user's simulation: the same joint along the same reference without what is hidden, and without quantization."""
        p = setting.joint(with_hidden=False) | {"encoder_step": 0.0, "log_rate": setting.rate_hz}
        if self.friction == "frictionless":
            p |= {"coulomb": 0.0, "viscous": 0.0, "stick": 0.0}
        if any(h.ripple_is_new for h in setting.hidden):
            p |= {"gauge": [], "mesh": []}
        return integrator.run(plant.finished(p), np.column_stack([reference[:, :3], np.zeros(len(reference))]))

    def given_ratio(self):
        return self.setting().plant.ratio * math.prod(h.given_ratio for h in self.setting().hidden)

    def model(self):
        """The user's model: every effect of the joint that is not hidden, its values left out."""
        setting = self.setting()
        known, stated = dict(setting.plant.known), {}
        for hidden, s in zip(setting.hidden, setting.strengths):
            known = {key: value for key, value in known.items() if key not in hidden.unknown}
            stated |= hidden.stated(s)
        entries = []
        for key in known:
            effect, _, order = key.partition(" ")
            entries.append({"effect": effect, **({"order": float(order)} if order else {}), **stated.get(key, {})})
        return {"schema": "ripplenotch/model/1", "gear_ratio": self.given_ratio(), "effects": entries}

    def options(self):
        """The options of `diagnose` that state model or simulation."""
        if self.form == "model":
            return ["--model", "base.json"]
        return ["--simulated", COLUMN + (",scale=1" if self.form == "simulated_scale1" else ""), "--gear-ratio", repr(self.given_ratio())]

    def right(self):
        """(required groups of names, names allowed as well)"""
        required, allowed, setting = [], [], self.setting()
        for hidden in setting.hidden:
            optional = hidden.optional_when_scaled and self.form == "simulated"
            allowed += [*hidden.allowed, *(name for group in hidden.required for name in group)]
            required += [] if optional else hidden.required
        if setting.soft and self.form == "model":  # no model of the form states how soft its gear is
            allowed += [("resonance", None)]
        if self.form != "model":
            if self.friction == "frictionless":
                required += [[("coulomb-friction", None)], [("viscous-friction", None)]]
            if any(h.ripple_is_new for h in setting.hidden):
                required += [[("ripple", 1.0)], [("ripple", 2.0)]]
        return required, allowed

    def truth(self, limit):
        """Values that the physics states: {(effect, order, parameter): value}."""
        values = {}
        if self.friction == "frictionless":
            p = self.setting().plant.parameters
            values = {("coulomb-friction", None, "torque_nm"): p["coulomb"],
                      ("viscous-friction", None, "coefficient_nm_per_deg_s"): p["viscous"] * math.pi / 180}
        for hidden, s in zip(self.setting().hidden, self.setting().strengths):
            values |= hidden.truth(s)
        if limit is not None:
            values["saturation", None, "limit_nm"] = limit
        return values

    def description(self):
        """What is hidden, for truth.json."""
        setting = self.setting()
        return {"case": self.name, "required": self.right()[0], "allowed": self.right()[1], "strengths": setting.strengths,
                "sizes_of_noise": setting.sizes, "noise_nm": setting.plant.noise_nm, "rate_hz": setting.rate_hz,
                "velocity": setting.velocity, "motions": setting.kinds, "parameters": plant.finished(setting.joint()),
                "sensor": [h.sensor for h in setting.hidden], "given_ratio": self.given_ratio()}

    def write(self, folder):
        """train.npy, validate.npy, base.json and truth.json; (logs, limit of the converter in the training log)."""
        logs, limit = {}, None
        for purpose in ("train", "validate"):
            columns, _, found = self.log(purpose)
            limit = found if purpose == "train" else limit
            rows = np.empty(len(columns["time_s"]), [(name, "<f8") for name in columns])
            for name, values in columns.items():
                rows[name] = values
            np.save(folder / f"{purpose}.npy", rows)
            logs[purpose] = columns
        (folder / "base.json").write_text(json.dumps(self.model()))
        (folder / "truth.json").write_text(json.dumps(self.description(), indent=2))
        return logs, limit


@functools.lru_cache(maxsize=4)
def _setting(case):
    rng = case.rng("joint")
    drawn = plant.drawn(rng, catalogue.gravity(case.labels))
    soft = case.rough and rough_logs.softened(case.rng("gear"), drawn)
    rate = int(rng.choice(list(RATES)))
    memory, velocity_kind = rng.uniform(0.0, 0.6), str(rng.choice(["noisy", "differenced", "filtered"]))
    kinds = tuple(str(kind) for kind in rng.permutation(catalogue.motions(case.labels))[:2])
    hidden = [catalogue.drawer(label)(rng, drawn) for label in case.labels]
    setting = Setting(drawn, hidden, [h.start for h in hidden], [None] * len(hidden), rate, memory, velocity_kind, kinds, soft)
    reference = _reference(setting, case.rng("train"), kinds[0])
    for k, h in enumerate(hidden):
        if h.sized:
            wanted = math.exp(rng.uniform(math.log(LEAST_SIZE), math.log(MOST_SIZE)))
            setting.strengths[k], setting.sizes[k] = _sized(drawn, h, reference, wanted)
    return setting


def _sized(drawn, hidden, reference, wanted):
    """(strength at which the rms of what is hidden is `wanted` times the noise, the size reached)."""
    s, size = hidden.start, 0.0
    for _ in range(6):
        p = dict(drawn.parameters)
        hidden.prepare(p, s)
        plain = integrator.run(plant.finished(p), reference)["torque"]
        hidden.apply(p, s)
        size = rms(integrator.run(plant.finished(p), reference)["torque"] - plain) / drawn.noise_nm
        if abs(size / wanted - 1) < 0.05 or (s >= hidden.most and size < wanted):
            break
        s = min(hidden.most, s * min(20.0, max(0.05, wanted / size)))
    return s, size


def _reference(setting, rng, kind):
    """The reference motion, with a column for an external torque. The same draws for training log and sizing."""
    half, acceleration = rng.uniform(110.0, 160.0), rng.uniform(150.0, 400.0)
    motion = motions.KINDS[kind](rng, RATES[setting.rate_hz], half, setting.plant.fastest_deg_s, acceleration)
    return np.column_stack([motion, np.zeros(len(motion))])


def noise(rng, count, setting, rate):
    """Noise of the torque, each value of which remembers a part of the one before."""
    memory = setting.memory ** (1000 / rate)
    fresh = rng.standard_normal(count + 200)
    weights = memory ** np.arange(200)
    return (setting.plant.noise_nm * np.sqrt(1 - memory**2)) * np.convolve(fresh, weights)[200 : 200 + count]


def velocity(setting, rng, position, speed, rate):
    """Velocity as drives log it: a tachometer's, the differenced encoder, or that after a low-pass."""
    if setting.velocity == "noisy":
        return speed + rng.uniform(0.05, 0.2) * rng.standard_normal(len(speed))
    found = np.diff(position, prepend=position[0]) * rate
    if setting.velocity == "filtered":
        keep = math.exp(-2 * math.pi * rng.uniform(120.0, 200.0) / rate)
        state, filtered = found[0], np.empty_like(found)
        for k, value in enumerate(found.tolist()):
            state = value + keep * (state - value)
            filtered[k] = state
        return filtered
    return found


def converted(torque, sensor, rng, rate):
    """(what the converter logs, its limit)"""
    limit = None
    if "limit_part" in sensor:
        limit = float(sensor["limit_part"] * np.quantile(np.abs(torque), 0.999))
        torque = np.clip(torque, -limit, limit)
    if "step" in sensor:
        torque = sensor["step"] * np.floor(torque / sensor["step"] + 0.5)
    for start in rng.choice(len(torque) - rate, sensor.get("held", 0), replace=False):
        length = int(rng.uniform(0.03, 0.12) * rate)
        torque[start : start + length] = torque[start]
    return torque, limit


def _disturb(label, rng, shared, setting, p, reference):
    """An external torque that is in no catalogue. shared draws the same for both logs."""
    size, count, rate = setting.plant.noise_nm, len(reference), integrator.CONTROLLER_RATE_HZ
    time = np.arange(count) / rate
    if label == "contact":  # for a while
        length, at = rng.uniform(0.3, 1.5), rng.uniform(0.15, 0.8) * count / rate
        share = np.clip((time - at) / length, 0.0, 1.0)
        reference[:, 3] = rng.choice([-1, 1]) * rng.uniform(10, 30) * size * np.sin(np.pi * share) ** 0.5
    elif label == "position-bump":  # a cable that is pressed
        p |= {"bump": shared.choice([-1, 1]) * shared.uniform(8, 20) * size, "bump_at": math.radians(shared.uniform(-60, 60)),
              "bump_width": math.radians(shared.uniform(3, 10))}
    elif label == "chirp-torque":
        length = rng.uniform(5, 10)
        s = time - rng.uniform(2, count / rate - length - 2)
        phase = 2 * np.pi * (2 * s + (13 / length) * s**2 / 2)
        reference[:, 3] = rng.uniform(3, 8) * size * np.sin(phase) * ((s > 0) & (s < length))
    else:
        walk = np.cumsum(rng.standard_normal(count))
        walk -= walk.mean()
        reference[:, 3] = rng.uniform(2, 5) * size * walk / walk.std()


def planned(first, seeds, forms, nulls, labels, rough=False):
    """Singles of the labels, pairs, nulls and disturbances in every form, with friction in the simulation and without."""
    numbers, found = range(first, first + seeds), []
    for form in forms:
        for friction in ("friction", "frictionless")[: 1 if form == "model" else 2]:
            singles = [*(["friction"] if friction == "frictionless" else []), *labels]
            found += [Case(form, friction, "single", label, n) for label in singles for n in numbers]
            found += [Case(form, friction, "pair", pair, n) for pair in catalogue.PAIRS for n in numbers]
        found += [Case(form, "friction", "null", "nothing", n) for n in range(first, first + nulls)]
        found += [Case(form, "friction", "outside", label, n) for label in OUTSIDE for n in numbers]
    return [dataclasses.replace(case, rough=rough) for case in found]
