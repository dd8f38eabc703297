# SPDX-License-Identifier: MIT
"""The torque of a joint with the effects of the catalogue, from their formulas in docs/effects.

A truth is a list of effects as in model.json: {"effect": name, parameter: value, ...}. Written independently of the
tool: motion is exact at every instant, a delay is the motion of an earlier time, a lag is integrated at 8 kHz.
"""

import math

import numpy as np

SUBSTEPS = 8  # of a sample, where a differential equation is integrated


class Instants:
    """The motion at the times asked for, and what the effects of a model share there."""

    def __init__(self, time_s, motion, truth, gear_ratio):
        self.t = time_s
        self.q, self.v, self.a = motion.at(time_s)
        self.rad = np.radians(self.q)
        self.gear_ratio = gear_ratio
        self.load = np.abs(sum((TORQUES[e["effect"]](self, e) for e in truth if e["effect"] in ("inertia", "gravity")),
                               np.zeros_like(self.t)))


def named(truth, name):
    return [effect for effect in truth if effect["effect"] == name]


def direction(v, width):
    return np.tanh(v / width)


def ripple(x, e, truth):
    gain = np.ones(len(x.t), complex)
    for other in truth:
        if other["effect"] in RIPPLE_GAINS and other.get("order", 0) in (0, e["order"]):
            gain = gain * RIPPLE_GAINS[other["effect"]](x, other, e["order"])
    phase = e["order"] * x.gear_ratio * x.rad + math.radians(e["phase_deg"])
    return np.real(e["amplitude_nm"] * gain * np.exp(1j * phase))


def hysteresis(x, e):
    """Dahl's equation, exact along each step of the angle; the state rests below 0.5 deg/s."""
    state, sign = e.get("initial_state", 0.0), 0.0
    decay = np.exp(-np.abs(np.diff(x.q, prepend=x.q[0])) / e["width_deg"]).tolist()
    states = np.empty(len(x.t))
    for k, v in enumerate(x.v.tolist()):
        if abs(v) > 0.5:
            sign = math.copysign(1.0, v)
        state = sign + (state - sign) * decay[k] if sign else state
        states[k] = state
    return e["torque_nm"] * states


def ringing(x, e):
    moving, total = abs(x.v[0]) > 1.0, np.zeros_like(x.t)
    speeds = np.abs(x.v)
    for k in range(1, len(x.t)):
        event = 0.0
        if not moving and speeds[k] > 1.0:
            moving, event, sense = True, 1.0, math.copysign(1.0, x.v[k])
        elif moving and speeds[k] < 0.5:
            moving, event = False, -1.0
            sense = math.copysign(1.0, x.v[k - 1])
        if event:
            since = x.t[k:] - x.t[k]
            total[k:] += (event * sense * e["amplitude_nm"] * np.exp(-since / e["decay_s"])
                          * np.cos(2 * np.pi * e["frequency_hz"] * since + math.radians(e["phase_deg"])))
    return total


def wave(amplitude, cycles, phase_deg):
    return amplitude * np.cos(2 * np.pi * cycles + math.radians(phase_deg))


def drift(x, e):
    constant = e["time_constant_s"]
    return -e["rate_nm_s"] * constant * np.expm1(-np.maximum(x.t, 0.0) / constant)


TORQUES = {
    "inertia": lambda x, e: e["inertia_kgm2"] * np.radians(x.a),
    "offset": lambda x, e: np.full_like(x.t, e["torque_nm"]),
    "drift": drift,
    "gravity": lambda x, e: wave(e["amplitude_nm"], x.q / 360.0, e["phase_deg"]),
    "coulomb-friction": lambda x, e: e["torque_nm"] * direction(x.v, e["width_deg_s"]),
    "viscous-friction": lambda x, e: e["coefficient_nm_per_deg_s"] * x.v,
    "quadratic-viscous-friction": lambda x, e: e["coefficient_nm_per_deg2_s2"] * x.v * np.abs(x.v),
    "stribeck-friction": lambda x, e: (e["torque_nm"] * direction(x.v, 0.2)
                                       * np.exp(-((x.v / e["stribeck_speed_deg_s"]) ** 2))),
    "load-friction": lambda x, e: e["torque_nm"] * x.load ** e["exponent"] * direction(x.v, 0.2),
    "hysteresis": hysteresis,
    "start-stop-ringing": ringing,
    "output-ripple": lambda x, e: wave(e["amplitude_nm"], e["order"] * x.q / 360.0, e["phase_deg"]),
    "tone": lambda x, e: wave(e["amplitude_nm"], e["frequency_hz"] * x.t, e["phase_deg"]),
}


def modulation(x, e, _):
    return 1 + wave(e["depth_percent"] / 100, e["output_order"] * x.q / 360, e["phase_deg"])


def resonance(x, e, order):
    u = order * x.gear_ratio * x.v / 360 / e["frequency_hz"]
    return 1 / (1 - u**2 + 2j * e["damping"] * u)


def by_direction(x, e, _):
    sense = direction(x.v, 0.2)
    return (1 + e["gain_percent"] / 100 * sense) * np.exp(1j * np.radians(e["phase_deg"]) * sense)


RIPPLE_GAINS = {
    "ripple-speed-dependence": lambda x, e, _: 1 + e["gain_percent"] / 100 * (np.abs(x.v) / 100) ** e["exponent"],
    "ripple-load-dependence": lambda x, e, _: 1 + e["gain_percent_per_nm"] / 100 * x.load,
    "ripple-direction-dependence": by_direction,
    "ripple-modulation": modulation,
    "resonance": resonance,
}


def first_order(values, step_s, time_constant_s):
    """tau dy/dt + y = x by the trapezoidal rule, settled at the start."""
    r = step_s / (2 * time_constant_s)
    forward, back = r / (1 + r), (1 - r) / (1 + r)
    result, y, last = [], values[0], values[0]
    for x in values.tolist():
        y = back * y + forward * (x + last)
        last = x
        result.append(y)
    return np.array(result)


def sum_of_torques(x, truth):
    total = np.zeros_like(x.t)
    for e in truth:
        if e["effect"] == "ripple":
            total += ripple(x, e, truth)
        elif e["effect"] in TORQUES:
            total += TORQUES[e["effect"]](x, e)
    return total


def torque(motion, truth, gear_ratio, time_s, other=None):
    """What reaches the converter without noise. other: a truth that is not in the catalogue (other_formulas)."""
    for e in named(truth, "gear-ratio"):
        gear_ratio *= 1 + e["error_percent"] / 100
    late = sum(e["delay_s"] for e in named(truth, "delay"))
    lags = [e["time_constant_s"] for e in named(truth, "lag")]
    step, finer = time_s[1] - time_s[0], SUBSTEPS if lags or (other and other.finer) else 1
    times = time_s[0] + np.arange((len(time_s) - 1) * finer + 1) * step / finer - late
    x = Instants(times, motion, truth, gear_ratio)
    total = sum_of_torques(x, truth)
    if other:
        total = other(x, truth, total)
    for constant in lags:
        total = first_order(total, step / finer, constant)
    return total[::finer]
