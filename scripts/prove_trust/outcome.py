# SPDX-License-Identifier: MIT
"""What a part of prove-trust tried and what it found, and the table of it."""

import dataclasses
import sys

import page_tables


@dataclasses.dataclass
class Row:
    """A line of a part's table."""
    what: str                                     # "reader of CSV"
    runs: int                                     # how often it was tried
    seconds: float                                # how long that took
    checked: str = ""                             # what was looked at after each run
    findings: list = dataclasses.field(default_factory=list)  # a sentence each, with the way to do it again


def table(rows):
    lines = ["| what | runs | seconds | checked | failed |", "| --- | ---: | ---: | --- | --- |"]
    for row in rows:
        found = "; ".join(row.findings[:3]) + (f"; and {len(row.findings) - 3} more" if len(row.findings) > 3 else "")
        lines.append(f"| {row.what} | {row.runs:,} | {row.seconds:,.0f} | {row.checked} | {found or 'none'} |")
    lines.append(f"| all | {sum(row.runs for row in rows):,} | {sum(row.seconds for row in rows):,.0f} | | "
                 f"{sum(len(row.findings) for row in rows) or 'none'} |")
    return "\n".join(lines)


def summary(rows):
    """The sums of the table."""
    _, runs, seconds, _, failed = page_tables.cells(table(rows).split("\n")[-1])
    return f"{runs} runs in {seconds} s; findings: {failed}."


def show(page, part, rows):
    """page: where the part has its marks, or None to print."""
    for row in rows:
        for finding in row.findings:
            print(f"prove-trust {part}: {row.what}: {finding}", file=sys.stderr)
    if page:
        page_tables.write(page, "prove-trust", {part: summary(rows)})
    else:
        print(f"{part}\n{table(rows)}\n")
