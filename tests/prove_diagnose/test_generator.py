# SPDX-License-Identifier: MIT
"""The generator and the tool's catalogue are two programs; each draws every effect of the other."""

import dataclasses
import json
import subprocess
import unittest

import prove  # first: it skips without numpy
import numpy as np
import page_tables
from commands import new_folder
from prove_diagnose import cases, joint, score


class Agreement(unittest.TestCase):
    def test_every_effect_of_the_catalogue_is_drawn(self):
        listed = subprocess.run([prove.TOOL, "diagnose", "--effects", "--json"], capture_output=True, check=True, timeout=60).stdout
        names = {effect["effect"] for effect in json.loads(listed)["effects"]}
        rng = np.random.default_rng(1)
        always = {effect["effect"] for effect in joint.base_joint(rng)}
        elsewhere = {"simulation-scale", "coupled-joint-friction"}  # of a simulation, of another joint: these logs have neither
        drawn = {joint.draw(rng, label)["effect"] for label in (*joint.HIDDEN, *joint.FURTHER, *joint.RARER)}
        self.assertEqual(names - drawn - always - elsewhere, set(), "formula and strength are missing: scripts/prove_diagnose/joint.py")
        self.assertEqual((drawn | always) - names, set(), "drawn by scripts/prove_diagnose/joint.py, and no effect")

    def test_every_effect_that_can_be_drawn_changes_the_log(self):
        for study in ("single", "rarer"):
            for case in cases.studies(study, 1):
                log, plain = case.log("train"), dataclasses.replace(case, hidden=()).log("train")
                changed = [np.max(np.abs(a - b)) for a, b in ((log.torque_nm, plain.torque_nm),
                                                              (log.velocity_deg_s, plain.velocity_deg_s))]
                self.assertGreater(max(changed), 0.015, case.label)


# The tables that scripts put into pages of the documentation.

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


# What the tables count: a diagnosis that is known to be right, wrong or undecided is scored as such.

def diagnosis(rounds, ambiguous=(), remaining=None):
    """rounds: (effect, status, {parameter: (value, low, high)})"""
    entries = [{"effect": effect, "status": status,
                "parameters": {name: {"value": v, "ci95": [low, high]} for name, (v, low, high) in given.items()}}
               for effect, status, given in rounds]
    return {"verdict": "explained", "rounds": entries, "named": [r[0] for r in rounds if r[1] == "confirmed"],
            "ambiguous": [{"effects": list(names)} for names in ambiguous], "remaining": remaining}


RIPPLE = {"effect": "ripple", "order": 3, "amplitude_nm": 0.2, "phase_deg": 175.0}
OFFSET = {"effect": "offset", "torque_nm": 0.4}


def ripple(order, amplitude=(0.2, 0.19, 0.21), phase=(175.0, 170.0, 180.0)):
    return ("ripple", "confirmed", {"order": (order, order, order), "amplitude_nm": amplitude, "phase_deg": phase})


class Names(unittest.TestCase):
    def score(self, hidden, found):
        return score.names(hidden, found)

    def test_the_right_name_and_nothing_else_is_exact(self):
        self.assertTrue(self.score([RIPPLE], diagnosis([ripple(3)]))["exact"])

    def test_the_same_name_with_another_order_is_a_false_name(self):
        found = self.score([RIPPLE], diagnosis([ripple(4)]))
        self.assertEqual((found["exact"], found["in_set"], found["false"]), (False, False, ["ripple 4"]))

    def test_a_false_name_beside_the_right_one_is_not_exact_and_not_in_the_set(self):
        found = self.score([RIPPLE], diagnosis([ripple(3), ("offset", "confirmed", {"torque_nm": (0.1, 0.0, 0.2)})]))
        self.assertEqual((found["exact"], found["in_set"], found["false"]), (False, False, ["offset"]))

    def test_a_tie_that_holds_the_truth_is_in_the_set_but_not_exact(self):
        found = self.score([OFFSET], diagnosis([], ambiguous=[("coulomb-friction", "offset")]))
        self.assertEqual((found["exact"], found["in_set"]), (False, True))

    def test_nothing_named_where_nothing_is_hidden_is_exact(self):
        self.assertTrue(self.score([], diagnosis([("offset", "tentative", {})]))["exact"])

    def test_a_list_of_names_that_the_rounds_do_not_bear_out_is_an_error(self):
        found = diagnosis([("offset", "tentative", {})])
        found["named"] = ["offset"]
        self.assertRaises(ValueError, self.score, [OFFSET], found)


class Parameters(unittest.TestCase):
    def test_an_interval_holds_a_phase_across_the_half_turn(self):
        phase = (-178.0, -188.0, -168.0)
        rows = score.parameters([RIPPLE], diagnosis([ripple(3, (0.21, 0.205, 0.215), phase)]), 40.0)
        self.assertEqual({row["parameter"]: round(row["beyond"], 6) for row in rows},
                         {"ripple.amplitude_nm": 2.0, "ripple.phase_deg": 0.7})
        self.assertAlmostEqual(rows[0]["relative"], 0.05)

    def test_no_interval_counts_neither_way_and_a_wrong_name_has_no_parameters(self):
        found = diagnosis([ripple(3, (0.2, None, None))])
        self.assertIsNone(score.parameters([RIPPLE], found, 40.0)[0]["beyond"])
        self.assertEqual(score.parameters([OFFSET], found, 40.0), [])


class Gap(unittest.TestCase):
    def test_the_share_is_that_of_the_explainable_energy(self):
        self.assertAlmostEqual(score.share_closed(0.5, 0.06, 0.06), 1.0)
        self.assertAlmostEqual(score.share_closed(0.5, 0.5, 0.06), 0.0)
        self.assertIsNone(score.share_closed(0.061, 0.06, 0.06))

    def test_a_place_counts_when_it_overlaps_and_is_not_the_whole_log(self):
        case = cases.studies("outside", 1)[0]
        for span, right in (([10.1, 10.3], True), ([0.0, 40.0], False), ([20.0, 20.5], False), (None, False)):
            found = diagnosis([], remaining=span and {"kind": "time", "where": span})
            self.assertEqual(score.place(case, (10.0, 10.4), found), right, span)
