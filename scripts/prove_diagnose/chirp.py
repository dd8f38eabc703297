# SPDX-License-Identifier: MIT
"""One joint behind a harmonic drive of 20:1 that follows a chirp of 0.1 to 8 Hz, logged at 1 kHz: in it a resonance, a delay, or nothing.

It is the joint of an issue that another tool's users filed (leggedrobotics/pace-sim2real, number 19), where a fit that knew of no
resonance told it as a delay of 9.5 ms. The joint comes from its physics, not from a formula of the catalogue: motor under a position
controller, spring, link with Coulomb and viscous friction, torque of the gear's mesh. What is logged is the motor's angle and speed, and
the torque of strain gauges on the spring. The user's model is the rigid joint: inertia, both frictions and ripple of orders 1 and 2, all
to be fitted. In logs of a delay or of nothing the joint is rigid, and the torque of the delay is that of an earlier time.
"""

import dataclasses
import json
import math
import pathlib
import shutil
import tempfile
import zlib

import numpy as np

import page_tables

from . import bars, cases, joint, score, sensor, table, tool

RATIO = 20.0
SECONDS, LOWEST_HZ, HIGHEST_HZ = 40.0, 0.1, 8.0
ORDERS = (1, 2)
KINDS = ("resonance", "delay", "nothing")
OPTIONS = ("--smoothing", "10ms")  # keeps components up to 40 Hz, where the highest mode drawn is (docs/commands/simulate.md)


class Chirp:
    """amplitude sin(phase), the frequency from the lowest to the highest in proportion to time, or by equal ratios."""

    duration_s = SECONDS

    def __init__(self, amplitude_deg, middle_deg, even):
        self.amplitude, self.middle, self.even = amplitude_deg, middle_deg, even

    def at(self, time_s):
        """Angle (deg), speed (deg/s) and acceleration (deg/s2) at each time."""
        t = np.asarray(time_s)
        rise = (HIGHEST_HZ - LOWEST_HZ) / SECONDS
        hertz, slope, cycles = LOWEST_HZ + rise * t, np.full_like(t, rise), LOWEST_HZ * t + rise * t**2 / 2
        if not self.even:
            rate = math.log(HIGHEST_HZ / LOWEST_HZ) / SECONDS
            hertz = LOWEST_HZ * np.exp(rate * t)
            slope, cycles = rate * hertz, (hertz - LOWEST_HZ) / rate
        phase, turn = 2 * np.pi * cycles, 2 * np.pi * hertz
        angle = self.amplitude * np.sin(phase)
        return (self.middle + angle, self.amplitude * turn * np.cos(phase),
                self.amplitude * 2 * np.pi * slope * np.cos(phase) - turn**2 * angle)


@dataclasses.dataclass(frozen=True)
class Joint:
    """What is drawn of a joint, the same for its two logs."""

    inertia: float
    coulomb: float
    viscous: float  # Nm per rad/s
    ripple: tuple  # (amplitude Nm, order, phase) of the mesh
    mode_hz: float  # of the link on its spring, the motor held
    damping: float
    motor: float  # its inertia, of the link's
    loop_hz: float  # of the controller
    delay_s: float
    noise_nm: float
    amplitude_deg: float

    def mesh(self, angle):
        return sum(size * math.cos(order * RATIO * angle + phase) for size, order, phase in self.ripple)


def drawn(rng):
    inertia = rng.uniform(0.05, 0.2)
    return Joint(inertia=inertia, coulomb=rng.uniform(0.05, 0.3), viscous=rng.uniform(0.01, 0.1),
                 ripple=tuple((rng.uniform(0.1, 0.4), order, rng.uniform(-np.pi, np.pi)) for order in ORDERS),
                 mode_hz=rng.uniform(10.0, 40.0), damping=rng.uniform(0.03, 0.2), motor=rng.uniform(2.0, 6.0),
                 loop_hz=rng.uniform(6.0, 20.0), delay_s=rng.uniform(0.002, 0.010), noise_nm=rng.uniform(0.03, 0.15),
                 amplitude_deg=rng.uniform(2.0, 8.0))


def rigid_model(of):
    """What the user knows: that the joint is rigid and has friction and ripple; every size is to be fitted."""
    return {"schema": "ripplenotch/model/1", "gear_ratio": RATIO,
            "effects": [{"effect": "inertia"}, {"effect": "coulomb-friction", "width_deg_s": 0.2},
                        {"effect": "viscous-friction"},
                        *({"effect": "ripple", "order": order} for order in ORDERS)]}


def elastic(of, travel, time):
    """(torque Nm, angle deg, speed deg/s of the motor on the output side), integrated at 8 kHz, speeds before angles."""
    step = (time[1] - time[0]) / joint.SUBSTEPS
    times = time[0] + np.arange((len(time) - 1) * joint.SUBSTEPS + 1) * step
    wanted = [np.radians(column).tolist() for column in travel.at(times)]
    omega, motor = 2 * math.pi * of.mode_hz, of.motor * of.inertia
    stiffness, rub = of.inertia * omega**2, 2 * of.damping * omega * of.inertia
    loop, whole = 2 * math.pi * of.loop_hz, motor + of.inertia
    hold, brake = whole * loop**2, 1.6 * whole * loop
    slow = math.radians(0.2)
    angle, speed = far, far_speed = wanted[0][0], wanted[1][0]
    rows = []
    for q, v, a in zip(*wanted):
        twist = stiffness * (angle - far)  # what strain gauges see
        spring = twist + rub * (speed - far_speed)
        rows.append((twist, angle, speed))
        against = of.coulomb * math.tanh(far_speed / slow) + of.viscous * far_speed + of.mesh(far)
        speed += step * (hold * (q - angle) + brake * (v - speed) + whole * a - spring) / motor
        far_speed += step * (spring - against) / of.inertia
        angle += step * speed
        far += step * far_speed
    torque, angle, speed = np.array(rows[:: joint.SUBSTEPS]).T
    return torque, np.degrees(angle), np.degrees(speed)


def rigid(of, travel, time, delay_s):
    q, v, a = (np.radians(column) for column in travel.at(time - delay_s))
    mesh = sum(size * np.cos(order * RATIO * q + phase) for size, order, phase in of.ripple)
    torque = of.inertia * a + of.coulomb * np.tanh(v / math.radians(0.2)) + of.viscous * v + mesh
    return torque, *travel.at(time)[:2]


@dataclasses.dataclass(frozen=True)
class Case:
    label: str
    number: int

    @property
    def name(self):
        return f"chirp-{self.label}-{self.number}"

    def rng(self, purpose):
        return np.random.default_rng([zlib.crc32(f"{self.name} {purpose}".encode())])

    def log(self, purpose):
        of, rng = drawn(self.rng("joint")), self.rng(purpose)
        travel = Chirp(of.amplitude_deg * rng.uniform(0.7, 1.3), rng.uniform(-90.0, 90.0), bool(rng.integers(2)))
        time = np.arange(round(SECONDS * cases.SAMPLE_RATE_HZ)) / cases.SAMPLE_RATE_HZ
        torque, q, v = elastic(of, travel, time) if self.label == "resonance" else \
            rigid(of, travel, time, of.delay_s if self.label == "delay" else 0.0)
        noise = sensor.noise(rng, "white", len(time), of.noise_nm)
        v = v + 0.15 * rng.standard_normal(len(time))
        return cases.Log(time, v, torque + noise, np.round(q * 2**19 / 360) * 360 / 2**19, of.noise_nm, None)


def chosen(first, seeds):
    return [Case(label, number) for number in range(first, first + seeds) for label in KINDS]


def trial(program, case, keep=None):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="prove-chirp-"))
    of = drawn(case.rng("joint"))
    row = {"study": "chirp", "case": case.name, "label": case.label, "joint": dataclasses.asdict(of)}
    try:
        (folder / "base.json").write_text(json.dumps(rigid_model(of)))
        (folder / "truth.json").write_text(json.dumps(row["joint"], indent=2))
        for purpose in ("train", "validate"):
            case.log(purpose).save(folder / f"{purpose}.npy")
        found, row["seconds"] = tool.diagnose(program, folder, OPTIONS)
        keys = score.named_keys(found)
        named = {effect for effect, _ in keys}
        right = set() if case.label == "nothing" else {case.label}
        row.update(verdict=found["verdict"], named=score.words(keys), false=sorted(named - right), right=right <= named,
                   exact=named == right, offered=sorted(score.undecided_names(found)), gap=found["gap"])
    except (tool.ToolFailed, KeyError, ValueError) as failure:
        row.update(error=f"{type(failure).__name__}: {failure}", named=["no answer"], false=[], right=False, exact=False)
    if keep and not row["exact"]:
        shutil.rmtree(keep / case.name, ignore_errors=True)
        shutil.copytree(folder, keep / case.name)
    shutil.rmtree(folder)
    return row


ASKED = {"resonance": "`resonance`, and not `delay`", "delay": "`delay`, and not `resonance`", "nothing": "no name"}


def told_right(row):
    """The right one of the two that are mistaken for each other."""
    named = set(row["named"])
    return not named if row["label"] == "nothing" else row["right"] and not named & (set(KINDS) - {row["label"]})


def line(kind, rows):
    joints = [row["joint"] for row in rows]
    span = {"resonance": ("mode_hz", "Hz", 1), "delay": ("delay_s", "ms", 1e3)}.get(kind)
    drawn_from = f"{span[2] * min(j[span[0]] for j in joints):.1f} to {span[2] * max(j[span[0]] for j in joints):.1f} {span[1]}" if span else "-"
    return [kind, drawn_from, str(len(rows)), *(table.share(rows, test) for test in (
        told_right, lambda r: r["exact"], lambda r: r["false"], lambda r: r.get("verdict") == "explained")),
        table.median([row.get("seconds") for row in rows], "{:.1f} s")]


def blocks(about, rows):
    groups = {kind: of for kind in KINDS if (of := [row for row in rows if row["label"] == kind])}
    asked = bars.shown("diagnose-physics-chirp-criteria", [
        bars.line(f"{kind} in the joint: {ASKED[kind]}", "98 of 100", [told_right(row) for row in of], 0.98) for kind, of in groups.items()])
    head = ["in the joint", "range", "logs", "resonance and delay distinguished", "exactly right", "any false name", "explained", "time"]
    wrong = [
        f"{row['case']} ({row['joint']['mode_hz']:.1f} Hz, damping {row['joint']['damping']:.2f}, {1e3 * row['joint']['delay_s']:.1f} ms): "
        f"named {', '.join(row['named']) or 'nothing'}{', undecided ' + ', '.join(row['offered']) if row.get('offered') else ''}; "
        f"{row.get('verdict', row.get('error'))}" for row in rows if not row["exact"]]
    return {"chirp": table.joined(about, asked, page_tables.detail("diagnose-physics-chirp", "All columns", table.markdown(head, [line(kind, of) for kind, of in groups.items()])),
                                  table.listed("diagnose-physics-chirp-wrong", "Cases that are not exactly right", wrong))}
