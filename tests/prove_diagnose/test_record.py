# SPDX-License-Identifier: MIT
"""A run of the proof: its order, its record, and the tables made from that."""

import unittest

from commands import new_folder
import prove  # first: it skips without numpy
import page_tables
from prove_diagnose import cases, catalogue, record, table


def row(study, number, exact=True, label="offset", **more):
    named = [label] if exact else []
    return {"study": study, "label": label, "case": f"{study}-{label}-rich-white-{number}", "noise": "white",
            "verdict": "explained", "seconds": 2.0, "exact": exact, "in_set": exact, "false": [], "named": named, "parameters": [],
            "place": None, "gap": {"closed": 1.0, "as_said": True}, **more}


class Plan(unittest.TestCase):
    def test_a_run_that_is_cut_off_has_that_share_of_every_study(self):
        planned = cases.planned(list(cases.SEEDS))
        counts = {name: sum(case.study == name for case in planned) for name in cases.SEEDS}
        self.assertGreaterEqual(counts["single"], 100)
        for share in (0.1, 0.5):
            begun = planned[: round(share * len(planned))]
            for name, count in counts.items():
                self.assertAlmostEqual(sum(case.study == name for case in begun), share * count, delta=1.5)

    def test_every_effect_has_a_log_before_any_has_a_second(self):
        singles = [case for case in cases.planned(list(cases.SEEDS)) if case.study == "single"]
        kinds = {case.label for case in singles}
        self.assertEqual({case.label for case in singles[: len(kinds)]}, kinds)


class Record(unittest.TestCase):
    def setUp(self):
        self.path = new_folder(self) / "record.jsonl"

    def test_a_run_goes_on_where_it_was_cut_off_but_not_with_another_program(self):
        record.Record(self.path, prove.TOOL, []).add(row("single", 3))
        again = record.Record(self.path, prove.TOOL, [])
        self.assertEqual([r["case"] for r in again.rows], ["single-offset-rich-white-3"])
        self.assertEqual(len(self.path.read_text().splitlines()), 2)
        self.assertRaises(SystemExit, record.Record, self.path, __file__, [])
        self.assertRaises(SystemExit, record.Record, self.path, prove.TOOL, ["--without"])

    def test_the_page_gets_its_tables_between_their_marks_and_nothing_else_changes(self):
        begun = record.Record(self.path, prove.TOOL, [])
        begun.add(row("single", 3))
        page = self.path.with_name("page.md")
        marks = [f"<!-- made by scripts/prove-diagnose: {name} -->\nold\n<!-- end -->\n"
                 for name in ("about", "bars", "studies", "wrong")]
        page.write_text("Before.\n" + "Between.\n".join(marks))
        done = prove.prove("--print", str(self.path), "--write", str(page))
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        text = page.read_text()
        self.assertNotIn("\nold\n", text)
        self.assertTrue(text.startswith("Before.\n<!-- made"))
        self.assertEqual(text.count("Between."), 3)
        self.assertIn("| one hidden effect: names exactly right | at least 97 % | 1/1 = 100.0 % |", text)
        self.assertIn(begun.about["commit"], text)
        page.write_text("No marks.\n")
        self.assertRaises(SystemExit, page_tables.write, page, "prove-diagnose", {"bars": ""})

    def test_a_table_per_case_becomes_a_file_with_units_in_its_head_and_the_page_a_link(self):
        page = self.path.with_name("page.md")
        page.write_text("<!-- made by scripts/prove-diagnose: bars -->\n<!-- end -->\n")
        table = "| `hidden` | right | gap closed | X | time |\n| --- | --- | --- | --- | --- |\n" \
            "| **all**, two | 5/6 | 99.5 % | 95.2 % of 1,084 | 0.7 s |\n| none | - | - | - of 0 | - |"
        page_tables.write(page, "prove-diagnose", {"bars": page_tables.detail("name", "All", table) + "\n" +
                                                   page_tables.detail("wrong", "Wrong (1)", "* case-1: named a, b; x: y")})
        self.assertEqual(page.read_text(), "<!-- made by scripts/prove-diagnose: bars -->\n[All](tables/name.csv)\n[Wrong (1)](tables/wrong.csv)\n<!-- end -->\n")
        self.assertEqual((page.parent / "tables" / "name.csv").read_text(),
                         "hidden,right,right_of,gap_closed_percent,x_percent,x_of,time_s\n\"all, two\",5,6,99.5,95.2,1084,0.7\nnone,,,,,0,\n")
        self.assertEqual((page.parent / "tables" / "wrong.csv").read_text(), "case,result\ncase-1,\"named a, b; x: y\"\n")


class Bars(unittest.TestCase):
    def line(self, rows, text):
        return next(line for line in catalogue.criteria(rows) if line[0].startswith(text))

    def test_wilson_holds_the_textbook_interval(self):
        low, high = table.wilson(81, 263)  # Agresti, Categorical Data Analysis: 0.255 to 0.366
        self.assertAlmostEqual(low, 0.2553, delta=5e-4)
        self.assertAlmostEqual(high, 0.3662, delta=5e-4)
        self.assertAlmostEqual(table.wilson(10, 10)[1], 1.0)

    def test_a_bar_is_met_from_its_share_on_and_not_below(self):
        rows = [row("single", k, exact=k != 0) for k in range(34)]
        self.assertEqual(self.line(rows, "one hidden")[2:], ["33/34 = 97.1 %", "85.1 to 99.5 %", "yes"])
        self.assertEqual(self.line(rows[:33], "one hidden")[4], "**no**")
        self.assertEqual(self.line(rows, "three hidden")[2:], ["no logs", "-", "-"])

    def test_no_answer_is_wrong_wherever_it_is_counted(self):
        silent = {**row("null", 1, label="nothing"), "error": "ToolFailed", **catalogue.NO_ANSWER}
        self.assertEqual(self.line([silent], "nothing hidden")[4], "**no**")
        self.assertEqual(self.line([silent], "40,000")[4], "**no**")
        self.assertTrue(catalogue.failed(silent))
        self.assertIn("no answer", catalogue.failure(silent))
