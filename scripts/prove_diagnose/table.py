# SPDX-License-Identifier: MIT
"""The scores of many cases as tables of markdown."""

import statistics

import page_tables

from . import bars, nulls, reach, reliability


def share(rows, test):
    counted = [bool(test(row)) for row in rows if test(row) is not None]
    return f"{sum(counted)}/{len(counted)}" if counted else "-"


def percent(rows, test):
    counted = [bool(test(row)) for row in rows if test(row) is not None]
    return f"{100 * sum(counted) / len(counted):.1f} % ({sum(counted)}/{len(counted)})" if counted else "-"


def median(values, text):
    values = [value for value in values if value is not None]
    return text.format(statistics.median(values)) if values else "-"


def median_percent(values):
    return median([None if value is None else 100 * value for value in values], "{:.1f} %")


def groups(rows, by):
    found = {}
    for row in rows:
        found.setdefault(by(row), []).append(row)
    return found.items()


def cells(rows, single):
    of = [p for row in rows for p in row["parameters"]]
    return [single, str(len(rows)), share(rows, lambda r: r["exact"]), share(rows, lambda r: r["in_set"]),
            share(rows, lambda r: r["false"]), median_percent(r["gap"]["closed"] for r in rows),
            share(rows, lambda r: r["gap"]["as_said"]), median_percent(p["relative"] for p in of),
            share(of, lambda p: None if p["beyond"] is None else p["beyond"] <= 1.0),
            median([r["seconds"] for r in rows], "{:.1f} s")]


HEAD = ["hidden", "logs", "exactly right", "not contradicted", "false name", "gap closed", "gap as stated", "parameter error",
        "interval covers", "time"]


markdown = bars.markdown


def joined(*parts):
    """Parts of a block, a blank line between them."""
    return "\n\n".join(parts)


def listed(name, caption, texts, none="None."):
    """Cases as "case: result" in a file of their own; `none` where there is none."""
    return page_tables.detail(name, f"{caption} ({len(texts)})", "\n".join(f"* {text}" for text in texts)) if texts else none


def by_label(rows):
    lines = [cells(group, label) for label, group in groups(rows, lambda r: r["label"])]
    return markdown(HEAD, lines + ([cells(rows, "**all**")] if len(lines) > 1 else []))


def several(rows):
    return markdown(HEAD, [cells(rows, f"{rows[0]['study']}s")])


def null(rows):
    head = ["noise", "logs", "no name", "`matches`", "false names", "time"]
    lines = [[kind, str(len(group)), share(group, lambda r: not r["named"]),
              share(group, lambda r: r["verdict"] == "matches"),
              "; ".join(sorted({", ".join(r["named"]) for r in group if r["named"]})) or "none",
              median([r["seconds"] for r in group], "{:.1f} s")] for kind, group in groups(rows, lambda r: r["noise"])]
    return markdown(head, lines)


def outside(rows):
    head = ["disturbance", "logs", "named as an effect", "reported unexplained", "interval in time right", "not contradicted", "time"]
    lines = [[label, str(len(group)), share(group, lambda r: r["false"]), share(group, lambda r: r["unexplained"]),
              share(group, lambda r: r["place"]), share(group, lambda r: r["in_set"]),
              median([r["seconds"] for r in group], "{:.1f} s")] for label, group in groups(rows, lambda r: r["label"])]
    return markdown(head, lines)


def poor(rows):
    head = ["motion", "hidden", "logs", "exactly right", "not contradicted", "false name"]
    return markdown(head, [[motion, label, str(len(group)), share(group, lambda r: r["exact"]),
                            share(group, lambda r: r["in_set"]), share(group, lambda r: r["false"])]
                           for (motion, label), group in groups(rows, lambda r: (r["motion"], r["label"]))])


def noise(rows):
    return markdown(["noise", *HEAD], [[kind, *cells(group, "all singles")]
                                       for kind, group in groups(rows, lambda r: r["noise"])])


def variant(rows):
    head = ["the same log", "logs", "exactly right", "not contradicted", "false name"]
    return markdown(head, [[kind, str(len(group)), share(group, lambda r: r["exact"]), share(group, lambda r: r["in_set"]),
                            share(group, lambda r: r["false"])] for kind, group in groups(rows, lambda r: r["variant"])])


def without(rows):
    head = ["excluded", "logs", "verdict", "share of its energy located", "named instead"]
    return markdown(head, [[label, str(len(group)), ", ".join(sorted({r["verdict"] for r in group})),
                            ", ".join(f"{100 * r['told']:.0f} %" for r in group),
                            "; ".join(sorted({", ".join(r["named"]) for r in group if r["named"]})) or "none"]
                           for label, group in groups(rows, lambda r: r["label"])])


def recorded(rows):
    head = ["recorded", "logs", "exactly right", "not contradicted", "logs with a false name", "gap closed", "interval covers",
            "time"]
    lines = []
    for way, group in groups(rows, lambda r: r["recorded"] or "as they are"):
        of = [p for row in group for p in row["parameters"]]
        lines.append([way, str(len(group)), share(group, lambda r: r["exact"]), share(group, lambda r: r["in_set"]),
                      share(group, lambda r: r["false"]), median_percent(r["gap"]["closed"] for r in group),
                      share(of, lambda p: None if p["beyond"] is None else p["beyond"] <= 1.0),
                      median([r["seconds"] for r in group], "{:.1f} s")])
    return markdown(head, lines)


def yardsticks(rows):
    """For each study the tool and the yardsticks on the same logs."""
    head = ["study", "logs", "method", "exactly right", "false name in", "false names a log", "gap closed"]
    lines = []
    for study, group in groups([r for r in rows if "yardsticks" in r and "named" in r], lambda r: r["study"]):
        lines.append([study, str(len(group)), "diagnose", percent(group, lambda r: r["exact"]),
                      percent(group, lambda r: r["false"]), f"{sum(len(r['false']) for r in group) / len(group):.2f}",
                      median_percent(None if study == "null" else r["gap"]["closed"] for r in group)])
        for method in group[0]["yardsticks"]:
            own = [r["yardsticks"][method] for r in group]
            lines.append([study, str(len(group)), method, percent(own, lambda r: r["exact"]),
                          percent(own, lambda r: r["false"]), f"{sum(r['false'] for r in own) / len(own):.2f}",
                          median_percent(None if study == "null" else r["closed"] for r in own)])
    return markdown(head, lines)


FORMS = {"single": by_label, "rarer": by_label, "pair": several, "triple": several, "null": null, "outside": outside,
         "outside+single": outside, "formula": by_label, "noise": noise, "poor": poor,
         "variant": variant, "without": without}


def failure(row):
    if "error" in row:
        return f"{row['case']}: {row['error']}"
    more = ", not contradicted" if row["in_set"] and not row["exact"] else ""
    if row["study"].startswith("outside"):
        more += f", interval in time {'right' if row['place'] else 'wrong'}"
    elif row["study"] == "without":
        return f"{row['case']}: {100 * row['told']:.0f} % located, named {', '.join(row['named']) or 'nothing'}; {row['verdict']}"
    elif row["gap"]["as_said"] is False:
        more += f", residual stated {row['gap']['said_after_nm']:.4f} Nm, measured {row['gap']['after_nm']:.4f} Nm"
    if row["lowers"] is False:
        more += ", a reported effect raised the residual"
    if row["reopens"] is False:
        more += ", removing a confirmed effect raised the residual by less than its share"
    return f"{row['case']}: named {', '.join(row['named']) or 'nothing'}{more}; {row['verdict']}"


def about(abouts, rows):
    """One sentence: when, on what and with what the scores were measured."""
    if not abouts:
        return "Measured with an unknown program."
    first = abouts[0]
    options = f", options {' '.join(first['options'])}" if first["options"] else ""
    numbers = sorted({int(row["case"].rpartition("-")[2]) for row in rows
                      if row["study"] == "single" or "+" not in row["label"]}) or [0]
    day = first["begun"].partition("T")[0]
    return (f"Measured on {day} with `diagnose` of commit `{first['commit']}`{options} ({first['machine']}): {len(rows)} logs, numbers from "
            f"{numbers[0]} on.")


SUMMED = ("exactly right", "not contradicted", "false name")


def summed(study, text):
    """The line of a study in the summary: sums over the lines of its table, the line of all left out."""
    head, _, *body = map(page_tables.cells, text.split("\n"))
    body = [line for line in body if line[0] != "all"]
    heads = {"exactly right": "no name", "false name": "named as an effect"}
    line = [study]
    for name in SUMMED:
        of = name if name in head else heads.get(name)
        found = [line[head.index(of)].split("/") for line in body] if of in head else []
        line.append("/".join(str(sum(map(int, part))) for part in zip(*found)) or "-")
    return line


def studies(rows):
    """One line a study, and the table of each in a file; then that of the yardsticks."""
    lines, links, parts = [], [], []
    for study, group in groups([r for r in rows if "named" in r], lambda r: r["study"].split(" ")[0]):
        text = FORMS[study](group)
        line = summed(study, text)
        lines += [line] if set(line[1:]) != {"-"} else []
        links.append(page_tables.detail(f"diagnose-catalogue-{study.replace('+', '-')}", study, text))
    if links:
        parts += [markdown(["study", *SUMMED], lines), "Tables of the studies: " + ",\n".join(links) + "."]
    if any("yardsticks" in row for row in rows):
        parts += ["### yardsticks", yardsticks(rows)]
    return joined(*parts)


def of_recorders(abouts, rows, failed):
    """The same logs as other recorders write them: table, criteria, what went wrong."""
    answered = [r for r in rows if "named" in r]
    return joined(about(abouts, rows), page_tables.units_in_head(recorded(answered)),
                  page_tables.detail("diagnose-recordings-criteria", "Criteria, and whether they are met", markdown(bars.HEAD, bars.recorded_lines(answered))),
                  listed("diagnose-recordings-wrong", "Cases with a wrong result", [failure(row) for row in rows if failed(row)]))


def of_nulls(abouts, rows, failed):
    """Nothing hidden in noise of ten kinds: bars, table, what went wrong."""
    named = [row for row in rows if "false" in row]
    lines = nulls.lines(named)
    return joined(about(abouts, rows), markdown([nulls.HEAD[k] for k in nulls.SHORT], [[line[k] for k in nulls.SHORT] for line in lines if line[4] != "none"]),
                  page_tables.detail("diagnose-noise", "All columns", markdown(nulls.HEAD, lines)),
                  page_tables.detail("diagnose-noise-criteria", "Criteria, and whether they are met", markdown(bars.HEAD, nulls.bar_lines(named))),
                  listed("diagnose-noise-wrong", "Cases with a false name", [failure(row) for row in rows if failed(row)]))


def of_physics(abouts, rows, failed):
    """Joints from physics: bars, table, what went wrong."""
    def closed(row):
        return row["exact"] and row["gap"]["closed"] >= 0.95

    named = [row for row in rows if "named" in row]
    asked = bars.shown("diagnose-physics-torsion-criteria", [
        bars.line("resonance or ripple by speed named, nothing false", "17 of 18", [row["exact"] for row in named], 17 / 18),
        bars.line("the same, and at least 95 % of the gap closed on the validation log", "17 of 18", map(closed, named), 17 / 18)])
    wrong = [f"{failure(row)}; {100 * row['gap']['closed']:.1f} % closed" for row in named if not closed(row)]
    return joined(about(abouts, rows), asked, page_tables.detail("diagnose-physics-torsion", "Each kind of joint", by_label(named)),
                  listed("diagnose-physics-torsion-wrong", "Cases below the criteria", wrong))


APART = {"recorded": of_recorders, "nulls": of_nulls, "physics": of_physics}


def blocks(abouts, rows, failed):
    """Every table by the name of its mark in docs/studies; failed(row) says which cases are listed as wrong."""
    others, found = [row for row in rows if row["study"] not in APART], {}
    if others or not rows:
        wrong = [failure(row) for row in others if failed(row)]
        found = {"about": about(abouts, others),
                 "bars": markdown(bars.HEAD, bars.lines([r for r in others if "named" in r], reach.ENOUGH)),
                 "studies": studies(others),
                 "reliability": markdown(reliability.HEAD, [line for line in reliability.lines(others) if line[2] != "0"]),
                 "wrong": listed("diagnose-catalogue-wrong", "Cases with a wrong result", wrong)}
    for study, form in APART.items():
        if own := [row for row in rows if row["study"] == study]:
            found[study] = form(abouts, own, failed)
    return found
