# SPDX-License-Identifier: MIT
"""The second half of the effects, as in effects.py."""

import math

from .effects import Hidden, one, setter


def asymmetric_friction(rng, j):
    """Another level of the friction in each direction. Their mean is known, an offset says the other half at speed."""
    sign = rng.choice([-1.0, 1.0])

    def apply(p, s):
        p["asymmetry"] = sign * s
    return Hidden([[("asymmetric-friction", None)]], apply, start=0.3, most=0.9)


def asymmetric_viscous_friction(rng, j):
    """Another coefficient of the viscous friction in each direction. Their mean is known."""
    sign = rng.choice([-1.0, 1.0])

    def apply(p, s):
        p["viscous_asymmetry"] = sign * s
    return Hidden(one("asymmetric-viscous-friction"), apply, start=0.3, most=0.9)


def backlash(rng, j):
    """Play between motor and link: torque is next to none until the flanks meet again."""
    return Hidden(one("backlash"), setter("backlash"), start=1e-3, most=math.radians(0.3),
                  allowed=[("start-stop-ringing", None)])


def friction_warm_up(rng, j):
    seconds = rng.uniform(5.0, 15.0)

    def apply(p, s):
        p["warm"], p["warm_s"] = s, seconds
    return Hidden(one("friction-warm-up"), apply, start=0.5, most=3.0)


def payload_change(rng, j):
    """A mass is gripped during the log."""
    arm, at = rng.uniform(0.2, 0.5), rng.uniform(7.0, 13.0)
    sign = math.copysign(1.0, j.parameters["weight"])

    def apply(p, s):
        p["added_at"], p["added_inertia"], p["added_weight"] = at, s * arm**2, sign * 9.81 * arm * s
    return Hidden(one("payload-change"), apply, start=0.1, most=1.5)


def position_dependent_friction(rng, j):
    angle = rng.uniform(-math.pi, math.pi)

    def apply(p, s):
        p["uneven"], p["uneven_angle"] = s, angle
    return Hidden(one("position-dependent-friction"), apply, start=0.4, most=0.9)


def encoder_eccentricity(rng, j):
    """A code disc on the output that is off centre: the logged angle is wrong by one cycle a turn."""
    size, angle = rng.uniform(0.1, 0.6) * 360 / (2 * math.pi * j.ratio), rng.uniform(-math.pi, math.pi)
    return Hidden(one("encoder-eccentricity"), sized=False, sensor={"eccentric_deg": size, "eccentric_angle": angle},
                  ripple_is_new=True)


def sensor_lowpass(rng, j):
    """A filter of second order of the amplifier. strength: 1 / (its corner in rad/s)."""
    def apply(p, s):
        p["low_pass_hz"] = 1 / (2 * math.pi * s)
    return Hidden(one("sensor-lowpass"), apply, start=0.004, most=0.02)


LATER = {"asymmetric-friction": asymmetric_friction, "asymmetric-viscous-friction": asymmetric_viscous_friction,
         "backlash": backlash, "friction-warm-up": friction_warm_up,
         "payload-change": payload_change, "position-dependent-friction": position_dependent_friction,
         "encoder-eccentricity": encoder_eccentricity, "sensor-lowpass": sensor_lowpass}
GRAVITY = {"payload-change": True}
WIDE = ("payload-change", "position-dependent-friction", "encoder-eccentricity")
