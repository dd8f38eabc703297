# SPDX-License-Identifier: MIT
"""A ratchet: what ledger.json counts may only fall. A change that has to raise a number edits the file, and adds a "reason".

usage: test_ledger.py --update      lowers the numbers to what there is (cmake --build build/dev --target lower_ledger)"""

import json
import re
import sys
import unittest

from commands import COMMANDS, SOURCE, run

LEDGER = SOURCE / "tests/house/ledger.json"
CODE = (".hpp", ".cpp", ".def")
TYPE = re.compile(r"^[ \t]*(?:template <[^>]*>\s*)?(?:struct|class|enum(?: class)?) \w+[^;{(]*\{", re.M)
# A number that somebody picked, as its own comment says.
PICKED = re.compile(r"\b(?:chosen|by hand|tuned)\b", re.I)
DECLARED = re.compile(r"^\s*(?:static |inline )*(?:constexpr\b.*|(?:const )?[\w:<>, ]+ \w+ ?)(?:=|\{)")


def lines():
    """Of src and include, by room; what lies in no room is of `src`."""
    for top in ("src", "include/ripplenotch"):
        for path in (SOURCE / top).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                parts = path.relative_to(SOURCE / top).parts
                yield parts[0] if len(parts) > 1 else "src", path.read_bytes().count(b"\n")


def options():
    """Of all commands, each name once."""
    names = set()
    for command in {words.split()[0] for words in COMMANDS.values()}:
        names.update(re.findall(r"^ +(?:-\w,)?(--[a-z][a-z0-9-]+)", run(command, "--help-all").stdout, re.M))
    return names


def picked_constants(text):
    """Names with a value: of a comment in the same line, or of the statement that follows the comment."""
    count, above, statement = 0, False, ""
    for line in text.split("\n"):
        code, _, comment = line.partition("//")
        if not code.strip():
            if statement:
                continue
            above = bool(comment) and (above or bool(PICKED.search(comment)))
            continue
        statement += code
        above = above or bool(PICKED.search(comment))
        if not code.rstrip().endswith((";", "{", "}", ",")):
            continue
        if above and DECLARED.match(statement) and re.search(r"[={].*\d", statement):
            count += max(1, len(re.findall(r"\w ?= ?[^=]", statement)))
        statement, above = "", code.rstrip().endswith(",") and above
    return count


def counts():
    found = {}
    for room, number in lines():
        found[f"lines of {room}"] = found.get(f"lines of {room}", 0) + number
    found = dict(sorted(found.items()))
    sources = [path.read_text() for top in ("src", "include") for path in sorted((SOURCE / top).rglob("*")) if path.suffix in CODE]
    public = [path.read_text() for path in sorted((SOURCE / "include").rglob("*.hpp"))]
    found["options"] = len(options())
    found["public types"] = sum(len(TYPE.findall(text)) for text in public)
    found["constants that decide"] = sum(map(picked_constants, sources))
    return found


def recorded():
    return json.loads(LEDGER.read_text())


class Ledger(unittest.TestCase):
    def test_no_number_grows_but_with_a_reason_in_the_ledger(self):
        ledger = recorded()
        grown = [f"{name}: {number}, the ledger has {ledger.get(name, {'most': 0})['most']}" for name, number in counts().items()
                 if number > ledger.get(name, {"most": 0})["most"]]
        self.assertEqual(grown, [], "delete as much elsewhere, or raise the number in tests/house/ledger.json with a \"reason\"")

    def test_every_entry_is_a_number_with_a_reason_at_most(self):
        for name, entry in recorded().items():
            self.assertLessEqual(set(entry), {"most", "reason"}, name)
            self.assertIsInstance(entry["most"], int, name)

    def test_the_check_sees_constants_that_were_picked(self):
        self.assertEqual(picked_constants("// By hand: at least, and at most.\nconstexpr int least = 6, most = 9;\nint other = 3;\n"), 2)
        self.assertEqual(picked_constants("struct Limits {\n    double share = 0.5;  ///< chosen\n    double other = 1.0;\n};\n"), 1)
        self.assertEqual(picked_constants("// The chosen columns.\nconst auto columns = all();\nfilter(columns);  // by hand\n"), 0)


def update():
    ledger, found = recorded() if LEDGER.exists() else {}, counts()
    lowered = {name: {**ledger.get(name, {}), "most": min(number, ledger.get(name, {"most": number})["most"])}
               for name, number in found.items() if not ledger or name in ledger}
    LEDGER.write_text("{\n" + ",\n".join(f"  {json.dumps(name)}: {json.dumps(entry)}" for name, entry in lowered.items()) + "\n}\n")


if __name__ == "__main__":
    update() if sys.argv[1:] == ["--update"] else unittest.main()
