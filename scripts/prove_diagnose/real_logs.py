# SPDX-License-Identifier: MIT
"""diagnose on logs of real robots, whose truth nobody knows: what it names, and what that is worth on other rows.

The logs are not part of this repository. Where a robot has one log, the first 60 % of its rows are for the fit and the
rest for validation; the KUKA has two recordings, of which the second validates.
"""

import json
import pathlib
import tempfile

import page_tables

from . import table, tool

# robot, training log, validation log (None: the end of the same), gear ratio, words that pick the joint
LOGS = (("Franka Panda J1", "gpl3/panda_gaz_j1.csv", None, 120, ()),
        ("Franka Panda J4", "gpl3/panda_gaz_j4.csv", None, 120, ()),
        ("Neura LARA 8 J3", "neura_lara8_j3.csv", None, 101, ()),
        ("Neura LARA 8 J3, without position", "neura_lara8_j3.csv", None, 101, ()),
        ("KUKA KR300 J4", "kuka_kr300_trajA_all.csv", "kuka_kr300_trajB_all.csv", 221, ("--joint", "j4")),
        ("KUKA KR300 J6", "kuka_kr300_trajA_all.csv", "kuka_kr300_trajB_all.csv", 206793 / 1340, ("--joint", "j6")),
        ("UR10 shoulder pan", "ur10_unisa_exciting_all.csv", None, 101, ("--joint", "shoulder_pan_joint")))
MODELS = (("inertia and ripple", tool.BASE["effects"]), ("inertia alone", tool.BASE["effects"][:1]))


def parts(path, folder, blind):
    """The log cut in two files after 60 % of its rows; blind: time, velocity and torque alone, which come first."""
    rows = path.read_text().splitlines()
    if blind:
        rows = [",".join(row.split(",")[:3]) for row in rows]
    header, *rows = rows
    cut = round(0.6 * len(rows))
    files = [folder / "train.csv", folder / "validate.csv"]
    for file, part in zip(files, (rows[:cut], rows[cut:])):
        file.write_text("\n".join([header, *part]) + "\n")
    return files


def diagnosed(program, robot, logs, ratio, effects, words, folder):
    model = folder / "base.json"
    model.write_text(json.dumps({**tool.MODEL, "gear_ratio": ratio, "effects": effects}))
    before = tool.cpu_seconds()
    found = tool.run(program, "diagnose", logs[0], "--model", model, "--validate", logs[1], "--json", "--force", "--improved-model",
                     folder / "improved.json", *words)
    return found, tool.cpu_seconds() - before


def helped(entry):
    """What a finding does to the rows that it was not fitted to, where that is worth telling: a fifth or more."""
    before, after = entry.get("validation_before_nm"), entry.get("validation_after_nm")
    return f"; {before:.3g} → {after:.3g} on the validation rows" if before and after < 0.8 * before else ""


def listed(found):
    """Confirmed names, then what else was found or could not be examined, with its status."""
    names = [entry["effect"] for entry in found["rounds"] if entry["status"] == "confirmed"]
    names += [entry["effect"] for entry in found["faults"]]
    others = [f"{entry['effect']} ({entry['status']}{helped(entry)})" for entry in found["rounds"]
              if entry["status"] != "confirmed"]
    others += [f"{entry['effect']} (not decidable)" for entry in found.get("undecidable", [])]
    return ", ".join(names) or "none", ", ".join(others) or "none"


def line(robot, model, found, seconds):
    gap = found["gap"]
    return [robot, model, f"{gap['before_nm']:.3g} → {gap['after_nm']:.3g}", f"{gap['noise_floor_nm']:.3g}",
            f"{gap['validation_before_nm']:.3g} → {gap['validation_after_nm']:.3g}", *listed(found),
            f"{found['remaining']['rms_nm']:.3g}" if found["remaining"] else "-", found["verdict"], f"{seconds:.1f} s"]


def tables(program, folder):
    """One line for each log and model; logs that are not there are said to be."""
    head = ["robot", "model", "residual, Nm", "noise floor, Nm", "residual on the validation rows, Nm", "confirmed",
            "not confirmed", "remaining, Nm", "verdict", "time"]
    lines = []
    for robot, train, validate, ratio, words in LOGS:
        if not (folder / train).exists():
            lines.append([robot, "no such log here"] + [""] * (len(head) - 2))
            continue
        for model, effects in MODELS:
            with tempfile.TemporaryDirectory(prefix="prove-diagnose-") as name:
                place = pathlib.Path(name)
                logs = ((folder / train, folder / validate) if validate
                        else parts(folder / train, place, "without position" in robot))
                try:
                    lines.append(line(robot, model, *diagnosed(program, robot, logs, ratio, effects, words, place)))
                except (tool.ToolFailed, KeyError, TypeError) as failure:
                    lines.append([robot, model, f"{type(failure).__name__}: {failure}"] + [""] * (len(head) - 3))
    return table.joined(short(head, lines), page_tables.detail("diagnose-real-logs", "Both models and all columns", table.markdown(head, lines)))


def short(head, lines):
    """For the page: the first model, without what is not confirmed."""
    kept = (0, 2, 4, 5, 8)
    return table.markdown([head[k] for k in kept], [[line[k] for k in kept] for line in lines if line[1] == MODELS[0][0] or not line[2]])
