# SPDX-License-Identifier: MIT
"""No public function takes two bare numbers of one type side by side: swapped, they would still compile.

Two numbers of different types are told apart by -Wconversion. Numbers of one unit have a struct with their names instead
(SpeedSpan, TableAndLogRate), and quantities of units.hpp are held to the same rule."""

import os
import pathlib
import re
import unittest

INCLUDE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"]) / "include"

COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.S)
# Name and parameters of what is declared; a parameter may hold brackets of its own.
DECLARED = re.compile(r"(operator\S+|[\w:~>]+)\s*\(((?:[^(){};]|\([^(){};]*\)|\{\})*)\)\s*(?:const|noexcept|override|final|->|[=;:{])")
NUMBER = re.compile(r"^(?:const )?((?:std::)?(?:double|float|size_t|ptrdiff_t|u?int\d+_t|(?:unsigned |long )*(?:int|long)|unsigned|"
                    r"Seconds|Hertz|Degrees|DegPerSec|NewtonMeters|Order|GearRatio))&? \w+$")

# header and function -> why the order of its numbers is no riddle
KNOWN_ORDER = {
    ("core/portable_math.hpp", "atan2"): "as in <cmath>",
    ("core/portable_math.hpp", "pow"): "as in <cmath>",
    ("core/portable_math.hpp", "hypot"): "as in <cmath>; swapping changes nothing",
    ("core/portable_math.hpp", "polar"): "as in <complex>",
    ("core/trace.hpp", "part"): "as std::span::subspan(): from where on, how many",
    ("analysis/sweeps.hpp", "part_of"): "as std::span::subspan(): from where on, how many",
    ("figure/min_max.hpp", "add"): "a point: x, y",
}


def parameters(text):
    """The parameters of a list, without the values that they have by default."""
    found, depth, one = [], 0, ""
    for letter in text + ",":
        depth += (letter in "(<{[") - (letter in ")>}]")
        if letter == "," and depth == 0:
            found.append(" ".join(one.split("=")[0].split()))
            one = ""
        else:
            one += letter
    return found


def public(code):
    """Without what stands behind private:, to the end of the class or its next public:."""
    lines, hidden = [], None
    for line in code.splitlines():
        depth = len(line) - len(line.lstrip())
        if hidden is not None and line.strip() and (depth < hidden or (depth == hidden and line.strip() == "public:")):
            hidden = None
        if hidden is None and line.strip() == "private:":
            hidden = depth
        lines.append("" if hidden is not None else line)
    return "\n".join(lines)


def kind(number):
    """What -Wconversion tells apart; it says nothing of a sign."""
    if re.search(r"size_t|ptrdiff_t|64_t|long", number):
        return "64 bits"
    return "32 bits" if re.fullmatch(r"int|unsigned|unsigned int|std::u?int32_t", number) else number


def swappable(header):
    """Names of the functions of a header that take two numbers of one type side by side."""
    code = public(COMMENT_OR_TEXT.sub(" ", header))
    names = []
    for name, inside in DECLARED.findall(code):
        types = [kind(found[1]) if (found := NUMBER.match(one)) else None for one in parameters(inside)]
        if any(first and first == second for first, second in zip(types, types[1:])):
            names.append(name)
    return names


class Swappable(unittest.TestCase):
    def test_no_public_function_takes_numbers_that_could_be_swapped(self):
        headers = sorted(INCLUDE.rglob("*.hpp"))
        self.assertGreater(len(headers), 100)
        found = {(str(path.relative_to(INCLUDE / "ripplenotch")), name) for path in headers for name in swappable(path.read_text())}
        # In units.hpp two quantities of one type are what its operators are about.
        found = {one for one in found if one[0] != "core/units.hpp"}
        self.assertEqual(found, set(KNOWN_ORDER))

    def test_such_a_function_is_seen(self):
        for text in ("void cut(double low, double high);", "Line(const double rate, double speed = 1.0) : rate_(rate) {}",
                     "int of(std::span<const double> at,\n       std::size_t first,  // where\n       std::size_t count) const {",
                     "Hertz edge(std::vector<int> all = {}, Hertz low = Hertz(1.0), Hertz high = Hertz(2.0)) noexcept;",
                     "class Meter {\n  private:\n    double low_;\n};\nvoid cut(double low, double high);",
                     "double operator()(int row, int column) const;", "void of(std::int64_t count, std::size_t origin);"):
            self.assertEqual(len(swappable(text)), 1, text)
        for text in ("void cut(Seconds from, Hertz to);", "void fixed(double value, int digits);", "// of(int a, int b);",
                     "void cut(const Range& range, double q);", "struct Point { double x, y; };",
                     "void of(std::map<int, int> all, double, double);",
                     "class Meter {\n  public:\n    void add(Seconds at);\n\n  private:\n    class Sum {\n      public:\n        void add(double t, double p);\n"
                     "    };\n    void put(double low, double high);\n};\nvoid of();"):
            self.assertEqual(swappable(text), [], text)


if __name__ == "__main__":
    unittest.main()
