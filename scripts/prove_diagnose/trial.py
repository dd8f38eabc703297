# SPDX-License-Identifier: MIT
"""One case from its logs to its scores."""

import json
import math
import pathlib
import shutil
import tempfile

from . import cases, measured, other_formulas, reach, recordings, score, strengths, tool, two_mass, yardsticks


# A diagnosis that does not come counts as wrong in every way that can be counted.
NO_ANSWER = {"verdict": "no answer", "seconds": tool.LONGEST_S, "exact": False, "in_set": False, "false": [],
             "named": ["no answer"], "parameters": [], "unexplained": 0, "place": False, "told": 0.0, "lowers": None,
             "reopens": None, "gap": {"closed": 0.0, "as_said": False}}


def write_files(case, folder):
    """train.npy, validate.npy, base.json and truth.json; the logs too."""
    folder.mkdir(parents=True, exist_ok=True)
    base, hidden = case.truth()
    effects = tool.BASE["effects"][::-1] if case.variant == "list reversed" else tool.BASE["effects"]
    (folder / "base.json").write_text(json.dumps({**tool.MODEL, "effects": effects}))
    (folder / "truth.json").write_text(json.dumps({**tool.MODEL, "effects": base + hidden}, indent=2))
    logs = {purpose: case.log(purpose) for purpose in ("train", "validate")}
    halves = {"first half": (0.0, 0.5), "second half": (0.5, 1.0)}
    if case.variant in halves:
        logs["train"] = logs["train"].part(*halves[case.variant])
    units = cases.OTHER_UNITS if case.variant == "other units" else cases.HEADERS.get(case.header)
    for purpose, log in logs.items():
        recordings.recorded(log, case, purpose).save(folder / f"{purpose}.npy", units)
    return logs


def floor_nm(program, case, base, hidden, folder):
    """The smallest residual that the validation log allows: that of the whole truth along its measured motion.

    The truth of another formula has no words in model.json; there the same log with nothing hidden stands for it.
    """
    log = folder / "validate.npy"
    foreign = case.other or case.physics
    if foreign or case.recorded == "without position":
        plain = cases.without_hidden(case) if foreign else case
        hidden, log = [] if foreign else hidden, folder / "plain.npy"
        plain.log("validate").save(log)
    model = folder / "floor.json"
    model.write_text(json.dumps(tool.as_model(base + hidden)))
    return tool.residual_nm(program, model, log)


def gaps(program, case, found, train, validate, floor, folder):
    if case.recorded:  # the angle of such a log is what the diagnosis makes of it
        said, counted = found["gap"], score.explainable(case.truth()[1])
        before, after = said["validation_before_nm"], said["validation_after_nm"]
        return {"before_nm": before, "after_nm": after, "floor_nm": floor, "as_said": None,
                "closed": score.share_closed(before, after, floor) if counted else None}
    after = tool.residual_nm(program, folder / "improved.json", folder / "validate.npy")
    before = measured.baseline_gap_nm(train, validate)
    said = found["gap"]
    counted = score.explainable(case.truth()[1]) and not case.disturbance
    return {"before_nm": before, "after_nm": after, "floor_nm": floor, "said_after_nm": said["validation_after_nm"],
            "as_said": abs(after - said["validation_after_nm"]) <= 0.1 * said["validation_after_nm"],
            "before_as_said": abs(before - said["validation_before_nm"]) <= 0.1 * before,
            "closed": score.share_closed(before, after, floor) if counted else None}


def laws(program, case, found, folder):
    """Does each name lower the residual, and does taking it out of the improved model open its share again?"""
    confirmed = [entry for entry in found["rounds"] if entry["status"] == "confirmed"]
    lower = [entry["gap_after_nm"] <= entry["gap_before_nm"] for entry in found["rounds"]]
    after, shorter, opens = found["gap"]["after_nm"], folder / "shorter.json", []
    for entry in [] if case.recorded else confirmed:
        wanted = score.key(entry["effect"], entry["parameters"])
        kept = [e for e in found["model"]["effects"] if score.key(e["effect"], e) != wanted]
        shorter.write_text(json.dumps({**found["model"], "effects": kept}))
        least = math.hypot(after, entry["evidence"]["share_nm"])
        opens.append(tool.residual_nm(program, shorter, folder / "train.npy") >= 0.9 * least)
    # A share is of the rows that no fault of the converter spoiled; simulate counts all, and clipped ones hardly open.
    return {"lowers": all(lower) if lower else None, "reopens": all(opens) if opens and not found["faults"] else None}


def judged_yardsticks(case, acceptable, hidden, train, validate, floor):
    rows, truth = {}, score.truth_keys(hidden)
    for method, (found, after) in yardsticks.judge(train, validate).items():
        right = {k for k in found if k[0] in acceptable} if acceptable else found & truth
        exact = (bool(right) and found == right) if acceptable else found == truth
        closed = score.share_closed(measured.baseline_gap_nm(train, validate), after, floor)
        rows[method] = {"exact": exact, "false": len(found - right),
                        "closed": closed if score.explainable(hidden) and not case.disturbance else None}
    return rows


def diagnosed(program, case, folder, options, logs, acceptable):
    """What the diagnosis says, counted; the diagnosis itself under "found"."""
    hidden = case.truth()[1]
    without = ["--without", case.without] if case.without else []
    found, seconds = tool.diagnose(program, folder, [*options, *without])
    row = {"verdict": found["verdict"], "told_wrong": found.get("wrong_percent"), "seconds": seconds, "samples": len(logs["train"].time_s),
           **score.names(case, acceptable, hidden, found, recordings.BROUGHT.get(case.recorded, ())),
           "parameters": score.parameters(hidden, found, case.seconds),
           "unexplained": len(found["unexplained"]), **laws(program, case, found, folder), "found": found}
    if case.recorded == "without position":  # where it began is its own
        row["parameters"] = [p for p in row["parameters"] if p["relative"] is not None]
    if case.disturbance:
        row["disturbance_s"] = logs["train"].place_s
        row["place"] = score.place(case, logs["train"].place_s, found)
    if case.without:
        plain = cases.without_hidden(case).log("train")
        row["told"] = reach.share_told(found["unexplained"], logs["train"], plain)
    return row


def scores(program, case, folder, options, methods):
    base, hidden = case.truth()
    acceptable = other_formulas.OTHERS[case.other](case.rng("other")).acceptable if case.other else ()
    acceptable = two_mass.JOINTS[case.physics].acceptable if case.physics else acceptable
    logs = write_files(case, folder)
    if case.study == "nulls":  # names are counted and nothing else
        row = diagnosed(program, case, folder, options, logs, acceptable)
        named = row.pop("found")["named"]
        return {**row, "brought": [name for name in named if name in recordings.BROUGHT.get(case.recorded, ())],
                "gap": {"closed": None, "as_said": None}}
    train, validate = (measured.Measured(log, strengths.GEAR_RATIO) for log in logs.values())
    floor = floor_nm(program, case, base, hidden, folder)
    row = {}
    if "diagnose" in methods:
        row = diagnosed(program, case, folder, options, logs, acceptable)
        row["gap"] = gaps(program, case, row.pop("found"), train, validate, floor, folder)
    if "yardsticks" in methods:
        row["yardsticks"] = judged_yardsticks(case, acceptable, hidden, train, validate, floor)
    return row


def failed(row):
    if "error" in row or "named" not in row:
        return "error" in row
    if row["study"].startswith("outside"):
        return bool(row["false"]) or not row["place"]
    if row["study"] == "without":
        return bool(row["named"]) or row["told"] < reach.ENOUGH
    return not row["exact"] or False in (row["gap"]["as_said"], row["lowers"], row["reopens"])


def trial(program, case, options=(), methods=("diagnose",), keep=None):
    """The scores of a case; keep: a folder in which the files of those that fail are left."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="prove-diagnose-"))
    about = {"study": case.study, "label": case.label, "case": case.name, "motion": case.motion, "noise": case.noise,
             "variant": case.variant, "recorded": case.recorded or case.header}
    try:
        row = {**about, **scores(program, case, folder, options, methods)}
    except (tool.ToolFailed, KeyError, TypeError, ValueError) as failure:
        row = {**about, "error": f"{type(failure).__name__}: {failure}", **(NO_ANSWER if "diagnose" in methods else {})}
    if keep and failed(row):
        shutil.rmtree(keep / case.name, ignore_errors=True)
        shutil.copytree(folder, keep / case.name)
    shutil.rmtree(folder)
    return row
