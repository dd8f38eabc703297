# SPDX-License-Identifier: MIT
"""The tables of the study."""

import page_tables

from .. import table
from . import cases, catalogue

CONFIGURATIONS = [(form, friction) for form in cases.FORMS for friction in ("friction", "frictionless")
                  if form != "model" or friction == "friction"]
TITLES = {("model", "friction"): "`--model`", ("simulated", "friction"): "`--simulated`",
          ("simulated", "frictionless"): "`--simulated` without friction", ("simulated_scale1", "friction"): "`scale=1`",
          ("simulated_scale1", "frictionless"): "`scale=1` without friction"}
KINDS = {"single": "one effect", "pair": "two effects", "null": "nothing hidden", "outside": "no effect of the catalogue"}


def rough(rows):
    return all(row["case"].startswith("rough-") for row in rows)


def beside(row, key):
    return row.get("baseline", {}).get(key)


def held(rows):
    return [p["held"] for row in rows for p in row["parameters"] if p["held"] is not None]


def speed(row):
    """Processor time per 40,000 samples."""
    return None if "seconds" not in row else row["seconds"] * 40000 / row["rows"]


def asked(rows):
    """What is required, form by form."""
    lines = []
    for form in cases.FORMS:
        of = [row for row in rows if row["form"] == form]
        for kind, least in (("single", 0.85), ("pair", 0.75)):
            group = [row["exact"] for row in of if row["kind"] == kind]
            lines.append(table.line(f"`{form}`, {KINDS[kind]}: names exactly right", f"at least {100 * least:.0f} %", group, least))
        hidden = [bool(row["false"]) for row in of if row["kind"] in ("single", "pair")]
        lines.append(table.line(f"`{form}`, hidden effects: a false name", "at most 2 %", hidden, high=0.02))
        lines.append(table.line(f"`{form}`, nothing hidden: a name", "at most 1 %", [bool(r["named"]) for r in of if r["kind"] == "null"],
                               high=0.01))
        lines.append(table.line(f"`{form}`, no effect of the catalogue: a name", "at most 2 %",
                               [bool(r["named"]) for r in of if r["kind"] == "outside"], high=0.02))
        lines.append(table.line(f"`{form}`: the residual grows", "none", [bool(row["grown"]) for row in of], high=0.0))
        lines.append(table.line(f"`{form}`: 95 % interval covers the truth", "90 to 98 %", held(of), 0.9, 0.98))
    return table.markdown(table.HEAD, [line for line in lines if line[2] != "no logs"])


def summary(rows):
    head = ["form", "hidden", "logs", "exactly right", "false name", "residual grew", "interval covers", "no answer", "time per 40,000 samples",
            "baseline: exactly right", "baseline: false name"]
    lines = []
    for configuration in CONFIGURATIONS:
        for kind, title in KINDS.items():
            of = [row for row in rows if (row["form"], row["friction"]) == configuration and row["kind"] == kind]
            if of:
                lines.append([TITLES[configuration], title, str(len(of)), table.percent(of, lambda r: r["exact"]),
                              table.percent(of, lambda r: bool(r["false"])), table.share(of, lambda r: bool(r["grown"])),
                              table.percent([{"h": h} for h in held(of)], lambda r: r["h"]), table.share(of, lambda r: "error" in r),
                              table.median([speed(row) for row in of], "{:.1f} s"), table.percent(of, lambda r: beside(r, "exact")),
                              table.percent(of, lambda r: bool(beside(r, "false")))])
    return table.joined(short(head, lines), page_tables.detail(f"diagnose-{'rough' if rough(rows) else 'physics'}-forms", "All columns", table.markdown(head, lines)))


def short(head, lines):
    """The columns for the page, counts without percentages."""
    kept = [head.index(name) for name in ("form", "hidden", "exactly right", "false name", "baseline: exactly right", "baseline: false name")]
    counts = [[line[k].partition("(")[2].rstrip(")") if "(" in line[k] else line[k] for k in kept] for line in lines]
    return table.markdown([head[k] for k in kept], counts)


def by_label(rows):
    """Exactly right, logs with a false name, and the baseline's exactly right, per effect and form."""
    there = [c for c in CONFIGURATIONS if any((row["form"], row["friction"]) == c for row in rows)]
    labels = ["friction", *catalogue.labels(), *catalogue.PAIRS, "nothing", *cases.OUTSIDE]
    lines = []
    for label in labels:
        cells = []
        for configuration in there:
            of = [row for row in rows if row["label"] == label and (row["form"], row["friction"]) == configuration]
            wrong = sum(bool(row["false"]) for row in of)
            cells += [table.share(of, lambda r: r["exact"]), str(wrong), str(sum(bool(beside(row, "exact")) for row in of))] if of else ["-"] * 3
        if any(cell != "-" for cell in cells):
            lines.append([label, *cells])
    return table.markdown(["hidden", *(f"{TITLES[c]}: {what}" for c in there for what in ("exactly right", "false name", "baseline exactly right"))], lines)


def coverage(rows):
    lines = []
    for name in sorted({p["parameter"] for row in rows for p in row["parameters"]}):
        cells = []
        for form in cases.FORMS:
            of = [p for row in rows if row["form"] == form for p in row["parameters"] if p["parameter"] == name]
            cells.append(table.share(of, lambda p: p["held"]))
        lines.append([name, *cells])
    return table.markdown(["parameter", *(f"`{form}`: interval covers" for form in cases.FORMS)], lines)


def failure(row):
    sizes = ", ".join(f"{size:.1f}" for size in row["sizes"] if size is not None)
    text = f"{row['case']}{f' ({sizes} of the noise)' if sizes else ''}: named {', '.join(row['named']) or 'nothing'}"
    if row["false"]:
        text += f"; false: {', '.join(row['false'])}"
    if row["grown"]:
        text += f"; grew: {', '.join(row['grown'])}"
    return f"{text}; {row.get('error') or row.get('verdict')}"


def blocks(about, rows):
    if rough(rows):
        return {"rough": table.joined(about, summary(rows))}
    return {"dynamics": table.joined(
        about, summary(rows), page_tables.detail("diagnose-physics-criteria", "Criteria, and whether they are met", asked(rows)),
        page_tables.detail("diagnose-physics-effects", "Each hidden effect", by_label(rows)),
        page_tables.detail("diagnose-physics-coverage", "Coverage of the intervals, each parameter", coverage(rows)),
        table.listed("diagnose-physics-wrong", "Cases with a wrong result", [failure(row) for row in rows if not row["exact"] or row["grown"]]))}
