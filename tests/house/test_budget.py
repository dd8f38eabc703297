# SPDX-License-Identifier: MIT
"""No source is longer than 300 lines. A list of data may be: rules.def is one entry after another, each read by itself."""

import os
import pathlib
import unittest

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])
MOST_LINES = 300


class Budget(unittest.TestCase):
    def test_no_source_is_longer_than_a_reader_keeps_in_mind(self):
        files = [path for folder in ("include", "src", "scripts") for path in sorted((SOURCE / folder).rglob("*"))
                 if path.is_file() and path.suffix in (".hpp", ".cpp", ".py", "")]
        self.assertGreater(len(files), 600)
        lengths = {str(path.relative_to(SOURCE)): len(path.read_text().splitlines()) for path in files}
        self.assertEqual({name: lines for name, lines in lengths.items() if lines > MOST_LINES}, {})


if __name__ == "__main__":
    unittest.main()
