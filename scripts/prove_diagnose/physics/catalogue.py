# SPDX-License-Identifier: MIT
"""All hidden effects by label, and what of joint and motion they need."""

from . import effects, later

GRAVITY = {"load-friction": True, "payload": True, "gravity": True, "ripple-load-dependence": True, "inertia": False, **later.GRAVITY}
WIDE = ("gravity", "payload", "load-friction", "ripple-modulation", "output-ripple", "ripple-load-dependence", "gear-ratio", *later.WIDE)
NEEDS = {"start-stop-ringing": ("trapezoid", "trapezoid"), "stribeck-friction": ("trapezoid", "jog"),  # starts and stops, slow passes
         "resonance": ("sine", "fourier", "jog"), "ripple-speed-dependence": ("sine", "fourier", "jog")}  # many speeds
ANY_MOTION = ("trapezoid", "sine", "fourier", "jog")
WIDE_MOTION = ("trapezoid", "jog", "sine")  # with a travel of more than half a turn
PAIRS = ["+".join(pair) for pair in effects.PAIRS]


def drawer(label):
    return {**effects.SINGLES, **later.LATER}[label]


def labels():
    return [*effects.SINGLES, *later.LATER]


def gravity(labels):
    """Whether the joint's axis has to be level: True, False, or None where that does not matter."""
    return next((GRAVITY[label] for label in labels if label in GRAVITY), None)


def motions(labels):
    """Kinds of motion that can show the effects."""
    for label in NEEDS:
        if label in labels:
            return NEEDS[label]
    return WIDE_MOTION if set(WIDE) & set(labels) else ANY_MOTION
