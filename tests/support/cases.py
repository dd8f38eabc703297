# SPDX-License-Identifier: MIT
"""Tests of a Python file, class by class, so that each is one ctest that fails, passes or is skipped by itself.

usage: cases.py list FILE...        the interpreter itself, whatever script started it; then "FILE CLASS", a line each, and
                                    "FILE CLASS SHORT" where the class has a short version, since it asks for SHORT
       cases.py run FILE [TEST...]  all tests of the file, or these (CLASS, CLASS.test_name); exit code 77 where all were skipped
"""

import ast
import importlib.util
import pathlib
import sys
import unittest

SKIPPED = 77


def classes_with_tests(path):
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.ClassDef) and any(
                isinstance(item, ast.FunctionDef) and item.name.startswith("test_") for item in node.body):
            short = any(isinstance(name, ast.Name) and name.id == "SHORT" for name in ast.walk(node))
            yield node.name + (" SHORT" if short else "")


def run(path, names):
    sys.path.insert(0, str(path.parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    load = unittest.defaultTestLoader
    tests = load.loadTestsFromNames(names, module) if names else load.loadTestsFromModule(module)
    result = unittest.TextTestRunner(verbosity=2).run(tests)
    if not result.wasSuccessful() or result.testsRun == 0:
        return 1
    return SKIPPED if len(result.skipped) == result.testsRun else 0


if __name__ == "__main__":
    if sys.argv[1] == "list":
        print(sys.executable)
        for file in sys.argv[2:]:
            for name in classes_with_tests(pathlib.Path(file)):
                print(file, name)
    else:
        sys.exit(run(pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]))
