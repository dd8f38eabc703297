# SPDX-License-Identifier: MIT
"""The rules of a diagnosis: each is read where it decides, and no limit stands outside their list."""

import os
import pathlib
import re
import unittest

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])
LISTS = ("include/ripplenotch/diagnose/rules.def", "include/ripplenotch/model/fault_rules.def")


class Rules(unittest.TestCase):
    def test_every_rule_is_read_somewhere(self):
        rooms = ("diagnose", "model/effects")
        text = "\n".join(path.read_text() for room in rooms for path in sorted((SOURCE / "src" / room).rglob("*.cpp"))
                         if path.name != "rules.cpp")
        names = {name for path in LISTS for name in re.findall(r"^(?:NUMBER|WHOLE)\((\w+)", (SOURCE / path).read_text(), re.M)}
        self.assertGreater(len(names), 100)
        self.assertEqual([name for name in sorted(names) if not re.search(rf"[.>]{name}\b", text)], [])

    def test_no_source_of_the_diagnosis_has_limits_of_its_own(self):
        for path in sorted((SOURCE / "src/diagnose").rglob("*.cpp")):
            found = re.findall(r"^constexpr (?:double|int|long|std::size_t) (\w+) = (?!static_cast)", path.read_text(), re.M)
            self.assertEqual(found, [], f"{path.relative_to(SOURCE)} has limits that are no rules")


if __name__ == "__main__":
    unittest.main()
