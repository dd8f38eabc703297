# SPDX-License-Identifier: MIT
"""Logs of a joint drawn from a seed: motion, torque, encoder, what is known of each."""

import dataclasses
import math

import numpy as np

from . import motion, noise

RATES = (25, 50, 77, 100, 125, 250, 500, 1000, 2000, 4000)
CATALOGUE = (30, 50, 80, 100, 101, 120, 121, 160, 161)
ROWS = 24000  # the largest log: the study asks how good the answers are, not how large a log may be
FEWEST = 150


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


@dataclasses.dataclass
class Log:
    truth: dict
    time: np.ndarray
    velocity: np.ndarray  # as the log says
    position: np.ndarray  # as the log says, None without
    torque: np.ndarray
    angle: np.ndarray     # of the output, as it is
    speed: np.ndarray     # of the output, as it is
    noise: object         # function of a random generator: another draw of this log's noise in Nm

    def csv(self):
        columns = [self.time, self.velocity, self.torque]
        header = "time_s,velocity_deg_s,torque_nm"
        if self.position is not None:
            columns.append(self.position)
            header += ",position_deg"
        line = "%.6f" + ",%.9g" * (len(columns) - 1)
        return header + "\n" + "\n".join(line % row for row in zip(*(column.tolist() for column in columns))) + "\n"


def draw(seed, ripple="none", tones=True):
    """ripple: none, one comb or two combs."""
    rng = np.random.default_rng([seed, 48])
    kind = str(rng.choice(motion.KINDS))
    rate = float(rng.choice(RATES))
    several = rng.random() < 0.2
    travel = log_uniform(rng, 360, 3600) if several else log_uniform(rng, 20, 360)
    # A second comb is that of the other spline of a strain wave gear, whose ratios begin near 30.
    ratio = float(rng.choice(CATALOGUE)) if rng.random() < 0.5 else log_uniform(rng, 25 if ripple == "two combs" else 1, 320)
    # A motor without gear turns faster than a joint.
    peak = log_uniform(rng, 5, 180) * (10 if ratio < 10 and rng.random() < 0.5 else 1)
    sweeps = int(round(log_uniform(rng, 1, 20)))
    # Neither a handful of rows nor more than ROWS: the speed follows.
    mean_sweep = travel / peak * 1.6
    peak *= max(1.0, mean_sweep * sweeps * rate / ROWS)
    peak *= min(1.0, mean_sweep * sweeps * rate / FEWEST)
    made, speeds = motion.moves(rng, kind, travel, peak, sweeps)
    time = np.arange(min(ROWS, int(made.duration_s * rate))) / rate
    angle, speed, acceleration = made.at(time)
    travelled = float(np.ptp(angle))

    sigma = log_uniform(rng, 0.005, 1.0)
    colour = str(rng.choice(noise.COLOURS))
    values, about = noise.draw_colour(rng, colour, rate, len(time) / rate)
    torque, parts = noise.body_torque(rng, sigma, angle, speed, acceleration)
    torque = torque + sigma * values(rng, speed)
    fastest = float(np.max(np.abs(speed)))
    tone_list = []
    if tones and rng.random() < 0.3:
        mains = float(rng.choice([50.0, 60.0]))
        for hz in mains * np.arange(1, rng.integers(2, 4)):
            if hz < 0.45 * rate:
                tone_list.append({"hz": float(hz), "nm": sigma * log_uniform(rng, 0.5, 5.0)})
    for tone in tone_list:
        torque += tone["nm"] * np.cos(2 * math.pi * tone["hz"] * time + rng.uniform(0, 2 * math.pi))

    lines = []
    if ripple != "none":
        lines = draw_ripple(rng, ripple, ratio, sigma)
        by_speed = rng.random() < 0.3
        for line in lines:
            line["slope"] = rng.uniform(-0.5, 0.5) if by_speed else 0.0
            size = line["nm"] * (1.0 + line["slope"] * (np.abs(speed) / fastest - 0.5))
            torque += size * np.cos(np.radians(line["order"] * angle) + line["phase"])
    bits = int(rng.integers(14, 25))
    step = 360.0 / 2**bits
    with_position = rng.random() < 0.7
    velocity_noise = fastest * log_uniform(rng, 1e-4, 1e-2) if rng.random() < 0.5 else 0.0
    velocity = speed + velocity_noise * rng.standard_normal(len(time))
    resolution = fastest * log_uniform(rng, 1e-6, 1e-3)
    velocity = np.round(velocity / resolution) * resolution
    truth = {
        "seed": seed, "motion": kind, "rate_hz": rate, "travel_deg": travelled, "ratio": ratio, "peak_deg_s": fastest,
        "sweeps": sweeps, "speeds": speeds, "rows": len(time), "duration_s": float(len(time) / rate), "sigma_nm": sigma,
        "colour": colour, "colour_about": about, "body_nm": parts, "tones": tone_list, "ripple": ripple, "lines": lines,
        "folded": any(line["order"] * fastest / 180.0 > rate for line in lines),
        "position": bool(with_position), "encoder_deg": step, "velocity_noise_deg_s": velocity_noise,
    }
    return Log(truth, time, velocity, np.round(angle / step) * step if with_position else None, torque, angle, speed,
               lambda generator: sigma * values(generator, speed))


def draw_ripple(rng, ripple, ratio, sigma):
    """Lines at few multiples of Kg, and with two combs also of Kg + 1 (the two splines of a strain wave gear)."""
    size = sigma * log_uniform(rng, 0.3, 10.0)
    lines = []

    def comb(step, multiples, of):
        for n in multiples:
            nm = size * log_uniform(rng, 0.2, 1.0)
            lines.append({"comb": of, "n": int(n), "order": float(n * step), "nm": nm, "phase": rng.uniform(0, 2 * math.pi)})

    choice = [(1, 2), (1, 2), (2,), (2, 4), (1, 2, 3), (1, 2, 4), (2, 4, 6), (1,)]
    comb(ratio, choice[rng.integers(len(choice))], "first")
    if ripple == "two combs":
        comb(ratio + 1, choice[rng.integers(len(choice))], "second")
    return lines


def standard_errors(log, orders, draws=16):
    """Standard deviation of the amplitude that least squares finds at each order, of this log's noise alone."""
    moving = np.abs(log.speed) > 0.02 * log.truth["peak_deg_s"]
    angle = np.radians(log.angle[moving])
    rng = np.random.default_rng([log.truth["seed"], 4848])
    noise = np.column_stack([log.noise(rng)[moving] for _ in range(draws)])
    made = []
    for order in orders:
        basis = np.column_stack([np.cos(order * angle), np.sin(order * angle), np.ones(len(angle))])
        found = np.linalg.lstsq(basis, noise, rcond=None)[0][:2]
        made.append(float(np.sqrt(np.mean(found**2))))
    return made
