# SPDX-License-Identifier: MIT
"""Effects of the catalogue hidden in simulated logs: one case from its logs to its scores, criteria and tables."""

import dataclasses
import json
import pathlib
import shutil
import statistics
import tempfile

import page_tables

from . import cases, score, table, tool

HIDDEN = ("single", "pair", "triple")
# A diagnosis that does not come counts as wrong in every way that can be counted.
NO_ANSWER = {"verdict": "no answer", "seconds": tool.LONGEST_S, "exact": False, "in_set": False, "false": [], "named": ["no answer"],
             "parameters": [], "place": False, "gap": {"closed": 0.0, "as_said": False}}


def write_files(case, folder):
    """train.npy, validate.npy, base.json and truth.json; the logs too."""
    folder.mkdir(parents=True, exist_ok=True)
    base, hidden = case.truth()
    (folder / "base.json").write_text(json.dumps(tool.BASE))
    (folder / "truth.json").write_text(json.dumps({**tool.MODEL, "effects": base + hidden}, indent=2))
    logs = {purpose: case.log(purpose) for purpose in ("train", "validate")}
    for purpose, log in logs.items():
        log.save(folder / f"{purpose}.npy")
    return logs


def floor_nm(program, case, folder):
    """The smallest residual that the validation log allows: that of the whole truth along its measured motion."""
    base, hidden = case.truth()
    model = folder / "floor.json"
    model.write_text(json.dumps(tool.as_model(base + hidden)))
    return tool.residual_nm(program, model, folder / "validate.npy")


def gaps(program, case, found, folder):
    said, after = found["gap"], tool.residual_nm(program, folder / "improved.json", folder / "validate.npy")
    counted = score.explainable(case.truth()[1]) and not case.disturbance
    return {"said_after_nm": said["validation_after_nm"], "after_nm": after,
            "as_said": abs(after - said["validation_after_nm"]) <= 0.1 * said["validation_after_nm"],
            "closed": score.share_closed(said["validation_before_nm"], after, floor_nm(program, case, folder)) if counted else None}


def scores(program, case, folder, options):
    logs, hidden = write_files(case, folder), case.truth()[1]
    found, seconds = tool.diagnose(program, folder, options)
    return {"verdict": found["verdict"], "seconds": seconds, **score.names(hidden, found),
            "parameters": score.parameters(hidden, found, case.seconds), "gap": gaps(program, case, found, folder),
            "place": score.place(case, logs["train"].place_s, found) if case.disturbance else None}


def failed(row):
    if row["study"] == "outside":
        return bool(row["false"]) or not row["place"]
    return not row["exact"] or row["gap"]["as_said"] is False


def gap_line(rows):
    shares = sorted(r["gap"]["closed"] for r in rows if r["study"] in HIDDEN and r["gap"]["closed"] is not None)
    if not shares:
        return ["gap closed on the validation log, median", "at least 98 %", "no logs", "-", "-"]
    middle, worst = statistics.median(shares), shares[len(shares) // 10]
    return ["gap closed on the validation log, median", "at least 98 %", f"{100 * middle:.1f} % of {len(shares)} logs",
            f"a tenth is below {100 * worst:.1f} %", "yes" if middle >= 0.98 else "**no**"]


def criteria(rows):
    def of(*studies):
        return [row for row in rows if row["study"] in studies]

    def exact(study):
        return [row["exact"] for row in of(study)]

    return [table.line("one hidden effect: names exactly right", "at least 97 %", exact("single"), 0.97),
            table.line("two hidden effects: names exactly right", "at least 90 %", exact("pair"), 0.9),
            table.line("three hidden effects: names exactly right", "at least 90 %", exact("triple"), 0.9),
            table.line("nothing hidden, seven kinds of noise: a name", "at most 0.5 %", [row["named"] for row in of("null")], high=0.005),
            table.line("a disturbance outside the catalogue: a false name", "at most 5 %", [row["false"] for row in of("outside")], high=0.05),
            table.line("the same: its interval in time is reported", "each", [row["place"] for row in of("outside")], 1.0),
            gap_line(rows),
            table.line("95 % interval covers the truth", "90 to 98 %", table.held(of(*HIDDEN)), 0.9, 0.98),
            table.line("residual of `simulate` on the validation log as stated, within 10 %", "each",
                       [row["gap"]["as_said"] for row in of(*HIDDEN)], 1.0),
            table.line("40,000 samples in less than 10 s of one core", "each", [row["seconds"] < 10.0 for row in rows], 1.0)]


HEAD = ["hidden", "logs", "exactly right", "not contradicted", "false name", "interval in time right", "gap closed", "gap as stated",
        "parameter error", "interval covers", "time"]


def cells(rows, single):
    of = [p for row in rows for p in row["parameters"]]
    return [single, str(len(rows)), table.share(rows, lambda r: r["exact"]), table.share(rows, lambda r: r["in_set"]),
            table.share(rows, lambda r: r["false"]), table.share(rows, lambda r: r["place"]),
            table.median_percent(r["gap"]["closed"] for r in rows), table.share(rows, lambda r: r["gap"]["as_said"]),
            table.median_percent(p["relative"] for p in of), table.share(of, lambda p: None if p["beyond"] is None else p["beyond"] <= 1.0),
            table.median([r["seconds"] for r in rows], "{:.1f} s")]


def studies(rows):
    """One line a study, and the table of each in a file."""
    lines, links = [], []
    for study in cases.SEEDS:
        group = [row for row in rows if row["study"] == study]
        if not group:
            continue
        kinds = {row["noise"] if study == "null" else study if study in ("pair", "triple") else row["label"]: None for row in group}
        by_kind = [cells([row for row in group if kind in (row["noise"], row["label"], study)], kind) for kind in kinds]
        lines.append([study, *cells(group, study)[2:5]])
        links.append(page_tables.detail(f"diagnose-catalogue-{study}", study, table.markdown(HEAD, by_kind)))
    return table.joined(table.markdown(["study", *HEAD[2:5]], lines), "Tables of the studies: " + ",\n".join(links) + ".")


def failure(row):
    more = f", interval in time {'right' if row['place'] else 'wrong'}" if row["study"] == "outside" else ""
    if row["gap"]["as_said"] is False:
        more += f", residual stated {row['gap'].get('said_after_nm', 0.0):.4f} Nm, measured {row['gap'].get('after_nm', 0.0):.4f} Nm"
    return f"{row['case']}: named {', '.join(row['named']) or 'nothing'}{more}; {row.get('error') or row['verdict']}"


@dataclasses.dataclass(frozen=True)
class Study:
    options: tuple = ()
    studies: tuple = tuple(cases.SEEDS)
    seeds = None  # each study has its own number

    def chosen(self, first, seeds):
        return cases.planned(self.studies, seeds, first)

    @staticmethod
    def write(case, folder):
        write_files(case, folder)

    def trial(self, program, case, keep=None):
        """The scores of a case; keep: a folder in which the files of those that fail are left."""
        folder = pathlib.Path(tempfile.mkdtemp(prefix="prove-diagnose-"))
        row = {"study": case.study, "label": case.label, "case": case.name, "noise": case.noise}
        try:
            row |= scores(program, case, folder, self.options)
        except (tool.ToolFailed, KeyError, TypeError, ValueError) as problem:
            row |= {"error": f"{type(problem).__name__}: {problem}", **NO_ANSWER}
        if keep and failed(row):
            shutil.rmtree(keep / case.name, ignore_errors=True)
            shutil.copytree(folder, keep / case.name)
        shutil.rmtree(folder)
        return row

    def blocks(self, about, rows):
        rows = sorted(rows, key=lambda row: (list(cases.SEEDS).index(row["study"]), row["label"], row["noise"], int(row["case"].rpartition("-")[2])))
        return {"about": about, "bars": table.markdown(table.HEAD, criteria(rows)), "studies": studies(rows),
                "wrong": table.listed("diagnose-catalogue-wrong", "Cases with a wrong result", [failure(row) for row in rows if failed(row)])}

    @staticmethod
    def answer(row):
        return (", ".join(row["named"]) or "nothing") + (" WRONG" if failed(row) else "")
