# SPDX-License-Identifier: MIT
"""What is required of `diagnose` and what was measured: one line a criterion, with the 95 % interval of the share."""

import dataclasses
import math
import statistics
from typing import Callable

import page_tables

HIDDEN = ("single", "pair", "triple")
OUTSIDE = ("outside", "outside+single")


def wilson(right, count, z=1.959964):
    """Wilson's 95 % interval for a share, as two numbers from 0 to 1."""
    share, weight = right / count, z * z / count
    middle = (share + weight / 2) / (1 + weight)
    half = z / (1 + weight) * math.sqrt(share * (1 - share) / count + weight / count / 4)
    return max(0.0, middle - half), min(1.0, middle + half)


def line(text, asked, answers, low=0.0, high=1.0):
    """A row of the tables of what was asked: how many of the answers are true, and whether their share is in the bounds."""
    answers = [bool(answer) for answer in answers]
    if not answers:
        return [text, asked, "no logs", "-", "-"]
    right, count = sum(answers), len(answers)
    least, most = wilson(right, count)
    return [text, asked, f"{right}/{count} = {100 * right / count:.1f} %", f"{100 * least:.1f} to {100 * most:.1f} %",
            "yes" if low <= right / count <= high else "**no**"]


@dataclasses.dataclass(frozen=True)
class Bar:
    """A share that should lie between `low` and `high`; test(row) is True, False or None (not counted), or a list of such."""

    text: str
    asked: str
    studies: tuple
    test: Callable
    low: float = 0.0
    high: float = 1.0
    also: Callable = lambda row: True

    def line(self, rows):
        answers = [self.test(row) for row in rows if row["study"] in self.studies and self.also(row)]
        flat = [a for answer in answers for a in (answer if isinstance(answer, list) else [answer]) if a is not None]
        return line(self.text, self.asked, flat, self.low, self.high)


def held(row):
    return [p["beyond"] <= 1.0 for p in row["parameters"] if p["beyond"] is not None]


def of_40_s(row):
    return row["motion"] == "rich" and row["variant"] in ("", "list reversed", "other units")


def gap_line(rows):
    shares = sorted(r["gap"]["closed"] for r in rows if r["study"] in HIDDEN and r["gap"]["closed"] is not None)
    text = ["gap closed on the validation log, median", "at least 98 %"]
    if not shares:
        return [*text, "no logs", "-", "-"]
    middle, worst = statistics.median(shares), shares[len(shares) // 10]
    return [*text, f"{100 * middle:.1f} % of {len(shares)} logs", f"a tenth is below {100 * worst:.1f} %",
            "yes" if middle >= 0.98 else "**no**"]


def same_names(rows):
    """For each variant of a log: whether its names are those of the log as it is (None: that was not run)."""
    single = {row["label"] + row["case"].rpartition("-")[2]: row["named"] for row in rows if row["study"] == "single"}

    def test(row):
        named = single.get(row["label"] + row["case"].rpartition("-")[2])
        return None if named is None else named == row["named"]

    return test


def bars(rows, told):
    """told: share of a hidden effect's energy located, from which on the place is right."""
    same = same_names(rows)

    def variant(*kinds):
        return {"studies": ("variant",), "test": same, "also": lambda r: r["variant"] in kinds, "low": 1.0}

    return [
        Bar("one hidden effect: names exactly right", "at least 97 %", ("single",), lambda r: r["exact"], 0.97),
        Bar("two hidden effects: names exactly right", "at least 90 %", ("pair",), lambda r: r["exact"], 0.9),
        Bar("three hidden effects: names exactly right", "at least 90 %", ("triple",), lambda r: r["exact"], 0.9),
        Bar("nothing hidden, white noise: no name", "199 of 200", ("null",), lambda r: not r["named"], 0.995),
        Bar("a formula that is not the catalogue's: an acceptable name and no other", "at least 95 %", ("formula",),
            lambda r: r["exact"], 0.95),
        Bar("a disturbance outside the catalogue: a false name", "at most 5 %", OUTSIDE, lambda r: bool(r["false"]),
            0.0, 0.05),
        Bar("the same: its interval in time is reported", "each", OUTSIDE, lambda r: r["place"], 1.0),
        Bar("95 % interval covers the truth", "90 to 98 %", HIDDEN, held, 0.9, 0.98),
        Bar("residual of `simulate` on the validation log as stated, within 10 %", "each", HIDDEN,
            lambda r: r["gap"]["as_said"], 1.0),
        Bar("each reported effect lowers the residual", "each", HIDDEN, lambda r: r["lowers"], 1.0),
        Bar("removing a confirmed effect raises the residual by its share", "each", HIDDEN, lambda r: r["reopens"], 1.0),
        Bar("effect excluded from the catalogue: unexplained, at the right position", "each", ("without",),
            lambda r: r["told"] >= told, 1.0),
        Bar("the same: no other name instead", "each", ("without",), lambda r: not r["named"], 1.0),
        Bar("units scaled: the same names", "each", **variant("other units")),
        Bar("model's list in another order: the same names", "each", **variant("list reversed")),
        Bar("half of the log: the same names", "each", **variant("first half", "second half")),
        Bar("40,000 samples in less than 10 s of one core", "each", HIDDEN + OUTSIDE + ("null", "formula"),
            lambda r: r["seconds"] < 10.0, 1.0, also=of_40_s),
    ]


def recorded_bars():
    """37 logs in each way of recording: how many have to be right, and how many may have a false name."""
    found = []
    for way, right, false in (("without position", 30, 0), ("250 Hz", 35, 1), ("jitter", 35, 1), ("0.1 Nm steps", 35, 1),
                              ("libfranka", 35, 1)):
        of_way = {"studies": ("recorded",), "also": lambda r, way=way: r["recorded"] == way}
        found += [Bar(f"{way}: names exactly right", f"{right} of 37", test=lambda r: r["exact"],
                      low=right / 37, **of_way),
                  Bar(f"{way}: a false name", f"at most {false} of 37", test=lambda r: bool(r["false"]),
                      high=false / 37, **of_way)]
    return found


HEAD = ["criterion", "required", "measured", "95 % interval", "met"]


def markdown(head, body):
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *body])


def shown(name, found):
    """For the page, without the intervals; everything in a file."""
    short = [[*line[:2], line[2].replace(" = ", ", ") + (" (**not met**)" if "no" in line[4] else "")] for line in found]
    return markdown(HEAD[:3], short) + "\n\n" + page_tables.detail(name, "With 95 % intervals", markdown(HEAD, found))


def lines(rows, told):
    found = [bar.line(rows) for bar in bars(rows, told)]
    return [*found[:7], gap_line(rows), *found[7:]]


def recorded_lines(rows):
    return [bar.line(rows) for bar in recorded_bars()]
