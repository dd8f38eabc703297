# SPDX-License-Identifier: MIT
"""What commands print and write stays what it was, until somebody changes it on purpose (frozen.py says how)."""

import json
import os
import unittest

import frozen


class Frozen(unittest.TestCase):
    def test_outputs_are_what_they_were(self):
        found = {name: value for name, (value, _) in frozen.outcomes(os.environ["RIPPLENOTCH"]).items()}
        expected = json.loads(frozen.HASHES.read_text())
        self.assertGreater(len(expected), 55)
        self.assertEqual(sorted(name for name in {*found, *expected} if found.get(name) != expected.get(name)), [])
