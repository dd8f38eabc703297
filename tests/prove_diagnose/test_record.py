# SPDX-License-Identifier: MIT
"""The tables that scripts put into pages of the documentation."""

import unittest

from commands import new_folder
import prove  # noqa: F401  first: it skips without numpy
import page_tables


class Tables(unittest.TestCase):
    def test_a_table_per_case_becomes_a_file_with_units_in_its_head_and_the_page_a_link(self):
        page = new_folder(self) / "page.md"
        page.write_text("<!-- made by scripts/prove-diagnose: bars -->\n<!-- end -->\n")
        table = "| `hidden` | right | gap closed | X | time |\n| --- | --- | --- | --- | --- |\n" \
            "| **all**, two | 5/6 | 99.5 % | 95.2 % of 1,084 | 0.7 s |\n| none | - | - | - of 0 | - |"
        page_tables.write(page, "prove-diagnose", {"bars": page_tables.detail("name", "All", table) + "\n" +
                                                   page_tables.detail("wrong", "Wrong (1)", "* case-1: named a, b; x: y")})
        self.assertEqual(page.read_text(), "<!-- made by scripts/prove-diagnose: bars -->\n[All](tables/name.csv)\n[Wrong (1)](tables/wrong.csv)\n<!-- end -->\n")
        self.assertEqual((page.parent / "tables" / "name.csv").read_text(),
                         "hidden,right,right_of,gap_closed_percent,x_percent,x_of,time_s\n\"all, two\",5,6,99.5,95.2,1084,0.7\nnone,,,,,0,\n")
        self.assertEqual((page.parent / "tables" / "wrong.csv").read_text(), "case,result\ncase-1,\"named a, b; x: y\"\n")
