# SPDX-License-Identifier: MIT
"""The same log as another recorder would have written it: without position, slower, with stamps that jitter and rows
that are lost, in coarse steps, or under another program's names. What is named must stay the same.
"""

import dataclasses
import zlib

import numpy as np

STAMP_JITTER_S = 1e-4  # rms; no stamp is further off than 0.4 of a step, so that they increase
LOST_ROWS = 0.03
STEP_NM = 0.1
COARSE_NM = (0.15, 0.6)  # steps of 2.5 to 10 times the noise of the studies
HELD_ROWS = 1.0 / 3.0
SLOW = 4  # of a kilohertz: 250 Hz


def rows_of(log, rows):
    position = None if log.position_deg is None else log.position_deg[rows]
    return dataclasses.replace(log, time_s=log.time_s[rows], velocity_deg_s=log.velocity_deg_s[rows],
                               torque_nm=log.torque_nm[rows], position_deg=position)


def jittered(log, rng):
    """The samples are those of the clock, the stamps are not; three rows in a hundred are missing."""
    step = log.time_s[1] - log.time_s[0]
    off = np.clip(STAMP_JITTER_S * rng.standard_normal(len(log.time_s)), -0.4 * step, 0.4 * step)
    kept = np.flatnonzero(rng.random(len(log.time_s)) >= LOST_ROWS)
    return rows_of(dataclasses.replace(log, time_s=log.time_s + off), kept)


def in_steps(log, step_nm):
    return dataclasses.replace(log, torque_nm=step_nm * np.floor(log.torque_nm / step_nm + 0.5))


def held(log, rng):
    """A row in three repeats the row before, whatever that was, under a stamp of its own: the recorder was too quick."""
    fresh = rng.random(len(log.time_s)) >= HELD_ROWS
    fresh[0] = True
    last = np.maximum.accumulate(np.where(fresh, np.arange(len(fresh)), 0))
    return dataclasses.replace(rows_of(log, last), time_s=log.time_s)


def torque_held(log, rng):
    """The same with the torque alone, so that it is half a sample late in the mean."""
    return dataclasses.replace(log, torque_nm=held(log, rng).torque_nm)


# Ways of recording: each gets the log, the chance of that log and that of its case, which both logs of a joint share.
# "libfranka" is another header alone, which cases.Case.header makes.
WAYS = {
    "without position": lambda log, rng, own: dataclasses.replace(log, position_deg=None),
    "250 Hz": lambda log, rng, own: rows_of(log, np.arange(0, len(log.time_s), SLOW)),
    "jitter": lambda log, rng, own: jittered(log, rng),
    "0.1 Nm steps": lambda log, rng, own: in_steps(log, STEP_NM),
    "libfranka": lambda log, rng, own: log,
    "held rows": lambda log, rng, own: held(log, rng),
    "held torque": lambda log, rng, own: torque_held(log, rng),
    "coarse steps": lambda log, rng, own: in_steps(log, own.uniform(*COARSE_NM)),
}

# Effects that a way of recording brings into the log. Steps as small as the noise may be named, and need not be.
BROUGHT = {"0.1 Nm steps": ("quantization",), "coarse steps": ("quantization",), "held rows": ("dropout",),
           "held torque": ("dropout",)}


def recorded(log, case, purpose):
    """The log of the case as its way of recording writes it."""
    if not case.recorded:
        return log
    rng = np.random.default_rng([zlib.crc32(f"{case.log_of} {purpose} stamps".encode())])
    return WAYS[case.recorded](log, rng, case.rng("recorder"))
