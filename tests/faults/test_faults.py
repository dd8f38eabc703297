# SPDX-License-Identifier: MIT
"""A short round of scripts/prove-trust faults: some seconds."""

import os
import pathlib
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])
sys.path.insert(0, str(SOURCE / "scripts"))
sys.dont_write_bytecode = True

from prove_trust import faults  # noqa: E402
from prove_trust.workshop import Workshop  # noqa: E402

TOOL = os.environ["RIPPLENOTCH"]
PRELOADABLE, LIBRARY = os.environ.get("RIPPLENOTCH_PRELOADABLE"), os.environ.get("RIPPLENOTCH_FAULTS")


class Faults(unittest.TestCase):
    def test_a_short_round(self):
        with tempfile.TemporaryDirectory() as folder:
            shop = Workshop(PRELOADABLE or TOOL, SOURCE, folder, faults.ROWS)
            rows = faults.short_round(faults.Saboteur(shop, LIBRARY), 4, time.monotonic() + 60.0)
        # Under sanitizers nothing is preloaded: full streams and full disks are left.
        self.assertGreater(sum(row.runs for row in rows), 30 if PRELOADABLE else 10)
        self.assertEqual([finding for row in rows for finding in row.findings], [])

    @unittest.skipUnless(PRELOADABLE, "no preloaded library under sanitizers")
    def test_without_threads_a_long_log_is_filtered_by_one(self):
        with tempfile.TemporaryDirectory() as folder:
            shop = Workshop(PRELOADABLE, SOURCE, folder, 200_000)  # more than is done before threads are started
            saboteur = faults.Saboteur(shop, LIBRARY)
            self.assertEqual(saboteur.run("filter", (0,), THREADS=1), (0, []))


if __name__ == "__main__":
    unittest.main()
