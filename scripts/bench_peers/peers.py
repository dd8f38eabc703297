# SPDX-License-Identifier: MIT
"""Who the tool is measured against, where each is found, and in which version."""

import json
import pathlib
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
PROGRAMS = HERE / "programs"


def output_of(words):
    try:
        return subprocess.run(words, capture_output=True, text=True, timeout=120).stdout.strip()
    except OSError:
        return ""


class Peers:
    """`missing`: {who: why}. What is missing is left out of the tables, by name."""

    def __init__(self, python, fetch):
        self.python, self.missing, self.versions = python, {}, {}
        code = "import sys, numpy, scipy, pandas; print(sys.version.split()[0], numpy.__version__, scipy.__version__, pandas.__version__)"
        found = output_of([python, "-c", code]).split()
        if found:
            self.versions |= dict(zip(("Python", "NumPy", "SciPy", "pandas"), found))
        else:
            self.missing["pandas, NumPy and SciPy"] = f"{python} has not all three"
        octave = output_of(["octave", "--version"]).split("\n")[0].split()
        if octave:
            self.versions["Octave"] = octave[-1]
        else:
            self.missing["Octave"] = "there is no octave"
        self._look_for_node(fetch)

    def _look_for_node(self, fetch):
        """Polars and DuckDB from npm. `npm ci` would ask for the packages of every system, which not every mirror has."""
        if not shutil.which("node"):
            self.missing["Polars and DuckDB"] = "there is no node"
            return
        if fetch and shutil.which("npm") and not (HERE / "node_modules").is_dir():
            subprocess.run(["npm", "install", "--no-save", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"],
                           cwd=HERE, stdout=subprocess.DEVNULL)
        for name, package in (("Polars", "nodejs-polars"), ("DuckDB", "@duckdb/node-api")):
            described = HERE / "node_modules" / package / "package.json"
            if described.is_file():
                self.versions[name] = json.loads(described.read_text())["version"]
            else:
                self.missing[name] = f"npm package {package} is not installed"

    def has(self, name):
        return name in self.versions

    def script(self, name, *words):
        return [self.python, "-B", PROGRAMS / name, *words]

    @staticmethod
    def node(name, *words):
        return ["node", PROGRAMS / name, *words]

    @staticmethod
    def octave(*words):
        return ["octave", "--no-gui", "-qf", PROGRAMS / "octave.m", *words]
