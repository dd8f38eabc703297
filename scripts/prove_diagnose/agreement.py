# SPDX-License-Identifier: MIT
"""Do the tool's catalogue and this generator mean the same by each effect? Two programs, one page of formulas.

For every effect that is certain (no chance, no rounding) the residual of the complete truth along the measured motion
is compared with that of the same joint without the effect, which holds the noise of torque and acceleration.
"""

import json
import pathlib
import tempfile

from . import cases, score, strengths, tool


def residuals(program, case, folder):
    base, hidden = case.truth()
    log, model = folder / "log.npy", folder / "model.json"
    case.log("train").save(log)
    found = []
    for truth in (base, base + hidden):
        model.write_text(json.dumps(tool.as_model(truth)))
        found.append(tool.residual_nm(program, model, log))
    cases.without_hidden(case).log("train").save(log)
    model.write_text(json.dumps(tool.as_model(base)))
    return [*found, tool.residual_nm(program, model, log)]


def rows(program):
    """[(effect, Nm of residual without the effect, with it, and of the joint that has none)]"""
    found = []
    with tempfile.TemporaryDirectory(prefix="prove-diagnose-") as name:
        for study in ("single", "rarer"):
            for case in cases.studies(study, 1):
                if score.explainable(case.truth()[1]):
                    found.append((case.label, *residuals(program, case, pathlib.Path(name))))
    return found


def text(found):
    lines = [f"{'effect':28} {'without':>8} {'with':>8} {'floor':>8}  Nm rms"]
    return "\n".join(lines + [f"{label:28} {a:8.4f} {b:8.4f} {c:8.4f}" for label, a, b, c in found]) + "\n"
