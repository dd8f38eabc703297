# SPDX-License-Identifier: MIT
"""Where a number that decides comes from stands beside it, if only "by hand" (docs/glossary.md)."""

import os
import pathlib
import re
import unittest

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])
# Rooms whose numbers decide what is told of a log. The others' are layouts of files, limits of docs/security.md, and widths of pages;
# those of a diagnosis are its rules (test_rules.py), those of the kernels are registers.
DECIDING = ("analysis", "arm", "design", "evaluate", "filter", "fleet", "model", "survey", "log/account", "log/clock", "log/columns")
NUMBER = re.compile(r"^ *(?:static |inline )*constexpr (?:(?:std::)?(?:size_t|u?int\d+_t)|double|float|int|long|Seconds|Hertz|"
                    r"DegPerSec|Degrees|NewtonMeters) \w+(?:\[\])?(?: = |\{).*\d")
UNITS = {"tau", "degrees", "radians", "seconds_a_day", "day_s", "days_a_month"}  # which say it themselves


def without_reason(text):
    """Lines with a constant that has no comment: beside it, or above it and those next to it."""
    lines = ["", *text.splitlines(), ""]
    found = []
    for at, line in enumerate(lines):
        if not NUMBER.match(line) or UNITS & set(re.findall(r"(\w+)(?:\[\])?(?: = |\{)", line)):
            continue
        top = at
        while "constexpr" in lines[top - 1]:
            top -= 1
        goes_on = not line.split("//")[0].rstrip().endswith(";")
        if "//" not in line + (lines[at + 1] if goes_on else "") and not lines[top - 1].strip().startswith("//"):
            found.append(line.strip())
    return found


class Reasons(unittest.TestCase):
    def test_every_constant_that_decides_says_where_it_comes_from(self):
        seen = 0
        for room in DECIDING:
            for base in ("src", "include/ripplenotch"):
                for path in sorted((SOURCE / base / room).rglob("*.?pp")):
                    if path.parent.name != "kernels":
                        seen += 1
                        self.assertEqual(without_reason(path.read_text()), [], path.relative_to(SOURCE))
        self.assertGreater(seen, 300)

    def test_one_without_is_seen(self):
        self.assertEqual(len(without_reason("constexpr double least = 0.5;\n")), 1)
        self.assertEqual(len(without_reason("// Of a log.\n\nconstexpr int a = 1;  // by hand\nconstexpr int b = 2;\n")), 1)
        self.assertEqual(without_reason("// Of a log.\nconstexpr int a = 1;\nconstexpr int b = 2;\n"), [])
        self.assertEqual(without_reason("constexpr double tau = 2.0 * std::numbers::pi;\n"), [])


if __name__ == "__main__":
    unittest.main()
