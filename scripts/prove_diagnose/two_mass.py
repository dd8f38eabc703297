# SPDX-License-Identifier: MIT
"""A joint from its physics: a motor under a position controller, a gear with an error of its angle or a torque of its mesh, a
spring, a link. Nothing here is a formula of the catalogue: ripple arises, passes the torsional mode and moves the motor.

What is logged is the motor's angle and speed, and the torque of strain gauges on the spring. The truth's inertia is the link's; its
ripples are the gear's: an error of the angle that gives so much torque against a link that is held, or a torque of the mesh.
Integrated at 8 kHz, speeds before angles; at rest at the start.
"""

import dataclasses
import math

import numpy as np

from . import joint

NAMES = ("resonance", "ripple-speed-dependence")  # what is right for it


@dataclasses.dataclass(frozen=True)
class Joint:
    """What the gear does, and the rest in draws of (least, most)."""

    gear: str  # "angle" (an error of it) or "mesh" (a torque on the link)
    mode_hz: tuple = (30.0, 60.0)  # of the link on its spring, the motor held
    damping: tuple = (0.05, 0.15)
    motor: tuple = (2.0, 6.0)  # its inertia, of the link's
    loop_hz: tuple = (4.0, 8.0)  # bandwidth of the controller
    acceptable: tuple = NAMES

    def drawn(self, rng):
        return {name: rng.uniform(*getattr(self, name)) for name in ("mode_hz", "damping", "motor", "loop_hz")}


JOINTS = {
    "error of the gear's angle": Joint("angle"),
    "error of the gear's angle, stiff controller": Joint("angle", loop_hz=(12.0, 20.0)),
    "torque of the mesh": Joint("mesh"),
    "torque of the mesh, stiff controller": Joint("mesh", loop_hz=(12.0, 20.0)),
    "torque of the mesh, heavy link": Joint("mesh", mode_hz=(12.0, 25.0), motor=(1.0, 2.0)),
    "torque of the mesh, hardly damped": Joint("mesh", damping=(0.015, 0.03)),
}


def measured(kind, rng, travel, truth, gear_ratio, time_s):
    """(torque Nm, angle deg, speed deg/s of the motor on the gear's output side) at the times."""
    drawn = kind.drawn(rng)
    step = (time_s[1] - time_s[0]) / joint.SUBSTEPS
    times = time_s[0] + np.arange((len(time_s) - 1) * joint.SUBSTEPS + 1) * step
    wanted = [np.radians(column).tolist() for column in travel.at(times)]
    link = joint.named(truth, "inertia")[0]["inertia_kgm2"]
    motor, omega = drawn["motor"] * link, 2 * math.pi * drawn["mode_hz"]
    stiffness, rub = link * omega**2, 2 * drawn["damping"] * omega * link
    loop, whole = 2 * math.pi * drawn["loop_hz"], motor + link
    hold, brake = whole * loop**2, 1.6 * whole * loop
    waves = [(e["amplitude_nm"], e["order"] * gear_ratio, math.radians(e["phase_deg"])) for e in joint.named(truth, "ripple")]
    angle, speed = wanted[0][0], wanted[1][0]
    error = sum(a * math.cos(n * angle + p) for a, n, p in waves) / stiffness if kind.gear == "angle" else 0.0
    far, far_speed = angle + error, speed
    rows = []
    for q, v, a in zip(*wanted):
        wave = sum(size * math.cos(n * angle + p) for size, n, p in waves)
        lever = 1.0
        error, error_speed = 0.0, 0.0
        if kind.gear == "angle":
            slope = -sum(size * n * math.sin(n * angle + p) for size, n, p in waves) / stiffness
            error, error_speed, lever = wave / stiffness, slope * speed, 1.0 + slope
        elastic = stiffness * (angle + error - far)  # what strain gauges see
        spring = elastic + rub * (speed + error_speed - far_speed)
        drive = hold * (q - angle) + brake * (v - speed) + whole * a
        rows.append((elastic, angle, speed))
        speed += step * (drive - lever * spring) / motor
        far_speed += step * (spring - (wave if kind.gear == "mesh" else 0.0)) / link
        angle += step * speed
        far += step * far_speed
    torque, angle, speed = np.array(rows[:: joint.SUBSTEPS]).T
    return torque, np.degrees(angle), np.degrees(speed)
