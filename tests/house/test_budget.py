# SPDX-License-Identifier: MIT
"""A source is as long as its subject, 800 lines at most. A list of data may be longer: rules.def is one entry after another,
each read by itself."""

import os
import pathlib
import unittest

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])
MOST_LINES = 800


class Budget(unittest.TestCase):
    def test_no_source_holds_more_than_one_subject_needs(self):
        files = [path for folder in ("include", "src", "scripts") for path in sorted((SOURCE / folder).rglob("*"))
                 if path.is_file() and path.suffix in (".hpp", ".cpp", ".py", "")]
        self.assertGreater(len(files), 600)
        lengths = {str(path.relative_to(SOURCE)): len(path.read_text().splitlines()) for path in files}
        self.assertEqual({name: lines for name, lines in lengths.items() if lines > MOST_LINES}, {})


if __name__ == "__main__":
    unittest.main()
