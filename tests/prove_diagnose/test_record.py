# SPDX-License-Identifier: MIT
"""A run of the proof: its order, its record, and the tables made from that."""

import unittest

from commands import new_folder
import prove  # first: it skips without numpy
import numpy as np
import page_tables
from prove_diagnose import bars, cases, plan, reach, record, table, trial


def row(study, number, exact=True, label="offset", **more):
    named = [label] if exact else []
    return {"study": study, "label": label, "case": f"{study}-{label}-rich-white-{number}", "motion": "rich",
            "noise": "white", "variant": "", "verdict": "explained", "seconds": 2.0, "exact": exact, "in_set": exact,
            "false": [], "named": named, "parameters": [], "unexplained": 0, "lowers": True, "reopens": True,
            "gap": {"closed": 1.0, "as_said": True}, **more}


class Plan(unittest.TestCase):
    def test_a_run_that_is_cut_off_has_that_share_of_every_study(self):
        planned = plan.planned(list(plan.SEEDS))
        counts = {name: sum(case.study == name for case in planned) for name in plan.SEEDS}
        self.assertGreaterEqual(counts["single"], 100)
        for share in (0.1, 0.5):
            begun = planned[: round(share * len(planned))]
            for name, count in counts.items():
                self.assertAlmostEqual(sum(case.study == name for case in begun), share * count, delta=1.5)

    def test_every_effect_has_a_log_before_any_has_a_second(self):
        singles = [case for case in plan.planned(list(plan.SEEDS)) if case.study == "single"]
        kinds = {case.label for case in singles}
        self.assertEqual({case.label for case in singles[: len(kinds)]}, kinds)

    def test_a_case_is_found_again_by_its_name_alone(self):
        for case in plan.planned(["pair", "variant", "poor"], 1, 1234):
            self.assertEqual(plan.by_name(case.name), case)

    def test_a_variant_and_a_log_with_its_effect_taken_out_are_the_log_of_the_single(self):
        single = cases.studies("single", 1, 7)[0].log("train").torque_nm
        for study in ("variant", "without"):
            self.assertTrue(np.array_equal(cases.studies(study, 1, 7)[0].log("train").torque_nm, single), study)


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
                 for name in ("about", "bars", "reliability", "studies", "wrong")]
        page.write_text("Before.\n" + "Between.\n".join(marks))
        done = prove.prove("--print", str(self.path), "--write", str(page))
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        text = page.read_text()
        self.assertNotIn("\nold\n", text)
        self.assertTrue(text.startswith("Before.\n<!-- made"))
        self.assertEqual(text.count("Between."), 4)
        self.assertIn("| one hidden effect: names exactly right | at least 97 % | 1/1 = 100.0 % |", text)
        self.assertIn(begun.about["commit"], text)
        page.write_text("Before.\n" + "Between.\n".join(marks))
        done = prove.prove("--print", str(self.path), "--table", "reliability", "--write", str(page))
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        self.assertEqual(page.read_text().count("\nold\n"), 4)
        self.assertIn("| explained, no chance stated |", page.read_text())
        done = prove.prove("--print", str(self.path), "--table", "reliable")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no table 'reliable'; there are: about, bars", done.stderr)
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
        return next(line for line in bars.lines(rows, 0.5) if line[0].startswith(text))

    def test_wilson_holds_the_textbook_interval(self):
        low, high = bars.wilson(81, 263)  # Agresti, Categorical Data Analysis: 0.255 to 0.366
        self.assertAlmostEqual(low, 0.2553, delta=5e-4)
        self.assertAlmostEqual(high, 0.3662, delta=5e-4)
        self.assertAlmostEqual(bars.wilson(10, 10)[1], 1.0)

    def test_a_bar_is_met_from_its_share_on_and_not_below(self):
        rows = [row("single", k, exact=k != 0) for k in range(34)]
        self.assertEqual(self.line(rows, "one hidden")[2:], ["33/34 = 97.1 %", "85.1 to 99.5 %", "yes"])
        self.assertEqual(self.line(rows[:33], "one hidden")[4], "**no**")
        self.assertEqual(self.line(rows, "three hidden")[2:], ["no logs", "-", "-"])

    def test_no_answer_is_wrong_wherever_it_is_counted(self):
        silent = {**row("null", 1, label="nothing"), "error": "ToolFailed", **trial.NO_ANSWER}
        self.assertEqual(self.line([silent], "nothing hidden")[4], "**no**")
        self.assertEqual(self.line([silent], "40,000")[4], "**no**")
        self.assertTrue(trial.failed(silent))
        self.assertIn("no answer", table.studies([silent]))

    def test_a_variant_is_held_against_the_names_of_the_same_log(self):
        half = row("variant", 4, exact=False, variant="first half")
        self.assertEqual(self.line([row("single", 4), half], "half")[4], "**no**")
        self.assertEqual(self.line([row("single", 4, exact=False), half], "half")[4], "yes")
        self.assertEqual(self.line([row("single", 5), half], "half")[2], "no logs")


class Reach(unittest.TestCase):
    def setUp(self):
        case = next(case for case in cases.studies("single", 1, 100) if case.label == "tone")
        self.log, self.plain = case.log("train"), cases.without_hidden(case).log("train")
        self.hertz = case.truth()[1][0]["frequency_hz"]

    def told(self, kind, **where):
        nowhere = {"time_s": [], "speed_deg_s": [], "position_deg": [], "hz": [], "order": [], "direction": None}
        return reach.share_told([{"kind": kind, "where": {**nowhere, **where}}], self.log, self.plain)

    def test_a_tone_is_told_by_its_frequency_and_by_no_other(self):
        self.assertGreater(self.told("tone", hz=[self.hertz]), 0.99)
        self.assertLess(self.told("tone", hz=[self.hertz + 3.0]), 0.01)

    def test_time_and_speed_tell_what_lies_in_them(self):
        self.assertAlmostEqual(self.told("time", time_s=[[0.0, 10.0]]), 0.25, delta=0.02)
        self.assertAlmostEqual(self.told("speed", speed_deg_s=[[-300.0, 300.0]]), 1.0, delta=1e-9)
        self.assertLess(self.told("speed", speed_deg_s=[[-300.0, 300.0]], direction="positive"), 0.7)
        self.assertEqual(self.told("position"), 0.0)
