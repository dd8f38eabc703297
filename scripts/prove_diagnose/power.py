# SPDX-License-Identifier: MIT
"""How small an effect may be and still be named, and what it is mistaken for.

The size of a hidden effect is what it changes in the torque of the log, as rms over the whole log, in units of the noise's rms (for
a fault of the converter, what it changes in torque and noise together). Each effect is drawn as in the other studies, and one number
of it (SIZE) is then set so that it has that size: the same joint, motion and noise in each column of a number.
"""

import collections
import dataclasses
import json
import math
import pathlib
import shutil
import tempfile

import numpy as np

import page_tables

from . import bars, cases, joint, motion, score, sensor, strengths, table, tool

SIZES = (0.1, 0.2, 0.4, 0.8, 1.5, 3.0)
# The numbers that make an effect larger; below 0: smaller. What no torque of a log shows, velocity-bias and encoder-eccentricity, is left out.
SIZE = {"offset": ("torque_nm", 1), "drift": ("rate_nm_s", 1), "gravity": ("amplitude_nm", 1), "coulomb-friction": ("torque_nm", 1),
        "viscous-friction": ("coefficient_nm_per_deg_s", 1), "stribeck-friction": ("torque_nm", 1), "ripple": ("amplitude_nm", 1),
        "output-ripple": ("amplitude_nm", 1), "tone": ("amplitude_nm", 1), "ripple-speed-dependence": ("gain_percent", 1),
        "ripple-load-dependence": ("gain_percent_per_nm", 1), "ripple-modulation": ("depth_percent", 1), "resonance": ("frequency_hz", -1),
        "hysteresis": ("torque_nm", 1), "delay": ("delay_s", 1), "lag": ("time_constant_s", 1), "saturation": ("limit_nm", -1),
        "quantization": ("step_nm", 1), "spikes": ("size_nm", 1), "dropout": ("milliseconds", 1), "gear-ratio": ("error_percent", 1),
        "quadratic-viscous-friction": ("coefficient_nm_per_deg2_s2", 1), "load-friction": ("torque_nm", 1),
        "ripple-direction-dependence": ("gain_percent", 1), "start-stop-ringing": ("amplitude_nm", 1),
        "asymmetric-friction": ("difference_nm", 1), "asymmetric-viscous-friction": ("difference_nm_per_deg_s", 1),
        "backlash": ("torque_nm", 1), "friction-warm-up": ("change_nm", 1),
        "position-dependent-friction": ("amplitude_nm", 1), "payload-change": ("cosine_nm", 1), "sensor-lowpass": ("cutoff_hz", -1)}
ALSO = {"ripple-direction-dependence": ("phase_deg",), "payload-change": ("inertia_kgm2", "sine_nm")}  # grow with it


def scaled(effect, factor):
    name, sense = SIZE[effect["effect"]]
    by = {key: factor**sense for key in (name, *ALSO.get(effect["effect"], ()))}
    return {key: [by[key] * v for v in value] if key in by and isinstance(value, list) else by.get(key, 1.0) * value
            if key in by else value for key, value in effect.items()}


@dataclasses.dataclass(frozen=True)
class Sized(cases.Case):
    size: float = 0.0  # of the noise's rms
    given: tuple = ()  # the hidden effect at that size

    @property
    def log_of(self):
        return super().name

    @property
    def name(self):
        return f"{self.study}-{self.label}-{self.size:g}-{self.number}"

    def truth(self):
        return strengths.base_joint(self.rng("joint")), list(self.given)


def drawn(case):
    rng = case.rng("joint")
    strengths.base_joint(rng)
    return strengths.draw(rng, case.label)


def change_nm(case, effect, travel, time, plain):
    """rms of what the effect changes."""
    base = case.truth()[0]
    if effect["effect"] in sensor.CONVERTER:
        noisy = plain + strengths.TORQUE_NOISE_NM * case.rng("sizing noise").standard_normal(len(time))
        other = sensor.convert(noisy, [effect], case.rng("sizing"))
        return float(np.sqrt(np.mean((other - noisy) ** 2)))
    torque = joint.torque(travel, base + [effect], strengths.GEAR_RATIO, time)
    return float(np.sqrt(np.mean((torque - plain) ** 2)))


def of_size(case):
    """The case with its effect at its size: by the secant, in logarithms."""
    effect, wanted = drawn(case), case.size * strengths.TORQUE_NOISE_NM
    rng = case.rng("train")
    travel = motion.MOTIONS[case.motion](rng, rng.uniform(-90.0, 90.0), case.seconds)
    time = np.arange(round(travel.duration_s * cases.SAMPLE_RATE_HZ)) / cases.SAMPLE_RATE_HZ
    plain = joint.torque(travel, case.truth()[0], strengths.GEAR_RATIO, time)
    low = -4.0 if SIZE[case.label][1] < 0 else -14.0  # logarithms of the factor, below and above; no resonance beyond 4 kHz
    high = 7.0
    at, steep = 0.0, 1.0
    for _ in range(14):
        found = change_nm(case, scaled(effect, math.exp(at)), travel, time, plain)
        off = math.log(max(found, 1e-9) / wanted)
        if abs(off) < 0.03:
            break
        low, high = (low, at) if off > 0 else (at, high)
        after = at - off / steep
        at = after if low < after < high else (low + high) / 2
    return dataclasses.replace(case, given=(scaled(effect, math.exp(at)),)), found / strengths.TORQUE_NOISE_NM


def chosen(first, seeds, only=None):
    labels = [label for label in SIZE if not only or label in only]
    return [Sized("power", label, number, size=size) for number in range(first, first + seeds) for label in labels for size in SIZES]


def trial(program, case, keep=None):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="prove-power-"))
    row = {"study": "power", "case": case.name, "label": case.label, "size": case.size}
    try:
        case, row["reached"] = of_size(case)
        (folder / "base.json").write_text(json.dumps(tool.BASE))
        (folder / "truth.json").write_text(json.dumps(case.truth(), indent=2))
        for purpose in ("train", "validate"):
            case.log(purpose).save(folder / f"{purpose}.npy")
        found, row["seconds"] = tool.diagnose(program, folder)
        names = score.names(case, (), list(case.given), found)
        wanted = score.words(score.truth_keys(case.given))[0]
        row.update(verdict=found["verdict"], named=names["named"], false=names["false"], right=wanted in names["named"],
                   offered=names["in_set"] and wanted not in names["named"])
    except (tool.ToolFailed, KeyError, ValueError) as failure:
        row["error"] = f"{type(failure).__name__}: {failure}"
    if keep and ("error" in row or row["false"]):
        shutil.rmtree(keep / case.name, ignore_errors=True)
        shutil.copytree(folder, keep / case.name)
    shutil.rmtree(folder)
    return row


def mistaken(rows):
    """What was named that is not there, and at which sizes."""
    places = collections.defaultdict(collections.Counter)
    for row in rows:
        for name in row["false"]:
            places[name][row["size"]] += 1
    return "; ".join(f"{name} ({', '.join(f'{count} at {size:g}' for size, count in sorted(counts.items()))})"
                     for name, counts in sorted(places.items())) or "nothing"


def line(text, rows):
    cells = []
    for size in SIZES:
        of = [row for row in rows if row["size"] == size]
        offered = sum(row["offered"] for row in of)
        cells.append(f"{sum(row['right'] for row in of)}/{len(of)}{f' +{offered}' if offered else ''}")
    return [text, *cells, mistaken(rows)]


def named_from(lines):
    """{size: effects that are named in every log from that size on}; None for those that are not at the largest."""
    found = {size: [] for size in (*SIZES, None)}
    for label, *cells, _ in lines:
        right = [cell.partition("/")[0] == cell.partition("/")[2] for cell in cells]
        below = max((k for k, every in enumerate(right) if not every), default=-1)
        found[(*SIZES, None)[below + 1]].append(label)
    return {size: labels for size, labels in found.items() if labels}


def blocks(about, rows):
    answered = [row for row in rows if "error" not in row]
    lines = [line(label, of) for label in SIZE if (of := [row for row in answered if row["label"] == label])]
    shown = [[f"{size:g}" if size else "none of them", ", ".join(labels)] for size, labels in named_from(lines).items()]
    whole = line("**all**", answered)
    whole[-1] = f"a false name in {sum(bool(row['false']) for row in answered)} of {len(answered)}"
    chance = [f"{100 * least:.0f} to {100 * most:.0f} %" for least, most in (bars.wilson(*counts(answered, size)) for size in SIZES)]
    sizes = [f"{size:g}" for size in SIZES]
    body = table.joined(table.markdown(["size", "effects named in every log of this size and of all larger ones"], shown),
                        table.markdown(["hidden", *sizes, "reported instead"], [whole, ["95 % interval", *chance, ""]]),
                        page_tables.detail("diagnose-sizes", "Each effect", table.markdown(["hidden", *(f"size {size}" for size in sizes), "reported instead"], lines)))
    errors = "".join(f"\n\n* {row['case']}: {row['error']}" for row in rows if "error" in row)
    return {"power": f"{about}\n\n{body}{errors}"}


def counts(rows, size):
    of = [row["right"] for row in rows if row["size"] == size]
    return sum(of), max(1, len(of))
