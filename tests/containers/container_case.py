# SPDX-License-Identifier: MIT
"""Logs in compressed files and containers, written by others than the tool. The law: any of them gives the same
`identify --json` as the CSV with the same numbers."""

import csv
import importlib.util
import json
import os
import pathlib
import re
import unittest

import commands
from commands import DATA


LOG = DATA / "paper_90deg_s.csv"


def there(module):
    return importlib.util.find_spec(module) is not None


def needs(module):
    return unittest.skipUnless(there(module), f"no {module} here to write the file")


class Case(commands.Case):
    bytes_out = True

    # Of the build, by their names in cmake/containers.cmake.
    libraries = ("ZLIB", "ZSTD", "LZ4")

    def setUp(self):
        missing = set(self.libraries) & set(os.environ["RIPPLENOTCH_LACKS"].split(","))
        if missing:
            self.skipTest(f"this build was made without {', '.join(sorted(missing))}")
        super().setUp()
        with open(LOG, newline="") as file:
            rows = list(csv.reader(file))
        self.names, self.rows = rows[0], [[float(cell) for cell in row] for row in rows[1:]]
        self.columns = {name: [row[c] for row in self.rows] for c, name in enumerate(self.names)}

    def run_tool(self, *words, code=0, **more):
        done = super().run_tool(*words, **more)
        self.assertEqual(done.returncode, code, done.stderr.decode()[-2000:])
        return done

    def identified(self, *words, stdin=None, command=("identify",)):
        found = json.loads(self.run_tool(command[0], "--json", *words, *command[1:], stdin=stdin).stdout)
        for field in ("inputs", "command"):
            found.pop(field)
        # The name of the log stands in sentences about it.
        text = json.dumps(found).replace("standard input" if words[0] == "-" else str(words[0]), "LOG")
        # So do the names of columns, which are paths in a container.
        return re.sub(r"'[^']*' \(column \d+\)", "COLUMN", text)

    said_of_twins = {}

    def assert_same(self, path, *options, twin=LOG, twin_options=()):
        """The twin is asked once: many containers have the same."""
        key = pathlib.Path(twin).name, (self.folder / twin).read_bytes(), twin_options
        if key not in self.said_of_twins:
            self.said_of_twins[key] = self.identified(twin, *twin_options)
        self.assertEqual(self.identified(path, *options), self.said_of_twins[key])

    def refusal(self, path, *options, command="info", code=3):
        said = self.run_tool(command, path, *options, code=code).stderr.decode().strip()
        self.assertEqual(len(said.split("\n")), 1, said)
        self.assertIn(str(path), said)
        return said

    def write(self, name, data):
        path = self.folder / name
        path.write_bytes(data)
        return path
