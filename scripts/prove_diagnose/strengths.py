# SPDX-License-Identifier: MIT
"""The joint that effects hide in, and which of them hide together."""

from .joint import FURTHER, HIDDEN, RARER, turn

GEAR_RATIO = 100
TORQUE_NOISE_NM = 0.06
VELOCITY_NOISE_DEG_S = 0.15


def base_joint(rng):
    """What the model knows of: inertia and two orders of ripple."""
    def order(n, low, high):
        return {"effect": "ripple", "order": n, "amplitude_nm": rng.uniform(low, high), "phase_deg": turn(rng)}
    return [{"effect": "inertia", "inertia_kgm2": rng.uniform(0.25, 0.6)}, order(1, 0.5, 0.9), order(2, 0.3, 0.6)]


CHANCE = ("spikes", "dropout")  # no prediction holds them
FAULTS = ("saturation", "quantization", "spikes", "dropout")


def draw(rng, label):
    return {**RARER, **FURTHER, **HIDDEN}[label](rng)


def draw_several(rng, count):
    """Different effects of HIDDEN, at most one of them a fault of the converter."""
    while True:
        labels = [str(label) for label in rng.choice(list(HIDDEN), count, replace=False)]
        if sum(label in FAULTS for label in labels) < 2:
            return sorted(labels)
