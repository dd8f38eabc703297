# SPDX-License-Identifier: MIT
"""The simulated joint before anything is hidden in it: masses, stiffness, controller, friction, ripple."""

import dataclasses
import math

RATIOS = (50, 80, 100, 101, 120, 160)
MODE_HZ = (80.0, 120.0)  # of the link on the flexspline, the motor held: above whatever the motion excites


@dataclasses.dataclass
class Plant:
    """parameters: of joint.cpp. known: the effects that a complete model of it lists, by key, with values that are stated."""

    parameters: dict
    known: dict
    ratio: float
    fastest_deg_s: float
    noise_nm: float

    @property
    def gravity(self):
        return self.parameters["weight"] != 0


def spring(parameters, mode_hz, damping=0.08):
    """Stiffness for a mode of the link; a tenth more of it at 2 mrad of torsion; damping as a part of the critical."""
    omega = 2 * math.pi * mode_hz
    stiffness = parameters["link_inertia"] * omega**2
    return {"stiffness": stiffness, "cubic": 0.1 * stiffness / 4e-6, "damping": 2 * damping * parameters["link_inertia"] * omega}


def controller(parameters, loop_hz):
    """Gains for a bandwidth of the rigid joint."""
    whole, loop = parameters["motor_inertia"] + parameters["link_inertia"], 2 * math.pi * loop_hz
    return {"kp": whole * loop**2, "kv": 1.6 * whole * loop, "ki": whole * loop**3 / 6, "velocity_filter": 0.4}


def drawn(rng, gravity=None):
    """A joint; gravity: whether its axis is level (None: even odds)."""
    ratio = float(rng.choice(RATIOS))
    noise = rng.uniform(0.03, 0.07)
    fastest = rng.uniform(0.6, 1.1) * 90.0 * min(1.6, max(0.7, 100 / ratio))
    level = rng.random() < 0.5 if gravity is None else gravity
    inertia = rng.uniform(0.15, 0.5)
    p = {"ratio": ratio, "link_inertia": inertia, "motor_inertia": inertia * rng.uniform(3.0, 8.0),
         "weight": rng.uniform(4.0, 12.0) * rng.choice([-1, 1]) if level else 0.0,
         "weight_angle": rng.uniform(-math.pi, math.pi), "encoder_step": 2 * math.pi / (2**17 * ratio)}
    p |= spring(p, rng.uniform(*MODE_HZ)) | controller(p, rng.uniform(8.0, 14.0))
    p |= {"known_inertia": inertia, "known_weight": p["weight"]}
    coulomb = rng.uniform(4.0, 9.0) * noise
    p |= {"coulomb": coulomb, "bristle_width": math.radians(rng.uniform(0.0008, 0.0015)), "creep": math.radians(rng.uniform(0.3, 0.8)),
          "viscous": rng.uniform(3.0, 7.0) * noise / math.radians(fastest),
          "motor_coulomb": rng.uniform(0.05, 0.3), "motor_bristle": 1e4, "motor_viscous": rng.uniform(0.1, 0.5)}
    p["gauge"] = [(n, rng.uniform(2.5, 8.0) * noise, rng.uniform(-math.pi, math.pi)) for n in (1, 2)]
    known = {"inertia": {}, "coulomb-friction": {}, "viscous-friction": {}, "ripple 1": {}, "ripple 2": {}}
    if level:
        known["gravity"] = {}
    return Plant(p, known, ratio, fastest, noise)


def finished(parameters):
    """The parameters as joint.cpp takes them: bristles are as stiff as their friction is large."""
    level = parameters["coulomb"] + parameters.get("stick", 0.0) + parameters.get("friction_by_load", 0.0)
    return {**parameters, "bristle": max(level, 1e-3) / parameters["bristle_width"]}
