# SPDX-License-Identifier: MIT
"""What half and twice of each rule of the diagnosis does to right, missed and false names."""

import concurrent.futures
import pathlib
import re
import subprocess
import sys
import tempfile

from . import plan, other_formulas, score, table, tool, trial

# A small part of each kind of log. Easy ones show what breaks a diagnosis; those at the edge, where the truth is of another
# formula or the motion is poor, what bends it: a rule that moves nothing on them hardly decides anything.
SMALL = {"single": ("tone", "delay", "quantization"), "pair": (), "triple": (), "null": (), "outside": ("contact pulse",),
         "formula": ("asymmetric Coulomb friction", "LuGre friction"), "poor": ("offset",)}


def rules(program):
    """{name: (value, lowest, highest, whole)} as the program lists them."""
    done = subprocess.run([program, "diagnose", "--rules"], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"prove-diagnose: {program} lists no rules: {done.stderr.strip()}")
    rows = [re.split(r" {2,}", line.strip()) for line in done.stdout.splitlines()]
    place = {name: k for k, name in enumerate(rows[0])}
    return {row[0]: tuple(float(row[place[name]]) for name in ("is", "from", "to")) + (row[place["kind"]] == "whole",)
            for row in rows[1:]}


def moved(rule, factor):
    """The value times the factor, as near as its bounds and whole numbers let it come; None when it stays."""
    value, lowest, highest, whole = rule
    new = value * factor
    if whole:
        new = int(new)
    new = min(max(new, lowest), highest)
    return None if new == value else new


def small_set(first):
    cases = plan.planned(list(SMALL), 1, first)
    return [case for case in cases if not SMALL[case.study] or case.label in SMALL[case.study]]


def counted(case, found):
    """(right, missed, false) of one diagnosis."""
    hidden = case.truth()[1]
    acceptable = other_formulas.OTHERS[case.other](case.rng("other")).acceptable if case.other else ()
    names = score.names(case, acceptable, hidden, found)
    named = set(names["named"]) - set(names["false"])
    missed = int(not named) if acceptable else len(score.truth_keys(hidden)) - len(named)
    return int(names["exact"]), missed, len(names["false"])


def diagnosed(program, case, folder, options):
    """(right, missed, false, no answer)"""
    try:
        found = tool.run(program, "diagnose", folder / "train.npy", "--model", folder / "base.json", "--validate",
                         folder / "validate.npy", "--json", *options)
        return (*counted(case, found), 0)
    except (tool.ToolFailed, ValueError) as failure:
        print(f"{case.name} {' '.join(options)}: {failure}", file=sys.stderr)
        return 0, len(case.truth()[1]), 0, 1


def settings(program, chosen):
    """[(rule or None, factor, its new value, options)]; the first is the program as it is."""
    known = rules(program)
    unknown = [name for name in chosen if name not in known]
    if unknown:
        raise SystemExit(f"prove-diagnose: there is no rule '{unknown[0]}'; ripplenotch diagnose --rules lists them")
    found = [(None, 1.0, None, [])]
    for name in chosen or known:
        for factor in (0.5, 2.0):
            value = moved(known[name], factor)
            if value is not None:
                found.append((name, factor, value, ["--rule", f"{name}={value!r}"]))
    return found


def run(program, cases, chosen, options, jobs):
    """{(rule, factor): (new value, [sums of right, missed, false, no answer])}"""
    planned, sums = settings(program, chosen), {}
    with tempfile.TemporaryDirectory(prefix="prove-diagnose-") as folder, \
            concurrent.futures.ProcessPoolExecutor(jobs) as pool:
        folders = {case.name: pathlib.Path(folder) / case.name for case in cases}
        for case in cases:
            trial.write_files(case, folders[case.name])
        started = {(rule, factor): (value, [pool.submit(diagnosed, program, case, folders[case.name], [*options, *words])
                                            for case in cases])
                   for rule, factor, value, words in planned}
        for number, (key, (value, futures)) in enumerate(started.items(), 1):
            sums[key] = value, [sum(column) for column in zip(*(future.result() for future in futures))]
            print(f"{number}/{len(started)} {key[0] or 'as it is'} {'' if value is None else value}", file=sys.stderr, flush=True)
    return sums


def text(sums, logs, values):
    """The table; what differs from the program as it is stands out."""
    usual = sums[(None, 1.0)][1]

    def cells(key):
        if key not in sums:
            return ["-"] * 4
        value, counts = sums[key]
        told = [f"{counts[0]}/{logs}", *map(str, counts[1:3])]
        return [f"{value:g}", *(word if count == plain else f"**{word}**"
                                for word, count, plain in zip(told, counts, usual))]

    head = ["rule", "is", "half", "right", "missed", "false", "twice", "right", "missed", "false"]
    lines = [["as they are", "", "", f"{usual[0]}/{logs}", str(usual[1]), str(usual[2]), "", "", "", ""]]
    for rule in dict.fromkeys(rule for rule, _ in sums if rule):
        lines.append([rule, f"{values[rule][0]:g}", *cells((rule, 0.5)), *cells((rule, 2.0))])
    return table.markdown(head, lines)
