# SPDX-License-Identifier: MIT
"""identify on logs in the layouts that people have, whose truth is known: ../shared/cases-4, section 2. Gear 100 where nothing
else is said, order 1 of 0.8 Nm and order 2 of 0.5 Nm zero to peak."""

import json
import unittest

from commands import LOGS, Case

CASES = LOGS.parent / "cases-4"


@unittest.skipUnless(CASES.is_dir(), "no logs of ../shared/cases-4")
class CasesOfUsers(Case):
    def answered(self, name, *words):
        done = self.run_tool("identify", "--json", "-q", CASES / f"{name}.csv.gz", *words)
        self.assertIn(done.returncode, (0, 5), done.stderr)
        return json.loads(done.stdout)

    @unittest.expectedFailure  # A line whose amplitude changes within a sweep by more than 40 % is lost.
    def test_an_amplitude_that_grows_with_speed(self):
        found = self.answered("ripple_grows_with_speed")
        for order in (100.0, 200.0):
            self.assertTrue(any(abs((line["order_output"] or 0.0) / order - 1.0) <= 0.01 for line in found["lines"]), found["verdict"])
        if found["conclusive"]:
            self.assertAlmostEqual(found["gear_ratio"]["value"], 100.0, delta=1.0)
