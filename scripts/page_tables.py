# SPDX-License-Identifier: MIT
"""Tables of a documentation page that a script makes: each lies between a mark with its name and `<!-- end -->`.

A part that is marked by detail() goes to tables/NAME.csv next to the page, and a link takes its place.
"""

import csv
import re

DETAIL = re.compile(r"<!-- csv ([-\w]+): (.*?) -->\n(.*?)\n<!-- end csv -->", re.S)
NUMBER = r"(-?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?|-)"
# Cells with several numbers or a unit: the pattern, and what its columns are named after the head of the table.
CELLS = [(re.compile(form.replace("#", NUMBER)), names) for form, names in (
    (r"#", [""]), (r"#/#", ["", "_of"]), (r"# of #", ["", "_of"]), (r"#(?: %)? of #", ["_percent", "_of"]), (r"# % \(#/#\)", ["_percent", "", "_of"]),
    (r"#/# = # %", ["", "_of", "_percent"]), (r"# to #", ["_from", "_to"]), (r"# to # %", ["_from_percent", "_to_percent"]), (r"# → #", ["_before", "_after"]),
    (r"# dB \(# Nm\)", ["_db", "_remaining_nm"]), (r"# ms \(# to #\)", ["_ms", "_from_ms", "_to_ms"]),
    *((rf"# {unit}", ["_" + unit.lower().replace("%", "percent")]) for unit in ("%", "s", "ms", "dB", "Nm")))]


def block(maker, name):
    """Finds the table `name` of a script in a page: groups are its mark, the table, its end."""
    return re.compile(rf"(<!-- made by scripts/{re.escape(maker)}: {re.escape(name)} -->\n)(.*?)(<!-- end -->)", re.S)


def detail(name, caption, markdown):
    """A table or a list for tables/`name`.csv; the caption is the text of its link."""
    return f"<!-- csv {name}: {caption} -->\n{markdown.strip()}\n<!-- end csv -->"


def cells(line):
    """Of a line of a table."""
    return [cell.strip().replace("`", "").replace("**", "") for cell in line.strip().strip("|").split("|")]


def units_in_head(markdown):
    """The table with a unit that all cells of a column have in its head."""
    head, rule, *body = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in markdown.strip().split("\n")]
    for k in range(1, len(head)):
        filled = [line[k] for line in body if line[k] not in ("", "-")]
        unit = filled[0].rpartition(" ")[2] if filled else ""
        if unit in ("%", "s", "ms", "dB", "Nm") and all(re.fullmatch(rf"[-.,\d ]+ {unit}", cell) for cell in filled):
            head[k] = f"{head[k]}, {unit}"
            for line in body:
                line[k] = line[k].removesuffix(f" {unit}")
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, rule, *body])


def column(head, values):
    """The columns of a CSV for one of a table: each its name, then its values."""
    name = re.sub(r"[^a-z0-9]+", "_", head.lower().replace("%", "percent")).strip("_") or "item"
    for form, ends in CELLS:
        found = [form.fullmatch(value) for value in values]
        if all(match or value in ("", "-") for match, value in zip(found, values)):
            parts = [match.groups() if match else [""] * len(ends) for match in found]
            return [[name + end, *(part[k].replace(",", "").removeprefix("-" if part[k] == "-" else "") for part in parts)]
                    for k, end in enumerate(ends)]
    return [[name, *("" if value == "-" else value for value in values)]]


def csv_rows(markdown):
    """A table, or a list of "* case: result", as rows of a CSV."""
    lines = markdown.strip().split("\n")
    if not lines[0].startswith("|"):
        return [["case", "result"], *(re.sub(r"^\* ", "", line).split(": ", 1) for line in lines)]
    head, _, *body = map(cells, lines)
    columns = [made for title, *values in zip(head, *body) for made in column(title, values)]
    return list(zip(*columns))


def write(path, maker, tables):
    """Puts each table in its place in the page; SystemExit where a page has none, or two, for it."""
    page = path.read_text(encoding="utf-8")

    def moved(found):
        file = path.parent / "tables" / f"{found[1]}.csv"
        file.parent.mkdir(exist_ok=True)
        with file.open("w", encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows(csv_rows(found[3]))
        return f"[{found[2]}](tables/{file.name})"

    for name, made in tables.items():
        made = DETAIL.sub(moved, made.rstrip("\n"))
        page, count = block(maker, name).subn(lambda found: found[1] + made + "\n" + found[3], page)
        if count != 1:
            raise SystemExit(f"{maker}: {path} has {count} places for the table {name}")
    path.write_text(page, encoding="utf-8")
