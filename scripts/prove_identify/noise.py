# SPDX-License-Identifier: MIT
"""Coloured noise of torque sensors, of a stated standard deviation, and what rigid-body dynamics and friction add."""

import math

import numpy as np

COLOURS = ("white", "first order", "1/f", "resonance", "moving")


def shaped(rng, count, rate, gain_at):
    """White noise with this gain over frequency. Twice as long as asked, so that the ends do not join."""
    spectrum = np.fft.rfft(rng.standard_normal(2 * count))
    hz = np.fft.rfftfreq(2 * count, 1.0 / rate)
    values = np.fft.irfft(spectrum * gain_at(hz), 2 * count)[:count]
    return values


def draw_colour(rng, kind, rate, duration):
    """Parameters of a kind of noise: (function of (rng, speed) to values of about unit standard deviation, their description)."""
    corner = math.exp(rng.uniform(math.log(0.5), math.log(rate / 4)))
    centre = math.exp(rng.uniform(math.log(min(3.0, rate / 10)), math.log(0.4 * rate)))
    quality, height = math.exp(rng.uniform(math.log(2.0), math.log(20.0))), rng.uniform(1.0, 10.0)
    # Ten resolutions of the log wide at least: a narrower band is a line, whoever looks at it.
    quality = min(quality, centre * duration / 10.0)
    growth, beneath = rng.uniform(0.5, 4.0), rng.choice(["white", "first order"])
    gains = {
        "white": lambda hz: np.ones_like(hz),
        "first order": lambda hz: 1.0 / np.sqrt(1.0 + (hz / corner)**2),
        "1/f": lambda hz: 1.0 / np.sqrt(np.maximum(hz, 0.05)),
        "resonance": lambda hz: 1.0 + height / np.sqrt(1.0 + (2 * quality * (hz - centre) / centre)**2),
    }
    gain = gains[beneath if kind == "moving" else kind]

    def values(generator, speed):
        count = len(speed)
        size = gain(np.linspace(0.0, rate / 2, 4001))
        made = shaped(generator, count, rate, gain) / math.sqrt(float(np.mean(size**2)))
        if kind == "moving":
            shape = 1.0 + growth * np.abs(speed) / np.max(np.abs(speed))
            made *= shape / math.sqrt(float(np.mean(shape**2)))
        return made

    about = {"corner_hz": corner} if kind == "first order" else {"centre_hz": centre, "q": quality, "height": height} \
        if kind == "resonance" else {"growth": growth, "beneath": str(beneath)} if kind == "moving" else {}
    return values, about


def body_torque(rng, sigma, position, velocity, acceleration):
    """Inertia, gravity and friction, each up to a hundred times the noise (log-uniform from once)."""
    def size():
        return sigma * math.exp(rng.uniform(0.0, math.log(100.0)))

    fastest, hardest = np.max(np.abs(velocity)), max(1e-9, np.max(np.abs(acceleration)))
    # Presliding: friction passes through zero over a small range of speed, not in a step.
    smooth, stribeck = fastest * rng.uniform(0.002, 0.02), fastest * rng.uniform(0.02, 0.2)
    parts = {"inertia": size(), "gravity": size(), "coulomb": size(), "viscous": size(), "stribeck": size() / 2, "offset": size()}
    sign = np.tanh(velocity / smooth)
    torque = parts["inertia"] * acceleration / hardest
    torque += parts["gravity"] * np.cos(np.radians(position) + rng.uniform(0, 2 * math.pi))
    torque += parts["coulomb"] * sign + parts["viscous"] * velocity / fastest
    torque += parts["stribeck"] * sign * np.exp(-(velocity / stribeck)**2) + parts["offset"]
    return torque, parts
