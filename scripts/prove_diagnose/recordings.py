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


# Ways of recording. The last is another header alone, which cases.Case.header makes.
WAYS = {
    "without position": lambda log, rng: dataclasses.replace(log, position_deg=None),
    "250 Hz": lambda log, rng: rows_of(log, np.arange(0, len(log.time_s), SLOW)),
    "jitter": jittered,
    "0.1 Nm steps": lambda log, rng: dataclasses.replace(log, torque_nm=STEP_NM * np.floor(log.torque_nm / STEP_NM + 0.5)),
    "libfranka": lambda log, rng: log,
}

# Effects that a way of recording brings into the log. Steps as small as the noise may be named, and need not be.
BROUGHT = {"0.1 Nm steps": ("quantization",)}


def recorded(log, case, purpose):
    """The log of the case as its way of recording writes it."""
    if not case.recorded:
        return log
    return WAYS[case.recorded](log, np.random.default_rng([zlib.crc32(f"{case.log_of} {purpose} stamps".encode())]))
