# SPDX-License-Identifier: MIT
"""What scripts/bench-peers says of a record: ratios of medians, which of them are as they must be, what was not measured."""

import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"], "scripts")))
sys.dont_write_bytecode = True

from bench_peers import page  # noqa: E402


def runs(*triples):
    return [dict(zip(("wall_s", "cpu_s", "peak_mib"), triple)) for triple in triples]


def record():
    case = {"mb": 1.0, "failed": {}, "runs": {"ripplenotch": runs((1, 2, 30), (9, 9, 31), (1.5, 3, 29)), "cp": runs((0.5, 0.5, 2))}}
    fixed = case | {"runs": case["runs"] | {"pandas + SciPy": runs((200, 270, 700)), "Polars, no filter": runs((3, 6, 90))}}
    kernels = {"ripplenotch": {page.WELCH: {"work": 1e7, "cpu_s": [0.04, 0.05, 9.0]}},
               "scipy": {"welch": {"work": 1e7, "cpu_s": [0.2, 0.3, 0.25]}}}
    return {"date": "2000-01-01", "version": "0", "commit": "0", "machine": "A machine.", "peers": {"SciPy": "1"}, "missing": {"Octave": "none"},
            "rows": 10, "fixed": fixed, "full": case, "npy": case, "pipes": case, "short": case, "kernels": kernels,
            "analysis": {"identify, moves, 5 rows": {"rows": 5, "failed": {}, "runs": runs((1, 1, 1))},
                         "spectrum --segment 4.096s, one speed, 50 rows": {"rows": 50, "failed": {}, "runs": runs((1, 1, 14), (1, 1, 13), (1, 1, 12))},
                         "spectrum, moves, 5 rows": {"rows": 5, "failed": {"spectrum": "no room"}, "runs": []}},
            "growth": [{"joints": 2, "rows": 100, "mb": 1.0, "failed": {}, "runs": runs((1, 2e-6, 3)), "copies": runs((1, 1e-6, 2))},
                       {"joints": 7, "rows": 100, "mb": 1.0, "failed": {"ripplenotch": "no such option"}, "runs": [], "copies": []}]}


class Page(unittest.TestCase):
    def setUp(self):
        self.promises = {line[0]: line[1:] for line in page.promises(record())}

    def test_a_ratio_is_that_of_the_medians(self):
        self.assertEqual(self.promises["CSV, 6 decimals: CPU time of pandas + SciPy, relative"], ["at least 60 times", "90", "yes"])
        self.assertEqual(self.promises["Welch, segments of 4096: relative to SciPy"], ["at least 5 times", "5", "yes"])

    def test_a_promise_that_is_broken_says_so(self):
        self.assertEqual(self.promises["CSV, 6 decimals: CPU time of Polars without a filter, relative"], ["at least 3 times", "2", page.BROKEN])
        self.assertEqual(self.promises["npy: wall time relative to `cp`"], ["at most 2 times", "3", page.BROKEN])

    def test_the_median_of_memory_counts_not_the_highest_run(self):
        self.assertEqual(self.promises["CSV, 6 decimals: peak memory"], ["at most 32 MiB", "30", "yes"])

    def test_what_was_not_measured_is_neither_kept_nor_broken(self):
        self.assertEqual(self.promises["CSV of 100,000 rows, whole process: wall time of Octave, relative"], ["at least 30 times", "-", "not measured"])
        self.assertEqual(self.promises["fixed notch, one channel"][2], "not measured")

    def test_every_table_has_its_place_in_the_page(self):
        text = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"], "docs", "studies", "performance.md").read_text()
        for name in page.tables(record()):
            self.assertEqual(text.count(f"<!-- made by scripts/bench-peers: {name} -->"), 1, name)

    def test_growth_is_told_by_row_and_joint_and_a_failure_by_its_words(self):
        told = page.tables(record())["growth"]
        self.assertIn("| 100 | 2 | 1 | 1 | 2e-06 | 3 | 10 | 1e-06 |", told)
        self.assertIn("no such option", told)

    def test_memory_stands_beside_the_rows_of_each_analysis(self):
        told = page.tables(record())["analysis"]
        self.assertIn("| `identify`, moves | 5 | 1 | 1 | 1 |", told)
        self.assertIn("| `spectrum --segment 4.096s`, one speed | 50 | 1 | 1 | 13 |", told)
        self.assertIn("| `spectrum`, moves | 5 | no room | - | - |", told)

    def test_one_table_may_be_measured_alone(self):
        alone = page.analysis_alone(record())
        self.assertEqual(list(alone), ["analysis"])
        self.assertTrue(alone["analysis"].startswith("2000-01-01, commit 0, A machine."))
        self.assertIn(page.tables(record())["analysis"], alone["analysis"])

    def test_all_runs_are_kept(self):
        raw = page.tables(record())["raw"]
        for run in ("1 | 1.000 | 2.000 | 30.0", "2 | 9.000 | 9.000 | 31.0", "3 | 1.500 | 3.000 | 29.0"):
            self.assertIn(f"| fixed | ripplenotch | {run} |", raw)
        self.assertIn(f"| {page.WELCH} | ripplenotch | 3 | 9000.00 |", raw)


if __name__ == "__main__":
    unittest.main()
