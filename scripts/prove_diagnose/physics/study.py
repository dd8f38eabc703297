# SPDX-License-Identifier: MIT
"""Effects hidden in joints that are integrated from their equations of motion: `prove-diagnose --physics`.

Nothing of the catalogue's formulas is shared: friction, ripple, resonance and delay arise in joint.cpp. Each case comes in three
forms: beside a model whose values are left out, beside a simulation whose scale is fitted, and beside one whose scale is kept.
"""

import dataclasses
import pathlib
import shutil
import subprocess
import tempfile

from .. import score, tool
from . import baseline, cases, catalogue, tables

TOLERANCE = 0.025  # of an order, within which it is the same
GROWTH = 1.001  # of a gap that counts as larger


def matches(name, key):
    """Whether a finding (effect, order) agrees with an expected name; an order of None agrees with any."""
    return name[0] == key[0] and (name[1] is None or key[1] is None or abs(key[1] - name[1]) <= TOLERANCE * name[1])


def found_keys(found):
    """(effect, order or None) of each confirmed finding; a name without an entry of its own has no order."""
    entries = [e for e in found.get("rounds", []) if e.get("status") == "confirmed"] + found.get("faults", [])
    keys = {score.key(e["effect"], e.get("parameters", {})): e for e in entries if e["effect"] in found["named"]}
    with_entry = {key[0] for key in keys}
    return keys | {(name, None): {} for name in found["named"] if name not in with_entry}


def judged(required, allowed, keys):
    """Whether the names are exactly right, and which of them are false."""
    wrong = [key for key in keys if not any(matches(name, key) for name in [*allowed, *(n for group in required for n in group)])]
    whole = all(any(matches(name, key) for name in group for key in keys) for group in required)
    return {"exact": whole and not wrong, "false": score.words(wrong)}


def intervals(truth, keys):
    """For each true value of a named effect: whether the 95 % interval contains it; None without an interval."""
    rows = []
    for (effect, order, parameter), true in truth.items():
        for key, entry in keys.items():
            given = entry.get("parameters", {}).get(parameter)
            if not matches((effect, order), key) or not isinstance(given, dict):
                continue
            ends = given.get("ci95")
            turn = 360.0 * round((given["value"] - true) / 360.0) if parameter == "phase_deg" else 0.0
            held = None if not ends or None in ends else bool(ends[0] <= true + turn <= ends[1])
            rows.append({"parameter": f"{effect}.{parameter}", "true": float(true), "value": given["value"], "ci95": ends, "held": held})
            break
    return rows


def grown(found):
    """Gaps that are larger after the diagnosis than before: of training log, validation log and confirmed rounds."""
    gap, larger = found["gap"], []
    for log in ("", "validation_"):
        before, after = gap.get(f"{log}before_nm"), gap.get(f"{log}after_nm")
        if before is not None and after is not None and after > GROWTH * before:
            larger.append(f"{(log or 'training_')[:-1]} gap {before:.4g} to {after:.4g}")
    for number, entry in enumerate(found.get("rounds", []), 1):
        before, after = entry.get("gap_before_nm"), entry.get("gap_after_nm")
        if entry.get("status") == "confirmed" and None not in (before, after) and after > GROWTH * before:
            larger.append(f"round {number} {before:.4g} to {after:.4g}")
    return larger


def diagnosed(program, case, folder, options):
    """The diagnosis and its processor time."""
    before = tool.cpu_seconds()
    options = [*(folder / option if option == "base.json" else option for option in case.options()), *options]
    found = tool.run(program, "diagnose", folder / "train.npy", *options, "--validate", folder / "validate.npy", "--json", "--force",
                     "--improved-model", folder / "improved.json")
    return found, tool.cpu_seconds() - before


def failed(row):
    return not row["exact"] or bool(row["grown"])


@dataclasses.dataclass(frozen=True)
class Study:
    forms: tuple = cases.FORMS
    options: tuple = ()
    nulls: int | None = None
    kinds: tuple = ()
    rough: bool = False
    seeds = 5

    def chosen(self, first, seeds):
        """Cases by form; nulls, unless their number is given, are forty times as many as the seeds."""
        nulls = 40 * seeds if self.nulls is None else self.nulls
        return [case for case in cases.planned(first, seeds, self.forms, nulls, catalogue.labels(), self.rough)
                if not self.kinds or case.kind in self.kinds]

    def trial(self, program, case, keep=None):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="prove-physics-"))
        row = {"study": "dynamics", "case": case.name, "form": case.form, "friction": case.friction, "kind": case.kind,
               "label": case.label, "named": [], "false": [], "exact": False, "grown": [], "parameters": [], "sizes": []}
        try:
            logs, limit = case.write(folder)
            required, allowed = case.right()
            row.update(sizes=case.setting().sizes, rows=len(logs["train"]["time_s"]), rate_hz=case.setting().rate_hz)
            own = baseline.names(case, logs)
            row["baseline"] = {"named": score.words(own), **judged(required, allowed, own)}
            found, row["seconds"] = diagnosed(program, case, folder, self.options)
            keys = found_keys(found)
            row.update(verdict=found["verdict"], named=score.words(keys), **judged(required, allowed, keys), grown=grown(found),
                       parameters=intervals(case.truth(limit), keys), gap=found["gap"],
                       rounds=[f"{e['effect']}: {e.get('status')}" for e in found.get("rounds", [])])
        except (tool.ToolFailed, KeyError, TypeError, ValueError, subprocess.CalledProcessError) as failure:
            row["error"] = f"{type(failure).__name__}: {failure}"
        if keep and failed(row):
            shutil.rmtree(keep / case.name, ignore_errors=True)
            shutil.copytree(folder, keep / case.name)
        shutil.rmtree(folder)
        return row

    @staticmethod
    def blocks(about, rows):
        return tables.blocks(about, rows)

    @staticmethod
    def write(case, folder):
        folder.mkdir(parents=True, exist_ok=True)
        case.write(folder)

    @staticmethod
    def answer(row):
        """One-line summary of a row, for the progress output."""
        return (", ".join(row["named"]) or "nothing") + ("" if row["exact"] else " WRONG") + ("".join(f"; {g}" for g in row["grown"]))
