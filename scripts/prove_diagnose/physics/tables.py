# SPDX-License-Identifier: MIT
"""The tables of the study."""

from .. import bars, table
from . import cases, catalogue

CONFIGURATIONS = [(form, friction) for form in cases.FORMS for friction in ("friction", "frictionless")
                  if form != "model" or friction == "friction"]
TITLES = {("model", "friction"): "`--model`", ("simulated", "friction"): "`--simulated`",
          ("simulated", "frictionless"): "`--simulated`, no friction in it", ("simulated_scale1", "friction"): "`scale=1`",
          ("simulated_scale1", "frictionless"): "`scale=1`, no friction in it"}
KINDS = {"single": "one effect", "pair": "two effects", "null": "nothing hidden", "outside": "no effect of the catalogue"}


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
            lines.append(bars.line(f"`{form}`, {KINDS[kind]}: names exactly right", f"at least {100 * least:.0f} %", group, least))
        hidden = [bool(row["false"]) for row in of if row["kind"] in ("single", "pair")]
        lines.append(bars.line(f"`{form}`, hidden effects: a false name", "at most 2 %", hidden, high=0.02))
        lines.append(bars.line(f"`{form}`, nothing hidden: a name", "at most 1 %", [bool(r["named"]) for r in of if r["kind"] == "null"],
                               high=0.01))
        lines.append(bars.line(f"`{form}`, no effect of the catalogue: a name", "at most 2 %",
                               [bool(r["named"]) for r in of if r["kind"] == "outside"], high=0.02))
        lines.append(bars.line(f"`{form}`: a gap that grows", "none", [bool(row["grown"]) for row in of], high=0.0))
        lines.append(bars.line(f"`{form}`: 95 % interval holds the truth", "90 to 98 %", held(of), 0.9, 0.98))
    return table.markdown(bars.HEAD, [line for line in lines if line[2] != "no logs"])


def summary(rows):
    head = ["form", "hidden", "logs", "exactly right", "false name", "gap grew", "interval holds", "no answer", "time per 40,000 samples",
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
    return table.markdown(head, lines)


def by_label(rows):
    """Exactly right, and logs with a false name, per effect and form; the baseline's exactly right in brackets."""
    there = [c for c in CONFIGURATIONS if any((row["form"], row["friction"]) == c for row in rows)]
    labels = ["friction", *catalogue.labels(), *catalogue.PAIRS, "nothing", *cases.OUTSIDE]
    lines = []
    for label in labels:
        cells = []
        for configuration in there:
            of = [row for row in rows if row["label"] == label and (row["form"], row["friction"]) == configuration]
            wrong = sum(bool(row["false"]) for row in of)
            right = f"{table.share(of, lambda r: r['exact'])}{f', {wrong} false' if wrong else ''}"
            cells.append(f"{right} ({sum(bool(beside(row, 'exact')) for row in of)})" if of else "-")
        if any(cell != "-" for cell in cells):
            lines.append([label, *cells])
    return table.markdown(["hidden", *(TITLES[c] for c in there)], lines)


def coverage(rows):
    lines = []
    for name in sorted({p["parameter"] for row in rows for p in row["parameters"]}):
        cells = []
        for form in cases.FORMS:
            of = [p for row in rows if row["form"] == form for p in row["parameters"] if p["parameter"] == name]
            cells.append(table.share(of, lambda p: p["held"]))
        lines.append([name, *cells])
    return table.markdown(["value", *(f"`{form}`" for form in cases.FORMS)], lines)


def failure(row):
    sizes = ", ".join(f"{size:.1f}" for size in row["sizes"] if size is not None)
    text = f"{row['case']}{f' ({sizes} of the noise)' if sizes else ''}: named {', '.join(row['named']) or 'nothing'}"
    if row["false"]:
        text += f"; false: {', '.join(row['false'])}"
    if row["grown"]:
        text += f"; grew: {', '.join(row['grown'])}"
    return f"{text}; {row.get('error') or row.get('verdict')}"


def blocks(about, rows):
    wrong = "\n".join(f"* {failure(row)}" for row in rows if not row["exact"] or row["grown"]) or "Nothing went wrong."
    return {"dynamics": "\n\n".join([about, asked(rows), summary(rows),
                                    "Exactly right, logs with a false name; in brackets the baseline:", by_label(rows),
                                    "Intervals that hold the value of the physics:", coverage(rows)]),
            "dynamics-wrong": wrong}
