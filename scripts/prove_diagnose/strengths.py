# SPDX-License-Identifier: MIT
"""How strong a hidden effect is drawn, and the joint that it hides in."""

import numpy as np

GEAR_RATIO = 100
TORQUE_NOISE_NM = 0.06
VELOCITY_NOISE_DEG_S = 0.15


def base_joint(rng):
    """What the model knows of: inertia and two orders of ripple."""
    def order(n, low, high):
        return {"effect": "ripple", "order": n, "amplitude_nm": rng.uniform(low, high), "phase_deg": turn(rng)}
    return [{"effect": "inertia", "inertia_kgm2": rng.uniform(0.25, 0.6)}, order(1, 0.5, 0.9), order(2, 0.3, 0.6)]


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
    "drift": lambda r: effect("drift", rate_nm_s=sign(r) * r.uniform(0.015, 0.05),
                              time_constant_s=r.choice([20.0, 60.0, 1e6])),
    "gravity": lambda r: effect("gravity", amplitude_nm=r.uniform(0.6, 4.0), phase_deg=turn(r)),
    "coulomb-friction": lambda r: effect("coulomb-friction", torque_nm=r.uniform(0.2, 1.0),
                                         width_deg_s=r.uniform(0.1, 0.5)),
    "viscous-friction": lambda r: effect("viscous-friction", coefficient_nm_per_deg_s=r.uniform(0.002, 0.008)),
    "stribeck-friction": lambda r: effect("stribeck-friction", torque_nm=r.uniform(0.5, 1.2),
                                          stribeck_speed_deg_s=r.uniform(8.0, 20.0)),
    "ripple": lambda r: effect("ripple", order=int(r.choice([3, 4, 6])), amplitude_nm=r.uniform(0.1, 0.4),
                               phase_deg=turn(r)),
    "output-ripple": lambda r: effect("output-ripple", order=int(r.choice([2, 3])),
                                      amplitude_nm=r.uniform(0.3, 0.8), phase_deg=turn(r)),
    "tone": lambda r: effect("tone", frequency_hz=r.choice([50.0, 60.0, 100.0, r.uniform(8.0, 200.0)]),
                             amplitude_nm=r.uniform(0.08, 0.3), phase_deg=turn(r)),
    "ripple-speed-dependence": lambda r: effect("ripple-speed-dependence", gain_percent=r.uniform(30.0, 60.0),
                                                exponent=r.uniform(0.7, 1.5)),
    "ripple-load-dependence": lambda r: effect("ripple-load-dependence", gain_percent_per_nm=r.uniform(15.0, 30.0)),
    "ripple-modulation": lambda r: effect("ripple-modulation", output_order=int(r.choice([1, 2, 3])),
                                          depth_percent=r.uniform(30.0, 60.0), phase_deg=turn(r)),
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

# The rest of the catalogue; velocity-bias needs a log without position.
RARER = {
    "quadratic-viscous-friction": lambda r: effect("quadratic-viscous-friction",
                                                   coefficient_nm_per_deg2_s2=r.uniform(1.5e-5, 4e-5)),
    "load-friction": lambda r: effect("load-friction", torque_nm=r.uniform(0.08, 0.2), exponent=r.uniform(0.8, 1.3)),
    "ripple-direction-dependence": lambda r: effect("ripple-direction-dependence", gain_percent=r.uniform(15.0, 40.0),
                                                    phase_deg=r.uniform(5.0, 30.0)),
    "start-stop-ringing": lambda r: effect("start-stop-ringing", amplitude_nm=r.uniform(0.4, 0.8), phase_deg=turn(r),
                                           frequency_hz=r.uniform(4.0, 12.0), decay_s=r.uniform(0.1, 0.3)),
    "small gear-ratio": lambda r: effect("gear-ratio", error_percent=sign(r) * r.uniform(0.02, 0.4)),
    "velocity-bias": lambda r: effect("velocity-bias", bias_deg_s=sign(r) * r.uniform(0.02, 0.1)),
}

CHANCE = ("spikes", "dropout")  # no prediction holds them
FAULTS = ("saturation", "quantization", "spikes", "dropout")


def draw(rng, label):
    return (HIDDEN.get(label) or RARER[label])(rng)


def draw_several(rng, count):
    """Different effects of HIDDEN, at most one of them a fault of the converter."""
    while True:
        labels = [str(label) for label in rng.choice(list(HIDDEN), count, replace=False)]
        if sum(label in FAULTS for label in labels) < 2:
            return sorted(labels)
