# SPDX-License-Identifier: MIT
"""What is hidden in which arm, drawn from the case's number."""

import dataclasses
import math

import numpy

GEAR = 100
RATE_HZ = 500.0
SECONDS = 40.0
JOINTS = ("base", "shoulder", "elbow")
TORQUE_NOISE_NM = 0.03
VELOCITY_NOISE_DEG_S = 0.03
SINGLES = ("coulomb-friction", "viscous-friction", "load-friction", "ripple", "offset", "delay")
PAIRS = (("coulomb-friction", "viscous-friction"), ("coulomb-friction", "load-friction"), ("viscous-friction", "ripple"),
         ("coulomb-friction", "ripple"), ("coulomb-friction", "offset"))


@dataclasses.dataclass
class Case:
    name: str
    joint: int      # at which
    hidden: list    # {"effect": ..., parameters}
    xml: str
    rows: list      # time, q, v, a of the joints, rad
    seed: int


def amount(effect, random, swing_nm):
    """A hidden effect of 0.7 to 3 times what hides it, which is noise and, for the slow ones, the arm's own torque."""
    size = math.exp(random.uniform(math.log(0.7), math.log(3.0)))
    if effect == "coulomb-friction":
        return {"effect": effect, "torque_nm": 0.3 * size}
    if effect == "viscous-friction":
        return {"effect": effect, "torque_nm_per_deg_s": 0.008 * size}
    if effect == "load-friction":
        return {"effect": effect, "fraction": 0.4 * size / swing_nm}
    if effect == "ripple":
        return {"effect": effect, "order": float(random.choice([3, 4, 6])), "amplitude_nm": 0.08 * size}
    if effect == "offset":
        return {"effect": effect, "torque_nm": 0.3 * size}
    return {"effect": "delay", "delay_s": 0.004 * size}


def motion(random):
    """Sums of five sines a joint: angle, speed, acceleration in rad."""
    t = numpy.arange(int(SECONDS * RATE_HZ)) / RATE_HZ
    columns = [[], [], []]
    for reach in (1.2, 0.7, 0.9):
        weights = random.uniform(0.3, 1.0, 5) * numpy.array([1.0, 0.6, 0.4, 0.25, 0.15])
        weights *= reach / numpy.sum(weights)
        omega = 2 * math.pi * numpy.array([0.05, 0.11, 0.19, 0.31, 0.43]) * random.uniform(0.9, 1.1, 5)
        phase = random.uniform(0, 2 * math.pi, 5)
        angle = omega[:, None] * t + phase[:, None]
        columns[0].append(weights @ numpy.sin(angle))
        columns[1].append((weights * omega) @ numpy.cos(angle))
        columns[2].append(-(weights * omega**2) @ numpy.sin(angle))
    return numpy.column_stack([t, *columns[0], *columns[1], *columns[2]])


def arm_xml(random, hidden_at, hidden):
    """Masses and lengths of a small arm; damping, frictionloss and cogging where they are hidden, ripple 1 and 2 everywhere."""
    mass, length = random.uniform(1.5, 4.0, 3), random.uniform(0.2, 0.4, 3)
    joint_words, motors = ["", "", ""], []
    for j, name in enumerate(JOINTS):
        waves = [(0.15, 1), (0.3, 2)]
        for effect in hidden if j == hidden_at else []:
            if effect["effect"] == "coulomb-friction":
                joint_words[j] += f' frictionloss="{effect["torque_nm"]!r}"'
            if effect["effect"] == "viscous-friction":
                joint_words[j] += f' damping="{effect["torque_nm_per_deg_s"] * 180 / math.pi!r}"'
            if effect["effect"] == "ripple":
                waves.append((effect["amplitude_nm"], effect["order"]))
        for nm, order in waves:
            motors.append(f'<dcmotor name="{name}_{order:g}" joint="{name}" input="none" motorconst="1e-9" resistance="1" '
                          f'cogging="{nm!r} {order * GEAR:g} {random.uniform(0, 6.28)!r}"/>')
    return f"""<mujoco><compiler angle="radian"/><option timestep="0.0002" gravity="0 0 -9.81"/>
<default><joint solreffriction="0.0005 1" armature="{random.uniform(0.2, 0.6)!r}"/></default>
<worldbody><body><joint name="base" axis="0 0 1"{joint_words[0]}/><geom type="capsule" size="0.05" fromto="0 0 0 0 0 {length[0]!r}" mass="{mass[0]!r}"/>
<body pos="0 0 {length[0]!r}"><joint name="shoulder" axis="0 1 0"{joint_words[1]}/>
<geom type="capsule" size="0.05" fromto="0 0 0 {length[1]!r} 0.02 0" mass="{mass[1]!r}"/>
<body pos="{length[1]!r} 0 0"><joint name="elbow" axis="0 1 0"{joint_words[2]}/>
<geom type="capsule" size="0.04" fromto="0 0 0 {length[2]!r} 0 0.03" mass="{mass[2]!r}"/>
</body></body></body></worldbody><actuator>{"".join(motors)}</actuator></mujoco>"""


def case(kind, number):
    """kind: null, single, pair."""
    random = numpy.random.default_rng([{"null": 1, "single": 2, "pair": 3}[kind], number])
    names = {"null": (), "single": (SINGLES[number % len(SINGLES)],), "pair": PAIRS[number % len(PAIRS)]}[kind]
    joint = int(random.integers(3))
    hidden = [amount(name, random, (1.0, 8.0, 3.0)[joint]) for name in names]
    return Case(f"mujoco-{kind}-{'+'.join(names) or 'nothing'}-{number}", joint, hidden, arm_xml(random, joint, hidden),
                motion(random), number)


def measured(case, body_nm, ripple_nm):
    """Columns of the log in deg. The gear adds friction by the load of the bodies, which the sensor's ripple is not; the sensor adds
    offset, delay and noise. All but noise at the joint where they are hidden."""
    random = numpy.random.default_rng([7, case.seed])
    rows = numpy.asarray(case.rows)
    torque = body_nm + ripple_nm
    for effect in case.hidden:
        at = torque[:, case.joint]
        if effect["effect"] == "load-friction":
            at += effect["fraction"] * numpy.abs(body_nm[:, case.joint]) * numpy.tanh(rows[:, 4 + case.joint] * 180 / math.pi / 0.2)
        if effect["effect"] == "offset":
            at += effect["torque_nm"]
        if effect["effect"] == "delay":
            at[:] = numpy.interp(rows[:, 0] - effect["delay_s"], rows[:, 0], at)
    torque += TORQUE_NOISE_NM * random.standard_normal(torque.shape)
    degrees = rows[:, 1:7] * 180 / math.pi
    degrees[:, 3:] += VELOCITY_NOISE_DEG_S * random.standard_normal((len(rows), 3))
    return numpy.column_stack([rows[:, 0], degrees, torque])
