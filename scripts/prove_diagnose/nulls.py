# SPDX-License-Identifier: MIT
"""Logs with nothing hidden in ten kinds of noise and of recording (held samples in two ways): whatever is named there is false.

Held rows may be named `dropout`, coarse steps `quantization`, since they are there (recordings.BROUGHT).
"""

import dataclasses
import math


@dataclasses.dataclass(frozen=True)
class Kind:
    text: str
    noise: str = "white"
    recorded: str = ""  # of recordings.WAYS


KINDS = (
    Kind("white"),
    Kind("AR 0.5", noise="ar0.5"),
    Kind("AR 0.9", noise="ar0.9"),
    Kind("AR 0.98", noise="ar0.98"),
    Kind("pink", noise="pink"),
    Kind("heavy tails", noise="t4"),
    Kind("mixture", noise="mixture"),
    Kind("jittered clock", recorded="jitter"),
    Kind("a third of the rows held", recorded="held rows"),
    Kind("a third of the torques held", recorded="held torque"),
    Kind("coarse steps", recorded="coarse steps"),
)
ASKED, BOUND = 0.005, 0.01


def text_of(row):
    return next(kind.text for kind in KINDS if (kind.noise, kind.recorded) == (row["noise"], row["recorded"]))


def upper(events, count, chance=0.05):
    """The share above which so few events, or fewer, have less than that chance: one-sided, Clopper and Pearson."""
    if events >= count:
        return 1.0
    low, high = events / count, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        fewer = sum(math.comb(count, k) * middle**k * (1 - middle) ** (count - k) for k in range(events + 1))
        low, high = (middle, high) if fewer > chance else (low, middle)
    return high


def line(text, rows):
    false = sum(bool(row["false"]) for row in rows)
    brought = sum(bool(row.get("brought")) for row in rows)
    names = sorted({name for row in rows for name in row["false"]})
    seconds = sorted(row["seconds"] for row in rows)[len(rows) // 2]
    return [text, str(len(rows)), f"{len(rows) - false}/{len(rows)}", str(brought) if brought else "-", ", ".join(names) or "none",
            f"{100 * false / len(rows):.2f} %", f"{100 * upper(false, len(rows)):.2f} %", f"{seconds:.1f} s"]


HEAD = ["noise or recording", "logs", "no false name", "fault of the recording named", "false names", "share", "95 % upper bound", "time"]
SHORT = (0, 2, 4, 6)  # of HEAD, in the page


def lines(rows):
    """One line a kind, then all of them."""
    groups = {kind.text: [row for row in rows if text_of(row) == kind.text] for kind in KINDS}
    return [line(text, group) for text, group in groups.items() if group] + [line("**all**", rows)]


def bar_lines(rows):
    """As bars.HEAD: what is asked of all kinds together."""
    false, count = sum(bool(row["false"]) for row in rows), len(rows)
    bound = upper(false, count)
    return [["nothing hidden, all kinds of noise: a false name", "at most 0.5 %", f"{false}/{count} = {100 * false / count:.2f} %",
             f"below {100 * bound:.2f} %", "yes" if false <= ASKED * count else "**no**"],
            ["the same: one-sided 95 % upper bound", "1 %", f"{100 * bound:.2f} %", "-", "yes" if bound < BOUND else "**no**"]]
