# SPDX-License-Identifier: MIT
"""Truths whose formula is not the catalogue's. Each comes with the names that are right for it."""

import dataclasses
import math
from typing import Callable

import numpy as np

from . import joint


@dataclasses.dataclass(frozen=True)
class Other:
    """change(instants, truth, torque) gives the torque with it; finer: it integrates and needs steps below a sample."""

    change: Callable
    acceptable: tuple
    finer: bool = False

    def __call__(self, instants, truth, torque):
        return self.change(instants, truth, torque)


def lugre(rng):
    """LuGre friction (Canudas de Wit et al., 1995), integrated with the speed taken constant along each sample."""
    level, extra, slow = rng.uniform(0.4, 0.8), rng.uniform(0.2, 0.5), rng.uniform(8.0, 20.0)
    stiffness, viscous = 1.0 / rng.uniform(0.3, 1.5), rng.uniform(0.0, 0.002)

    def change(x, truth, torque):
        limit = level + extra * np.exp(-((x.v / slow) ** 2))
        z, result = 0.0, np.empty(len(x.v))
        step = x.t[1] - x.t[0]
        for k, (v, most) in enumerate(zip(x.v.tolist(), limit.tolist())):
            if v:
                end = math.copysign(most, v)
                z = end + (z - end) * math.exp(-abs(v) * step * stiffness / most)
            result[k] = z
        return torque + result + viscous * x.v

    return Other(change, ("coulomb-friction", "stribeck-friction", "hysteresis", "viscous-friction"))


def maxwell_slip(rng):
    """Four springs, each of which slips at its own deflection."""
    deflections, levels = rng.uniform(0.4, 12.0, 4), rng.uniform(0.1, 0.35, 4)

    def change(x, truth, torque):
        total, steps = np.zeros(len(x.q)), np.diff(x.q, prepend=x.q[0]).tolist()
        for most, level in zip(deflections.tolist(), levels.tolist()):
            deflection = 0.0
            for k, step in enumerate(steps):
                deflection = min(most, max(-most, deflection + step))
                total[k] += level * deflection / most
        return torque + total

    return Other(change, ("hysteresis", "coulomb-friction"))


def second_order_lag(rng):
    """A Butterworth low-pass of second order over the whole torque."""
    hertz = rng.uniform(20.0, 60.0)

    def change(x, truth, torque):
        return joint.oscillator(torque, x.t[1] - x.t[0], hertz, math.sqrt(0.5))

    return Other(change, ("sensor-lowpass", "lag", "delay", "resonance"), finer=True)


def two_masses(rng):
    """The ripple is a kinematic error that drives a mass on a damped spring, transients included."""
    hertz, damping = rng.uniform(30.0, 70.0), rng.uniform(0.05, 0.15)

    def change(x, truth, torque):
        ripple = sum(joint.ripple(x, e, truth) for e in truth if e["effect"] == "ripple")
        return torque - ripple + joint.oscillator(ripple, x.t[1] - x.t[0], hertz, damping)

    return Other(change, ("resonance",), finer=True)


def asymmetric_coulomb(rng):
    """Friction of another size in each direction."""
    forth, back = rng.uniform(0.5, 1.0), rng.uniform(0.2, 0.45)

    def change(x, truth, torque):
        return torque + np.where(x.v > 0, forth, back) * np.tanh(x.v / 0.2)

    return Other(change, ("coulomb-friction", "asymmetric-friction", "offset"))


def begun_in_the_loop(rng):
    """Hysteresis of a joint that was moved before the log began."""
    level, width, state = rng.uniform(0.5, 1.2), rng.uniform(1.0, 8.0), rng.choice([-1.0, 1.0])

    def change(x, truth, torque):
        return torque + joint.hysteresis(x, {"torque_nm": level, "width_deg": width, "initial_state": state})

    return Other(change, ("hysteresis", "coulomb-friction"))


OTHERS = {
    "LuGre friction": lugre,
    "Maxwell slip, 4 elements": maxwell_slip,
    "low-pass of second order": second_order_lag,
    "two masses and a spring": two_masses,
    "asymmetric Coulomb friction": asymmetric_coulomb,
    "hysteresis begun in the loop": begun_in_the_loop,
}
