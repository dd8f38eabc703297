# SPDX-License-Identifier: MIT
"""Compiles joint.cpp when it is newer than its program, and runs it."""

import os
import pathlib
import shutil
import subprocess

import numpy as np

SOURCE = pathlib.Path(__file__).with_name("joint.cpp")
PROGRAM = pathlib.Path(__file__).resolve().parents[3] / "build/prove-physics/joint"
CONTROLLER_RATE_HZ = 2000


def compiled():
    """The path of the compiled integrator."""
    if not PROGRAM.exists() or PROGRAM.stat().st_mtime < SOURCE.stat().st_mtime:
        PROGRAM.parent.mkdir(parents=True, exist_ok=True)
        fresh = PROGRAM.with_name(f"joint-{os.getpid()}")
        compiler = shutil.which("g++") or shutil.which("c++") or "g++"
        subprocess.run([compiler, "-O2", "-std=c++20", str(SOURCE), "-o", str(fresh)], check=True)
        fresh.replace(PROGRAM)
    return PROGRAM


def run(parameters, reference):
    """Integrates a joint along a reference motion.

    parameters: numbers by name, and lists of waves (order, amplitude, phase) by name. reference: rows of angle, speed,
    acceleration (rad) and external torque (Nm) at CONTROLLER_RATE_HZ. Returns a dictionary of columns: motor_angle, motor_speed,
    link_angle, link_speed (rad), torque (as measured, without noise) and spring (across the flexspline), Nm.
    """
    lines = []
    for name, value in parameters.items():
        if isinstance(value, (list, tuple)):
            lines += [f"{name} {order:.17g} {amplitude:.17g} {phase:.17g}" for order, amplitude, phase in value]
        else:
            lines.append(f"{name} {value:.17g}")
    head = "\n".join([*lines, f"reference {len(reference)}", ""]).encode()
    done = subprocess.run([compiled()], input=head + np.ascontiguousarray(reference, "<f8").tobytes(), capture_output=True,
                          check=True)
    columns = np.frombuffer(done.stdout, "<f8").reshape(-1, 6).T
    if not np.isfinite(columns).all():
        raise ValueError("the integration of the joint diverged")
    return dict(zip(("motor_angle", "motor_speed", "link_angle", "link_speed", "torque", "spring"), columns))
