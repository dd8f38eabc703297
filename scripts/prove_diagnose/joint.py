# SPDX-License-Identifier: MIT
"""The effects of the catalogue, from their formulas in docs/effects: the torque of a joint with them, and how strong each
is drawn. A new effect of the joint has its formula and its strength here, and nothing elsewhere.

A truth is a list of effects as in model.json: {"effect": name, parameter: value, ...}. Written independently of the
tool: motion is exact at every instant, a delay is the motion of an earlier time, lag and resonance are integrated at 8 kHz.
"""

import math

import numpy as np

GEAR_RATIO = 100
TORQUE_NOISE_NM = 0.06
VELOCITY_NOISE_DEG_S = 0.15
SUBSTEPS = 8  # of a sample, where a differential equation is integrated
LOADS = ("inertia", "gravity", "payload-change")  # what gear and bearings carry


class Instants:
    """The motion at the times asked for, and what the effects of a model share there."""

    def __init__(self, time_s, motion, truth, gear_ratio):
        self.t = time_s
        self.q, self.v, self.a = motion.at(time_s)
        self.rad = np.radians(self.q)
        self.gear_ratio = gear_ratio
        self.load = np.abs(sum((TORQUES[e["effect"]](self, e) for e in truth if e["effect"] in LOADS),
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
    torque = np.real(e["amplitude_nm"] * gain * np.exp(1j * phase))
    for spring in named(truth, "resonance"):  # the generator draws those of all orders
        torque = oscillator(torque, x.t[1] - x.t[0], spring["frequency_hz"], spring["damping"])
    return torque


def oscillator(values, step_s, hertz, damping):
    """y'' + 2 z w y' + w^2 y = w^2 x by the trapezoidal rule, exact at the oscillator's own frequency, settled at the start."""
    c = 1.0 / math.tan(math.pi * hertz * step_s)
    a0, a1, a2 = c * c + 2 * damping * c + 1, 2 - 2 * c * c, c * c - 2 * damping * c + 1
    y1 = y2 = x1 = x2 = float(values[0])
    result = []
    for x in values.tolist():
        y = (x + 2 * x1 + x2 - a1 * y1 - a2 * y2) / a0
        x1, x2, y1, y2 = x, x1, y, y1
        result.append(y)
    return np.array(result)


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


def backlash(x, e):
    """The play operator: the state moves by 2 across the play and stops at the flanks."""
    state, states = e.get("initial_state", 0.0), np.empty(len(x.t))
    for k, step in enumerate((2.0 * np.diff(x.q, prepend=x.q[0]) / e["width_deg"]).tolist()):
        state = min(max(state + step, -1.0), 1.0)
        states[k] = state
    return e["torque_nm"] * states**3


def payload(x, e):
    """From time_s on there is another inertia and another weight."""
    there = 0.5 * (1.0 + np.tanh((x.t - e["time_s"]) / e.get("ramp_s", 0.05)))
    return there * (e["inertia_kgm2"] * np.radians(x.a) + e["cosine_nm"] * np.cos(x.rad) + e["sine_nm"] * np.sin(x.rad))


def warm_up(x, e):
    return e["change_nm"] * np.exp(-np.maximum(x.t, 0.0) / e["time_constant_s"]) * direction(x.v, 0.2)


def ringing(x, e):
    turn = np.exp((2j * np.pi * e["frequency_hz"] - 1 / e["decay_s"]) * (x.t[1] - x.t[0]))
    states, state = np.zeros(len(x.t), complex), 0j
    for k, change in enumerate(np.diff(x.a), 1):
        state = state * turn + change / 100
        states[k] = state
    return e["amplitude_nm"] * (states * np.exp(1j * math.radians(e["phase_deg"]))).real


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
    "payload-change": payload,
    "coulomb-friction": lambda x, e: e["torque_nm"] * direction(x.v, e["width_deg_s"]),
    "asymmetric-friction": lambda x, e: e["difference_nm"] / 2 * direction(x.v, 0.2) ** 2,
    "viscous-friction": lambda x, e: e["coefficient_nm_per_deg_s"] * x.v,
    "asymmetric-viscous-friction": lambda x, e: e["difference_nm_per_deg_s"] / 2 * np.abs(x.v),
    "quadratic-viscous-friction": lambda x, e: e["coefficient_nm_per_deg2_s2"] * x.v * np.abs(x.v),
    "stribeck-friction": lambda x, e: (e["torque_nm"] * direction(x.v, 0.2)
                                       * np.exp(-((x.v / e["stribeck_speed_deg_s"]) ** 2))),
    "load-friction": lambda x, e: e["torque_nm"] * x.load ** e["exponent"] * direction(x.v, 0.2),
    "position-dependent-friction": lambda x, e: (wave(e["amplitude_nm"], e["order"] * x.q / 360.0, e["phase_deg"])
                                                 * direction(x.v, 0.2)),
    "friction-warm-up": warm_up,
    "hysteresis": hysteresis,
    "backlash": backlash,
    "start-stop-ringing": ringing,
    "output-ripple": lambda x, e: wave(e["amplitude_nm"], e["order"] * x.q / 360.0, e["phase_deg"]),
    "tone": lambda x, e: wave(e["amplitude_nm"], e["frequency_hz"] * x.t, e["phase_deg"]),
}


def modulation(x, e, _):
    return 1 + wave(e["depth_percent"] / 100, e["output_order"] * x.q / 360, e["phase_deg"])


def by_direction(x, e, _):
    sense = direction(x.v, 0.2)
    return (1 + e["gain_percent"] / 100 * sense) * np.exp(1j * np.radians(e["phase_deg"]) * sense)


RIPPLE_GAINS = {
    "ripple-speed-dependence": lambda x, e, _: 1 + e["gain_percent"] / 100 * (np.abs(x.v) / 100) ** e["exponent"],
    "ripple-load-dependence": lambda x, e, _: 1 + e["gain_percent_per_nm"] / 100 * x.load,
    "ripple-direction-dependence": by_direction,
    "ripple-modulation": modulation,
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


def torque(motion, truth, gear_ratio, time_s):
    """What reaches the converter without noise."""
    for e in named(truth, "gear-ratio"):
        gear_ratio *= 1 + e["error_percent"] / 100
    late = sum(e["delay_s"] for e in named(truth, "delay"))
    lags = [e["time_constant_s"] for e in named(truth, "lag")]
    cutoffs = [e["cutoff_hz"] for e in named(truth, "sensor-lowpass")]
    integrated = lags or cutoffs or named(truth, "resonance")
    step, finer = time_s[1] - time_s[0], SUBSTEPS if integrated else 1
    times = time_s[0] + np.arange((len(time_s) - 1) * finer + 1) * step / finer - late
    x = Instants(times, motion, truth, gear_ratio)
    total = sum_of_torques(x, truth)
    for constant in lags:
        total = first_order(total, step / finer, constant)
    for cutoff in cutoffs:
        total = oscillator(total, step / finer, cutoff, math.sqrt(0.5))
    return total[::finer]


def seen(q, v, truth):
    """Angle and speed as the log has them: those of an encoder that errs, and a speed that is off by a constant."""
    for e in named(truth, "encoder-eccentricity"):
        true = q
        for _ in range(8):  # the error goes with the angle that is shown
            phase = np.radians(e["order"] * q + e["phase_deg"])
            q = true + e["amplitude_deg"] * np.cos(phase)
        steep = e["amplitude_deg"] * np.radians(e["order"]) * np.sin(np.radians(e["order"] * q + e["phase_deg"]))
        v = v / (1.0 + steep)
    return q, v + sum(e["bias_deg_s"] for e in named(truth, "velocity-bias"))


def turn(rng):
    return rng.uniform(-180.0, 180.0)


def sign(rng):
    return rng.choice([-1.0, 1.0])


def effect(name, **parameters):
    return {"effect": name, **{key: value.item() if hasattr(value, "item") else value
                               for key, value in parameters.items()}}


# Singles, pairs and triples are drawn from these.
HIDDEN = {
    "offset": lambda r: effect("offset", torque_nm=sign(r) * r.uniform(0.15, 0.8)),
    "drift": lambda r: effect("drift", rate_nm_s=sign(r) * r.uniform(0.015, 0.05), time_constant_s=r.choice([20.0, 60.0, 1e6])),
    "gravity": lambda r: effect("gravity", amplitude_nm=r.uniform(0.6, 4.0), phase_deg=turn(r)),
    "coulomb-friction": lambda r: effect("coulomb-friction", torque_nm=r.uniform(0.2, 1.0), width_deg_s=r.uniform(0.1, 0.5)),
    "viscous-friction": lambda r: effect("viscous-friction", coefficient_nm_per_deg_s=r.uniform(0.002, 0.008)),
    "stribeck-friction": lambda r: effect("stribeck-friction", torque_nm=r.uniform(0.5, 1.2), stribeck_speed_deg_s=r.uniform(8.0, 20.0)),
    "ripple": lambda r: effect("ripple", order=int(r.choice([3, 4, 6])), amplitude_nm=r.uniform(0.1, 0.4), phase_deg=turn(r)),
    "output-ripple": lambda r: effect("output-ripple", order=int(r.choice([2, 3])), amplitude_nm=r.uniform(0.3, 0.8), phase_deg=turn(r)),
    "tone": lambda r: effect("tone", frequency_hz=r.choice([50.0, 60.0, 100.0, r.uniform(8.0, 200.0)]),
                             amplitude_nm=r.uniform(0.08, 0.3), phase_deg=turn(r)),
    "ripple-speed-dependence": lambda r: effect("ripple-speed-dependence", gain_percent=r.uniform(30.0, 60.0), exponent=r.uniform(0.7, 1.5)),
    "ripple-load-dependence": lambda r: effect("ripple-load-dependence", gain_percent_per_nm=r.uniform(15.0, 30.0)),
    "ripple-modulation": lambda r: effect("ripple-modulation", output_order=int(r.choice([1, 2, 3])), depth_percent=r.uniform(30.0, 60.0), phase_deg=turn(r)),
    "resonance": lambda r: effect("resonance", frequency_hz=r.uniform(30.0, 70.0), damping=r.uniform(0.05, 0.15)),
    "hysteresis": lambda r: effect("hysteresis", torque_nm=r.uniform(0.5, 1.2), width_deg=r.uniform(1.0, 8.0)),
    "delay": lambda r: effect("delay", delay_s=r.uniform(0.004, 0.012)),
    "lag": lambda r: effect("lag", time_constant_s=1.0 / (2.0 * np.pi * r.uniform(12.0, 30.0))),
    "saturation": lambda r: effect("saturation", limit_nm=r.uniform(1.0, 1.5)),
    "quantization": lambda r: effect("quantization", step_nm=r.uniform(0.3, 0.6)),
    "spikes": lambda r: effect("spikes", rate_percent=r.uniform(0.05, 0.2), size_nm=r.uniform(4.0, 9.0)),
    "dropout": lambda r: effect("dropout", held=int(r.integers(12, 26)), milliseconds=[40.0, 160.0]),
    "gear-ratio": lambda r: effect("gear-ratio", error_percent=r.choice([-20.0, 1.0, 20.0, 60.0])),
}

# Singles are drawn from these too; pairs and triples are not, whose draws would all be others.
FURTHER = {
    "asymmetric-friction": lambda r: effect("asymmetric-friction", difference_nm=sign(r) * r.uniform(0.3, 1.0)),
    "backlash": lambda r: effect("backlash", torque_nm=r.uniform(0.5, 1.2), width_deg=r.uniform(0.5, 6.0)),
    "friction-warm-up": lambda r: effect("friction-warm-up", change_nm=sign(r) * r.uniform(0.4, 1.0), time_constant_s=r.uniform(8.0, 25.0)),
    "position-dependent-friction": lambda r: effect("position-dependent-friction", order=int(r.choice([1, 2])), amplitude_nm=r.uniform(0.3, 0.8), phase_deg=turn(r)),
    "payload-change": lambda r: effect("payload-change", inertia_kgm2=sign(r) * r.uniform(0.05, 0.2),
                                       cosine_nm=sign(r) * r.uniform(0.4, 1.5), sine_nm=sign(r) * r.uniform(0.4, 1.5), time_s=r.uniform(10.0, 30.0)),
    "encoder-eccentricity": lambda r: effect("encoder-eccentricity", order=int(r.choice([1, 2])), amplitude_deg=r.uniform(0.05, 0.25), phase_deg=turn(r)),
    "sensor-lowpass": lambda r: effect("sensor-lowpass", cutoff_hz=r.uniform(12.0, 40.0)),
}

# The rest of the catalogue; velocity-bias needs a log without position.
RARER = {
    "quadratic-viscous-friction": lambda r: effect("quadratic-viscous-friction", coefficient_nm_per_deg2_s2=r.uniform(1.5e-5, 4e-5)),
    "asymmetric-viscous-friction": lambda r: effect("asymmetric-viscous-friction", difference_nm_per_deg_s=sign(r) * r.uniform(0.003, 0.01)),
    "load-friction": lambda r: effect("load-friction", torque_nm=r.uniform(0.08, 0.2), exponent=r.uniform(0.8, 1.3)),
    "ripple-direction-dependence": lambda r: effect("ripple-direction-dependence", gain_percent=r.uniform(15.0, 40.0), phase_deg=r.uniform(5.0, 30.0)),
    "start-stop-ringing": lambda r: effect("start-stop-ringing", amplitude_nm=r.uniform(0.1, 0.3), phase_deg=turn(r),
                                           frequency_hz=r.uniform(4.0, 10.0), decay_s=r.uniform(0.4, 0.9)),
    "small gear-ratio": lambda r: effect("gear-ratio", error_percent=sign(r) * r.uniform(0.02, 0.4)),
    "velocity-bias": lambda r: effect("velocity-bias", bias_deg_s=sign(r) * r.uniform(0.02, 0.1)),
}
CHANCE = ("spikes", "dropout")  # no prediction holds them
FAULTS = ("saturation", "quantization", "spikes", "dropout")


def base_joint(rng):
    """What the model knows of: inertia and two orders of ripple."""
    return [effect("inertia", inertia_kgm2=rng.uniform(0.25, 0.6)), *(
        effect("ripple", order=n, amplitude_nm=rng.uniform(low, high), phase_deg=turn(rng)) for n, low, high in ((1, 0.5, 0.9), (2, 0.3, 0.6)))]


def draw(rng, label):
    return {**RARER, **FURTHER, **HIDDEN}[label](rng)


def draw_several(rng, count):
    """Different effects of HIDDEN, at most one of them a fault of the converter."""
    while True:
        labels = [str(label) for label in rng.choice(list(HIDDEN), count, replace=False)]
        if sum(label in FAULTS for label in labels) < 2:
            return sorted(labels)
