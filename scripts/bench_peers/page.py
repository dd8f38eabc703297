# SPDX-License-Identifier: MIT
"""The record of a run as the tables of docs/studies/performance.md."""

import page_tables

from .cases import TOOL
from .measure import Run, median

FIXED, SWITCHING = "filter: fixed notch, one channel", "filter: switching bank, one channel"
HYSTERESIS = "filter: switching bank, hysteresis of 1 deg/s"
WARM = "filter: switching bank, all nine warm"
WELCH = "spectra: Welch and its lines, segments of 4096"
SCIPY = {"fixed": "sosfilt, two sections", "switching": "sosfilt by segments", "hysteresis": "sosfilt by segments, hysteresis of 1 deg/s",
         "all nine": "sosfilt, all nine", "welch": "signal.welch, segments of 4096"}

BROKEN = "**no**"


def table(head, lines):
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *lines])


def figure(value):
    """Three digits: 0.0523, 1.52, 52.3, 1234."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def medians(case):
    return {side: median([Run(**one) for one in runs]) for side, runs in case["runs"].items()}


def rate(kernels, side, name):
    """Million a second by the median of processor seconds; None where it was not measured."""
    one = kernels[side].get(name)
    return one["work"] / sorted(one["cpu_s"])[len(one["cpu_s"]) // 2] / 1e6 if one and one["cpu_s"] else None


def ratio(case, side, other, what):
    """What the other needs over what `side` needs; None where one of them was not measured."""
    found = medians(case)
    return getattr(found[other], what) / getattr(found[side], what) if side in found and other in found else None


def at_least(what, must, unit, value):
    return [what, f"at least {must} {unit}", "-" if value is None else figure(value), met(value, lambda v: v >= must)]


def at_most(what, must, unit, value):
    return [what, f"at most {must} {unit}", "-" if value is None else figure(value), met(value, lambda v: v <= must)]


def met(value, holds):
    return "not measured" if value is None else "yes" if holds(value) else BROKEN


def peak(case):
    found = medians(case)
    return found[TOOL].peak_mib if TOOL in found else None


def promises(record):
    """Each line of what speed has to be, with what it is."""
    fixed, full, npy, kernels = record["fixed"], record["full"], record["npy"], record["kernels"]
    ours = {name: rate(kernels, "ripplenotch", name) for name in (FIXED, SWITCHING, HYSTERESIS, WARM, WELCH)}
    theirs = {name: rate(kernels, "scipy", name) for name in ("fixed", "switching", "hysteresis", "all nine", "welch")}

    def beside(mine, other):
        return ours[mine] / theirs[other] if ours[mine] and theirs[other] else None

    copied = ratio(fixed, "cp", TOOL, "wall_s"), ratio(npy, "cp", TOOL, "wall_s")
    return [
        at_least("CSV, 6 decimals: CPU time of pandas + SciPy, relative", 60, "times", ratio(fixed, TOOL, "pandas + SciPy", "cpu_s")),
        at_least("CSV, 6 decimals: CPU time of Polars without a filter, relative", 3, "times", ratio(fixed, TOOL, "Polars, no filter", "cpu_s")),
        at_most("CSV, 6 decimals: wall time relative to `cp`", 4, "times", copied[0]),
        at_most("CSV, 6 decimals: peak memory", 32, "MiB", peak(fixed)),
        at_least("CSV, 17 digits: CPU time of pandas + SciPy, relative", 25, "times", ratio(full, TOOL, "pandas + SciPy", "cpu_s")),
        at_least("CSV, 17 digits: CPU time of Polars without a filter, relative", 2, "times", ratio(full, TOOL, "Polars, no filter", "cpu_s")),
        at_most("npy: wall time relative to `cp`", 2, "times", copied[1]),
        at_most("npy: peak memory", 16, "MiB", peak(npy)),
        at_least("CSV of 100,000 rows, whole process: wall time of Octave, relative", 30, "times", ratio(record["short"], TOOL, "Octave", "wall_s")),
        at_least("fixed notch, one channel", 444, "Msamples/s", ours[FIXED]),
        at_least("fixed notch, one channel: relative to SciPy's sosfilt", 4, "times", beside(FIXED, "fixed")),
        at_least("switching bank, one channel, `transition=keep`: relative to SciPy by segments", 10, "times", beside(SWITCHING, "switching")),
        at_least("the same with a hysteresis of 1 deg/s", 10, "times", beside(HYSTERESIS, "hysteresis")),
        at_least("switching bank, one channel, all nine warm: relative to SciPy's all nine", 10, "times", beside(WARM, "all nine")),
        at_least("Welch, segments of 4096: relative to SciPy", 5, "times", beside(WELCH, "welch")),
    ]


def processes(record):
    lines = []
    names = {"fixed": "CSV, 6 decimals", "full": "CSV, 17 digits", "npy": "npy", "pipes": "CSV, 6 decimals, from pipe to pipe", "short": "CSV, 6 decimals"}
    for key, name in names.items():
        case, rows = record[key], 100_000 if key == "short" else record["rows"]
        for side, one in medians(case).items():
            lines.append([f"{name}, {rows:,} rows, {case['mb']:.0f} MB", side, figure(one.wall_s), figure(one.cpu_s),
                          figure(one.peak_mib), str(len(case["runs"][side]))])
    return page_tables.detail("performance-processes", "Medians of each program", table(["log", "program", "wall, s", "CPU, s", "peak, MiB", "runs"], lines))


def kernels(record):
    lines = []
    for side, found in record["kernels"].items():
        for name, one in found.items():
            lines.append([name if side == "ripplenotch" else SCIPY[name], side, figure(rate(record["kernels"], side, name)), str(len(one["cpu_s"]))])
    return page_tables.detail("performance-kernels", "Rate of each kernel", table(["kernel", "library", "million per CPU second", "passes"], lines))


def analysis(record):
    lines = []
    for name, case in record["analysis"].items():
        one = median([Run(**r) for r in case["runs"]]) if case["runs"] else None
        figures = [figure(one.wall_s), figure(one.cpu_s), figure(one.peak_mib)] if one else [", ".join(case["failed"].values()), "-", "-"]
        lines.append([f"`{name.split(', ')[0]}`, {name.split(', ')[1]}", f"{case['rows']:,}", *figures])
    return page_tables.detail("performance-analysis", "Medians of each command", table(["command", "rows", "wall, s", "CPU, s", "peak, MiB"], lines))


def growth(record):
    lines = []
    for case in record["growth"]:
        one, copy = (median([Run(**r) for r in case[key]]) if case[key] else None for key in ("runs", "copies"))
        each = f"{1e9 * one.cpu_s / case['rows'] / case['joints']:.0f}" if one else ", ".join(case["failed"].values())
        lines.append([f"{case['rows']:,}", str(case["joints"]), f"{case['mb']:.0f}",
                      *([figure(one.wall_s), figure(one.cpu_s), figure(one.peak_mib)] if one else ["-"] * 3), each,
                      figure(copy.cpu_s) if copy else "-"])
    head = ["rows", "joints", "MB", "wall, s", "CPU, s", "peak, MiB", "CPU, ns per row and joint", "CPU of `cp`, s"]
    return page_tables.detail("performance-growth", "Medians of each length", table(head, lines))


def raw(record):
    """All runs of programs and all passes of kernels, each in a file."""
    cases = [(key, side, runs) for key in ("fixed", "full", "npy", "pipes", "short") for side, runs in record[key]["runs"].items()]
    cases += [(name, TOOL, case["runs"]) for name, case in record["analysis"].items()]
    cases += [(f"{case['rows']} rows, {case['joints']} joints", TOOL, case["runs"]) for case in record["growth"]]
    runs = [[name, side, str(k), *(f"{run[key]:.{digits}f}" for key, digits in (("wall_s", 3), ("cpu_s", 3), ("peak_mib", 1)))]
            for name, side, found in cases for k, run in enumerate(found, 1)]
    passes = [[name, side, str(k), f"{1e3 * seconds:.2f}"] for side, found in record["kernels"].items() for name, one in found.items()
              for k, seconds in enumerate(one["cpu_s"], 1)]
    return "\n\n".join([page_tables.detail("performance-runs", "All runs of programs", table(["log", "program", "run", "wall, s", "CPU, s", "peak, MiB"], runs)),
                        page_tables.detail("performance-passes", "All passes of kernels", table(["kernel", "library", "pass", "CPU, ms"], passes))])


def machine(record):
    facts = [f"{record['date']}, ripplenotch {record['version']} ({record['commit']}).", record["machine"],
             "With " + ", ".join(f"{name} {version}" for name, version in record["peers"].items()) + "."]
    facts += [f"Not measured: {name} ({why})." for name, why in record["missing"].items()]
    apart = record["fixed"].get("differs_nm")
    if apart is not None:
        facts.append(f"The filtered torques of ripplenotch and of pandas + SciPy differ by at most {apart:.1e} Nm at six decimals.")
    return "\n".join(facts)


def analysis_alone(record):
    """The table of the commands that look for lines, with its own date and machine."""
    return {"analysis": f"{record['date']}, commit {record['commit']}, {record['machine']}\n\n{analysis(record)}"}


def tables(record):
    shown = [[what, required, value if met == "yes" else f"{value} ({met})"] for what, required, value, met in promises(record)]
    return {"machine": machine(record), "promises": table(["quantity", "required", "measured"], shown),
            "processes": processes(record), "kernels": kernels(record), "analysis": analysis(record), "growth": growth(record), "raw": raw(record)}
