# SPDX-License-Identifier: MIT
"""docs/security.md states the limits that the code has; JSON, words, standard streams and factorisations have one door each."""

import os
import pathlib
import re
import unittest

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])

# What the page calls it -> (the file, the name in it)
LIMITS = {
    "JSON: bytes": ("src/document/json/limits.hpp", "most_json_bytes"),
    "lists and objects within one another": ("src/document/json/limits.hpp", "most_json_depth"),
    "values together": ("src/document/json/limits.hpp", "most_json_values"),
    "members of an object": ("src/document/json/limits.hpp", "most_json_members"),
    "a number, either side of 0": ("src/document/json/limits.hpp", "largest_json_number"),
    "objects in a list of a result that is read": ("src/document/json/limits.hpp", "most_entries"),
    "table: bands": ("include/ripplenotch/design/table_work.hpp", "most_bands"),
    "notches in a band, orders": ("include/ripplenotch/design/table_work.hpp", "most_orders"),
    "notches squared, over all bands": ("src/design/table_work.cpp", "most_responses"),
    "notches times samples until they settle, over all bands": ("src/design/table_work.cpp", "most_steps"),
    "model: effects": ("src/document/json/limits.hpp", "most_effects"),
    "joint: lines": ("src/document/json/limits.hpp", "most_lines"),
    "figure: panels": ("src/document/json/limits.hpp", "most_panels"),
    "curves of a panel, and ribbons, and lines": ("src/document/json/limits.hpp", "most_curves"),
    "shades of a panel": ("src/document/json/limits.hpp", "most_shades"),
    "bytes of a title, sentence or name in a figure": ("src/document/json/limits.hpp", "most_words"),
    "log, command line: a number, either side of 0": ("include/ripplenotch/core/reading.hpp", "largest_reading"),
    "elements within one another": ("src/arm/readers/xml_tree.cpp", "deepest"),
    "elements": ("src/arm/readers/xml_tree.cpp", "most_elements"),
}


def value_of(path, name):
    found = re.search(rf"\b{name} = ([^;,]+)[;,]", (SOURCE / path).read_text())
    text = re.sub(r"(?<=[0-9])U\b|'", "", found[1])
    return float(eval(text, {"__builtins__": {}}))  # "32 << 20", "1e30": our own source


class Limits(unittest.TestCase):
    def test_each_limit_of_the_page_is_that_of_the_code(self):
        page = (SOURCE / "docs/security.md").read_text()
        rows = dict(re.findall(r"^\| ([^|]+?) \| ([^|]+?) \|$", page, re.M))
        for words, (path, name) in LIMITS.items():
            self.assertEqual(float(rows[words].replace(",", "")), value_of(path, name), words)

    def test_every_limit_of_documents_is_on_the_page(self):
        names = set(re.findall(r"^constexpr \S+ (\w+) =", (SOURCE / "src/document/json/limits.hpp").read_text(), re.M))
        self.assertEqual(names, {name for path, name in LIMITS.values() if path == "src/document/json/limits.hpp"})


# What only these files may say.
DOORS = {
    r"\b(Json|json)::(sax_)?parse\b": {"src/document/json/json_door.cpp", "src/log/messages/json_message.cpp"},
    r"(?<!\")\bstderr\b(?!\")|std::(cerr|clog|cout)\b|STDERR_FILENO": {"src/cli/talk.cpp", "src/cli/out_of_memory.cpp", "src/cli/progress_bar.cpp", "src/figure/gnuplot_process.cpp"},
    r"\bwrite_all\(\"-\"": set(),
    r"\b(HouseholderQR|LLT|LDLT|PartialPivLU|JacobiSVD|\w*EigenSolver|\w+Decomposition)<|[.>](ldlt|llt|eigenvalues|inverse|\w*[qQ]r|"
    r"\w+PivLu|\w+Svd)\(\)": {"src/core/matrices/factorisations.hpp", "src/core/matrices/factorisations.cpp"},
}


class OneDoor(unittest.TestCase):
    def test_what_comes_in_and_what_is_said_goes_through_one_door(self):
        for pattern, allowed in DOORS.items():
            for path in sorted((SOURCE / "src").rglob("*.?pp")):
                name = str(path.relative_to(SOURCE))
                if name not in allowed:
                    self.assertIsNone(re.search(pattern, re.sub(r"//.*", "", path.read_text())), f"{name}: {pattern}")


if __name__ == "__main__":
    unittest.main()
