# SPDX-License-Identifier: MIT
"""Tables of a documentation page that a script makes: each lies between a mark with its name and `<!-- end -->`."""

import re


def block(maker, name):
    """Finds the table `name` of a script in a page: groups are its mark, the table, its end."""
    return re.compile(rf"(<!-- made by scripts/{re.escape(maker)}: {re.escape(name)} -->\n)(.*?)(<!-- end -->)", re.S)


def write(path, maker, tables):
    """Puts each table in its place in the page; SystemExit where a page has none, or two, for it."""
    page = path.read_text(encoding="utf-8")
    for name, made in tables.items():
        page, count = block(maker, name).subn(lambda found: found[1] + made.rstrip("\n") + "\n" + found[3], page)
        if count != 1:
            raise SystemExit(f"{maker}: {path} has {count} places for the table {name}")
    path.write_text(page, encoding="utf-8")
