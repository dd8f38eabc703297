# SPDX-License-Identifier: MIT
"""A short round of scripts/prove-trust kills: some seconds."""

import os
import signal
import unittest

from commands import SOURCE, TOOL, Case
from prove_trust.kills import CAUGHT, Killer
from prove_trust.workshop import Workshop

PRELOADABLE, FAULTS = os.environ.get("RIPPLENOTCH_PRELOADABLE"), os.environ.get("RIPPLENOTCH_FAULTS")
SIGNALS = [getattr(signal, f"SIG{name}") for name in CAUGHT]


class Kills(Case):
    ROWS = 20_000

    def killer(self, tool, settings=None):
        return Killer(Workshop(tool, SOURCE, self.folder, self.ROWS), 1, settings)

    def test_a_kill_that_nobody_can_catch_leaves_nothing(self):
        killer = self.killer(TOOL)
        for name in killer.shop.commands():
            for _ in range(3):
                self.assertEqual(killer.kill(name, signal.SIGKILL), [])

    def test_signals_that_can_be_caught_leave_nothing(self):
        killer = self.killer(TOOL)
        for number in SIGNALS:
            self.assertEqual(killer.kill("filter", number), [])
            self.assertEqual(killer.kill("spectrum of a pipe", number), [])

    @unittest.skipUnless(PRELOADABLE, "no preloaded library under sanitizers")
    def test_where_every_file_has_a_name_signals_take_it_away(self):
        killer = self.killer(PRELOADABLE, {"LD_PRELOAD": FAULTS, "FAULT_NAMELESS": "1"})
        for number in SIGNALS:
            self.assertEqual(killer.kill("filter", number), [])
        for _ in range(6):  # leaves a name that no later run uses
            self.assertEqual(killer.kill("filter", signal.SIGKILL), [])
