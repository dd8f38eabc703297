# SPDX-License-Identifier: MIT
"""The effects that are hidden, each as a change of the joint's physics, and what counts as a right answer.

Written before any log was diagnosed. A name is (effect, order or None). `required` is a list of groups: of each at least one
name has to be found; `allowed` are names that are right as well and not asked for. `truth` gives the values whose 95 % intervals are
checked: only those that the physics states without an approximation.
"""

import dataclasses
import math
from typing import Callable

from . import plant as plants

RESONANT = [("resonance", None), ("ripple-speed-dependence", None)]


def nothing(_p, _s):
    """No change."""


@dataclasses.dataclass
class Hidden:
    """One effect as drawn. prepare changes the joint that model and simulation know, apply adds what is hidden of strength s."""

    required: list
    apply: Callable = nothing
    prepare: Callable = nothing
    start: float = 1.0  # strength that the search for the wanted size begins with
    most: float = math.inf
    allowed: list = dataclasses.field(default_factory=list)
    truth: Callable = lambda s: {}  # (effect, order), parameter: value
    unknown: tuple = ()  # entries of the complete model that the user's model lacks
    stated: Callable = lambda s: {}  # values that the user's model states
    sized: bool = True  # whether the strength is searched; else it is `start`
    ripple_is_new: bool = False  # a simulation has no ripple, so that the ripple itself has to be found beside it
    optional_when_scaled: bool = False  # the fitted scale of a simulation can say the same
    sensor: dict = dataclasses.field(default_factory=dict)  # of the log: offset, velocity bias, converter
    position: bool = True
    given_ratio: float = 1.0  # ratio that the user states, as a part of the true one


def one(name, order=None):
    return [[(name, order)]]


def setter(*keys):
    def apply(p, s):
        for key in keys:
            p[key] = s
    return apply


def without(*keys):
    def prepare(p, _s):
        for key in keys:
            p[key] = 0.0
    return prepare


def coulomb(rng, j):
    return Hidden(one("coulomb-friction"), setter("coulomb"), without("coulomb"), 4 * j.noise_nm,
                  unknown=("coulomb-friction",), truth=lambda s: {("coulomb-friction", None, "torque_nm"): s})


def stribeck(rng, j):
    speed = math.radians(j.fastest_deg_s * rng.uniform(0.06, 0.15))

    def apply(p, s):
        p["stick"], p["stribeck_speed"] = s, speed
    return Hidden(one("stribeck-friction"), apply, start=4 * j.noise_nm, most=25 * j.noise_nm)


def viscous(rng, j):
    return Hidden(one("viscous-friction"), setter("viscous"), without("viscous"), j.parameters["viscous"],
                  unknown=("viscous-friction",),
                  truth=lambda s: {("viscous-friction", None, "coefficient_nm_per_deg_s"): s * math.pi / 180})


def churning(rng, j):
    exponent = rng.uniform(1.85, 2.15)

    def apply(p, s):
        p["drag"], p["drag_exponent"] = s, exponent
    return Hidden(one("quadratic-viscous-friction"), apply, start=4 * j.noise_nm / math.radians(j.fastest_deg_s) ** 2,
                  allowed=[("viscous-friction", None)])


def load_friction(rng, j):
    return Hidden(one("load-friction"), setter("friction_by_load"), start=0.05, most=0.3)


def hysteresis(rng, j):
    width = math.radians(rng.uniform(0.6, 4.0))

    def apply(p, s):
        p["soft_level"], p["soft_width"] = s, width
    return Hidden(one("hysteresis"), apply, start=4 * j.noise_nm,
                  truth=lambda s: {("hysteresis", None, "torque_nm"): s, ("hysteresis", None, "width_deg"): math.degrees(width)})


def gravity(rng, j):
    angle = j.parameters["weight_angle"]
    return Hidden(one("gravity"), setter("weight"), without("weight", "known_weight"), 4 * j.noise_nm, unknown=("gravity",),
                  truth=lambda s: {("gravity", None, "amplitude_nm"): s, ("gravity", None, "phase_deg"): math.degrees(angle)})


def inertia(rng, j):
    bare = j.parameters["link_inertia"]

    def apply(p, s):
        p["link_inertia"] = bare * (1 + s)
    return Hidden(one("inertia"), apply, start=0.3, most=1.5, stated=lambda s: {"inertia": {"inertia_kgm2": bare}},
                  optional_when_scaled=True)


def payload(rng, j):
    """A mass at the end of the link that the model does not hold: weight and inertia."""
    p0, arm = dict(j.parameters), rng.uniform(0.2, 0.5)
    sign = math.copysign(1.0, p0["weight"])

    def apply(p, s):
        p["weight"], p["link_inertia"] = p0["weight"] + sign * 9.81 * arm * s, p0["link_inertia"] + s * arm**2

    def stated(_s):
        phase = math.degrees(p0["weight_angle"]) + (0.0 if sign > 0 else 180.0)
        return {"inertia": {"inertia_kgm2": p0["link_inertia"]},
                "gravity": {"amplitude_nm": abs(p0["weight"]), "phase_deg": (phase + 180.0) % 360.0 - 180.0}}
    return Hidden([[("gravity", None), ("payload-change", None)]], apply, start=0.1, most=1.5, stated=stated,
                  allowed=[("inertia", None)], optional_when_scaled=True)


def offset(rng, j):
    sign = rng.choice([-1.0, 1.0])
    size = sign * j.noise_nm * math.exp(rng.uniform(0.0, math.log(8.0)))
    return Hidden(one("offset"), sized=False, sensor={"offset": size},
                  truth=lambda s: {("offset", None, "torque_nm"): size})


def drift(rng, j):
    time_constant, sign = rng.uniform(5.0, 40.0), rng.choice([-1.0, 1.0])

    def apply(p, s):
        p["drift"], p["drift_s"] = sign * s, time_constant
    return Hidden(one("drift"), apply, start=4 * j.noise_nm, allowed=[("offset", None)],
                  truth=lambda s: {("drift", None, "rate_nm_s"): sign * s / time_constant,
                                   ("drift", None, "time_constant_s"): time_constant})


def transmission_error(order):
    """An error of the gear's angle: its torque is what the link's inertia makes of it, and passes the torsional mode."""
    def draw(rng, j):
        phase = rng.uniform(-math.pi, math.pi)

        def prepare(p, _s):
            p["gauge"] = [wave for wave in p["gauge"] if wave[0] != order]

        def apply(p, s):
            p["te"] = [*p.get("te", []), (order, s, phase)]
        return Hidden(one("ripple", order), apply, prepare, 1e-4, unknown=(f"ripple {order:g}",), allowed=RESONANT)
    return draw


def mesh_ripple(rng, j):
    """A torque of the meshing teeth of an order that nobody expects; it passes the stiff torsional mode."""
    order, phase = float(rng.choice([3, 4, 6])), rng.uniform(-math.pi, math.pi)

    def apply(p, s):
        p["mesh"] = [*p.get("mesh", []), (order, s, phase)]
    return Hidden(one("ripple", order), apply, start=4 * j.noise_nm, allowed=RESONANT)


def modulation(rng, j):
    angle = rng.uniform(-math.pi, math.pi)

    def apply(p, s):
        p["eccentric"], p["eccentric_angle"] = s, angle
    return Hidden(one("ripple-modulation", 1.0), apply, start=0.4, most=0.8, allowed=[("ripple-modulation", 2.0)],
                  ripple_is_new=True)


def speed_dependence(rng, j):
    """An error of the gear's angle of the orders of the known ripple, which rises out of it with the speed."""
    phases, parts = rng.uniform(-math.pi, math.pi, 2), rng.uniform(0.5, 1.0, 2)

    def apply(p, s):
        p["te"] = [(1, s * parts[0], phases[0]), (2, s * parts[1] / 4, phases[1])]
    return Hidden([RESONANT], apply, start=1e-4, allowed=RESONANT, ripple_is_new=True)


def load_dependence(rng, j):
    return Hidden(one("ripple-load-dependence"), setter("gauge_by_load"), start=0.1, most=1.0, ripple_is_new=True)


def direction_dependence(rng, j):
    turn = rng.uniform(-0.6, 0.6)

    def apply(p, s):
        p["flank_gain"], p["flank_phase"] = s, s * turn
    return Hidden(one("ripple-direction-dependence"), apply, start=0.3, most=0.8, ripple_is_new=True)


def output_ripple(rng, j):
    order, phase = float(rng.choice([2, 3, 4])), rng.uniform(-math.pi, math.pi)

    def apply(p, s):
        p["spline"] = [(order, s, phase)]
    return Hidden(one("output-ripple", order), apply, start=4 * j.noise_nm,
                  truth=lambda s: {("output-ripple", order, "amplitude_nm"): s})


def resonance(rng, j):
    """Torque of the mesh of known orders, which meets a soft torsional mode within the speeds of the log."""
    phases = rng.uniform(-math.pi, math.pi, 2)
    fastest_hz = 2 * j.ratio * j.fastest_deg_s / 360
    mode, damping = fastest_hz * rng.uniform(0.5, 0.8), rng.uniform(0.02, 0.06)

    def prepare(p, s):
        p["gauge"], p["mesh"] = [], [(1, s, phases[0]), (2, 0.7 * s, phases[1])]

    def apply(p, s):
        prepare(p, s)
        p.update(plants.spring(p, mode, damping))
        p.update(plants.controller(p, min(6.0, mode / 4)))
    return Hidden([RESONANT], apply, prepare, 3 * j.noise_nm, 15 * j.noise_nm, allowed=[*RESONANT, ("start-stop-ringing", None)],
                  ripple_is_new=True)


def delay(rng, j):
    return Hidden(one("delay"), setter("delay"), start=0.003, most=0.015,
                  truth=lambda s: {("delay", None, "delay_s"): round(s * 16000) / 16000})


def lag(rng, j):
    return Hidden(one("lag"), setter("lag"), start=0.003, most=0.03, truth=lambda s: {("lag", None, "time_constant_s"): s})


def wrong_ratio(rng, j):
    """The user states a ratio that is a little off: by 0.15 to 1 motor turn over an output turn."""
    off = rng.choice([-1.0, 1.0]) * rng.uniform(0.15, 1.0) / j.ratio
    return Hidden([[("gear-ratio", None)]], sized=False, given_ratio=1 / (1 + off), ripple_is_new=True,
                  truth=lambda s: {("gear-ratio", None, "error_percent"): 100 * off})


def tone(hertz):
    def draw(rng, j):
        frequency, phase = hertz or rng.choice([rng.uniform(11.0, 45.0), rng.uniform(55.0, 110.0)]), rng.uniform(-math.pi, math.pi)

        def apply(p, s):
            p["tone"] = [*p.get("tone", []), (frequency, s, phase)]
        return Hidden(one("tone"), apply, start=2 * j.noise_nm,
                      truth=lambda s: {("tone", None, "frequency_hz"): frequency, ("tone", None, "amplitude_nm"): s})
    return draw


def velocity_bias(rng, j):
    """A log of velocity alone, whose zero is off: the motor's angle is wrong by half a turn to four when the log ends."""
    bias = rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 4.0) * 360 / j.ratio / 25.0
    return Hidden(one("velocity-bias"), sized=False, sensor={"velocity_bias": bias}, position=False, ripple_is_new=True,
                  truth=lambda s: {("velocity-bias", None, "bias_deg_s"): bias})


def ringing(rng, j):
    """Part of the load hangs on a spring of its own and swings when the joint starts and stops."""
    hertz, damping = rng.uniform(2.5, 5.0), rng.uniform(0.03, 0.08)

    def prepare(p, s):
        p["known_inertia"] = p["link_inertia"] = j.parameters["link_inertia"] * (1 + s)

    def apply(p, s):
        p["link_inertia"] = j.parameters["link_inertia"]
        p |= {"flex_inertia": s * p["link_inertia"], "flex_hz": hertz, "flex_damping": damping}
    return Hidden([[("start-stop-ringing", None), ("resonance", None)]], apply, prepare, 0.3, 2.0, allowed=[("inertia", None)])


def saturation(rng, j):
    part = rng.uniform(0.5, 0.85)
    return Hidden(one("saturation"), sized=False, sensor={"limit_part": part})


def quantization(rng, j):
    step = rng.uniform(2.0, 5.0) * j.noise_nm
    return Hidden(one("quantization"), sized=False, sensor={"step": step}, truth=lambda s: {("quantization", None, "step_nm"): step})


def dropout(rng, j):
    return Hidden(one("dropout"), sized=False, sensor={"held": int(rng.integers(15, 40))})


SINGLES = {
    "coulomb-friction": coulomb, "stribeck-friction": stribeck, "viscous-friction": viscous,
    "quadratic-viscous-friction": churning, "load-friction": load_friction, "hysteresis": hysteresis, "gravity": gravity,
    "inertia": inertia, "payload": payload, "offset": offset, "drift": drift,
    "transmission-error-1": transmission_error(1), "transmission-error-2": transmission_error(2), "mesh-ripple": mesh_ripple,
    "ripple-modulation": modulation, "ripple-speed-dependence": speed_dependence, "ripple-load-dependence": load_dependence,
    "ripple-direction-dependence": direction_dependence, "output-ripple": output_ripple, "resonance": resonance,
    "delay": delay, "lag": lag, "gear-ratio": wrong_ratio, "tone-50": tone(50.0), "tone": tone(None),
    "velocity-bias": velocity_bias, "start-stop-ringing": ringing, "saturation": saturation, "quantization": quantization,
    "dropout": dropout,
}

PAIRS = (
    ("coulomb-friction", "viscous-friction"), ("coulomb-friction", "transmission-error-1"), ("coulomb-friction", "gravity"),
    ("coulomb-friction", "delay"), ("stribeck-friction", "mesh-ripple"), ("viscous-friction", "drift"),
    ("viscous-friction", "output-ripple"), ("hysteresis", "tone-50"), ("hysteresis", "transmission-error-2"),
    ("load-friction", "offset"), ("quadratic-viscous-friction", "ripple-modulation"), ("gravity", "output-ripple"),
    ("payload", "viscous-friction"), ("lag", "coulomb-friction"), ("delay", "mesh-ripple"), ("tone", "drift"),
    ("resonance", "offset"), ("ripple-direction-dependence", "viscous-friction"), ("start-stop-ringing", "tone-50"),
    ("quantization", "stribeck-friction"),
)
