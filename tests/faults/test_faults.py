# SPDX-License-Identifier: MIT
"""A short round of scripts/prove-trust faults: some seconds."""

import os
import time
import unittest

from commands import SOURCE, TOOL, Case
from prove_trust import faults
from prove_trust.workshop import Workshop

PRELOADABLE, LIBRARY = os.environ.get("RIPPLENOTCH_PRELOADABLE"), os.environ.get("RIPPLENOTCH_FAULTS")


class Faults(Case):
    def test_a_short_round(self):
        shop = Workshop(PRELOADABLE or TOOL, SOURCE, self.folder, faults.ROWS)
        rows = faults.short_round(faults.Saboteur(shop, LIBRARY), 4, time.monotonic() + 60.0)
        # Under sanitizers nothing is preloaded: full streams and full disks are left.
        self.assertGreater(sum(row.runs for row in rows), 30 if PRELOADABLE else 10)
        self.assertEqual([finding for row in rows for finding in row.findings], [])

    @unittest.skipUnless(PRELOADABLE, "no preloaded library under sanitizers")
    def test_without_threads_a_long_log_is_filtered_by_one(self):
        shop = Workshop(PRELOADABLE, SOURCE, self.folder, 200_000)  # more than is done before threads are started
        saboteur = faults.Saboteur(shop, LIBRARY)
        self.assertEqual(saboteur.run("filter", (0,), THREADS=1), (0, []))
