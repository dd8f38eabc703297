# SPDX-License-Identifier: MIT
"""What is required of `diagnose` and what was measured as tables of markdown: shares with their 95 % intervals."""

import math
import statistics

import page_tables

HEAD = ["criterion", "required", "measured", "95 % interval", "met"]


def wilson(right, count, z=1.959964):
    """Wilson's 95 % interval for a share, as two numbers from 0 to 1."""
    share, weight = right / count, z * z / count
    middle = (share + weight / 2) / (1 + weight)
    half = z / (1 + weight) * math.sqrt(share * (1 - share) / count + weight / count / 4)
    return max(0.0, middle - half), min(1.0, middle + half)


def line(text, asked, answers, low=0.0, high=1.0):
    """A row of the tables of what was asked: how many of the answers are true, and whether their share is in the bounds."""
    answers = [bool(answer) for answer in answers]
    if not answers:
        return [text, asked, "no logs", "-", "-"]
    right, count = sum(answers), len(answers)
    least, most = wilson(right, count)
    return [text, asked, f"{right}/{count} = {100 * right / count:.1f} %", f"{100 * least:.1f} to {100 * most:.1f} %",
            "yes" if low <= right / count <= high else "**no**"]


def markdown(head, body):
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *body])


def shown(name, found):
    """For the page, without the intervals; everything in a file."""
    short = [[*line[:2], line[2].replace(" = ", ", ") + (" (**not met**)" if "no" in line[4] else "")] for line in found]
    return markdown(HEAD[:3], short) + "\n\n" + page_tables.detail(name, "With 95 % intervals", markdown(HEAD, found))


def share(rows, test):
    counted = [bool(test(row)) for row in rows if test(row) is not None]
    return f"{sum(counted)}/{len(counted)}" if counted else "-"


def percent(rows, test):
    counted = [bool(test(row)) for row in rows if test(row) is not None]
    return f"{100 * sum(counted) / len(counted):.1f} % ({sum(counted)}/{len(counted)})" if counted else "-"


def held(rows):
    """Whether each interval of the rows holds the truth."""
    return [p["beyond"] <= 1.0 for row in rows for p in row["parameters"] if p["beyond"] is not None]


def median(values, text):
    values = [value for value in values if value is not None]
    return text.format(statistics.median(values)) if values else "-"


def median_percent(values):
    return median([None if value is None else 100 * value for value in values], "{:.1f} %")


def joined(*parts):
    """Parts of a block, a blank line between them."""
    return "\n\n".join(parts)


def listed(name, caption, texts, none="None."):
    """Cases as "case: result" in a file of their own; `none` where there is none."""
    return page_tables.detail(name, f"{caption} ({len(texts)})", "\n".join(f"* {text}" for text in texts)) if texts else none
