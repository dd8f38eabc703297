# SPDX-License-Identifier: MIT
"""Which cases the whole proof has, and in what order they run.

A run may be cut off at any time. So the studies advance together: after a tenth of the run each has a tenth of its
cases, and within a study every effect has had its first log before any has its second.
"""

import dataclasses

from . import cases, recordings

# How many of each kind: 5 of each single effect, 40 pairs, 200 logs with nothing hidden, ...
SEEDS = {"single": 5, "rarer": 2, "pair": 40, "triple": 30, "null": 200, "null ar0.5": 20, "null t4": 20, "outside": 15,
         "outside+single": 5, "formula": 2, "noise": 1, "poor": 1, "variant": 1, "without": 1}
# Run when asked for: the same logs as another recorder writes them, nothing hidden in noise of ten kinds, and joints from physics.
ALL = {**SEEDS, "recorded": 1, "nulls": 300, "physics": 3}


WAYS = tuple(recordings.WAYS)  # of recording the same log


def study(name, seeds, first):
    """The cases of one study, the first of every kind before the second of any."""
    return sorted(cases.studies(name, seeds, first), key=lambda case: case.number)


def planned(names, seeds=None, first=0):
    """The cases of several studies, taken in turns so that each study advances in proportion to its size."""
    unknown = [name for name in names if name not in ALL]
    if unknown:
        raise SystemExit(f"prove-diagnose: there is no study '{unknown[0]}'; there are: {', '.join(ALL)}")
    found = [(k / len(all_of), case) for name in names for all_of in [study(name, seeds or ALL[name], first)]
             for k, case in enumerate(all_of, 1)]
    return [case for _, case in sorted(found, key=lambda pair: pair[0])]


def as_recorded(case, way):
    """The same case as another recorder writes it; a header alone is the case's own, and "" leaves the case as it is."""
    if not way:
        return case
    return dataclasses.replace(case, header=way) if way in cases.HEADERS else dataclasses.replace(case, recorded=way)


def by_name(name):
    """The case of that name."""
    number = name.rpartition("-")[2]
    for known in ALL if number.isdigit() else ():
        first = int(number)
        several = cases.studies(known, 1, first // cases.RECORDED["pair"]) if known == "recorded" else []
        for case in cases.studies(known, 1, first) + several:
            for way in ("", *recordings.WAYS):
                if as_recorded(case, way).name == name:
                    return as_recorded(case, way)
    raise SystemExit(f"prove-diagnose: there is no case '{name}'")


def in_table_order(rows):
    """Scores sorted as tables list them: by study, then as the catalogue lists effects, then by number."""
    kinds = [(c.study, c.label, c.variant, c.motion, c.noise, c.recorded if name == "nulls" else "") for name in ALL for c in cases.studies(name, 1)]
    places = {kind: k for k, kind in enumerate(kinds)}
    studies = {name: min(k for k, kind in enumerate(kinds) if kind[0] == name) for name in ALL}

    def place(row):
        way = row["recorded"] if row["study"] == "nulls" else ""
        kind = (row["study"], row["label"], row["variant"], row["motion"], row["noise"], way)
        return places.get(kind, studies[row["study"]]), int(row["case"].rpartition("-")[2])

    return sorted(rows, key=place)
