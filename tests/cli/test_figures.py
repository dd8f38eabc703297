# SPDX-License-Identifier: MIT
"""The pictures of the documentation show what the tool shows today: compared by their data, not by their pixels."""

import json
import math
import os
import re
import subprocess

from commands import SOURCE, Case, ended, run

FIGURES = SOURCE / "docs" / "figures"


def alike(kept, made, path=""):
    """Where two documents differ, or None. Numbers may differ in their last digits: another compiler, another cosine."""
    if isinstance(kept, dict) and isinstance(made, dict):
        if kept.keys() != made.keys():
            return f"{path}: fields {sorted(kept)} and {sorted(made)}"
        return next(filter(None, (alike(kept[k], made[k], f"{path}.{k}") for k in kept)), None)
    if isinstance(kept, list) and isinstance(made, list):
        if len(kept) != len(made):
            return f"{path}: {len(kept)} and {len(made)} entries"
        return next(filter(None, (alike(a, b, f"{path}[{i}]") for i, (a, b) in enumerate(zip(kept, made)))), None)
    number = (int, float)
    if isinstance(kept, number) and isinstance(made, number) and not isinstance(kept, bool):
        return None if math.isclose(kept, made, rel_tol=1e-5, abs_tol=1e-6) else f"{path}: {kept} and {made}"
    return None if kept == made else f"{path}: {kept!r} and {made!r}"


class Figures(Case):
    def test_every_picture_shows_what_its_command_shows_today(self):
        ended(0, subprocess.run([SOURCE / "scripts" / "make-figures", self.folder], capture_output=True, timeout=120,
                                env=dict(os.environ, ONLY_DATA="1")))
        made = {path.name: json.loads(path.read_text()) for path in self.folder.glob("*.json")}
        kept = {path.name: json.loads(path.read_text()) for path in FIGURES.glob("*.json")}
        self.assertEqual(sorted(kept), sorted(made))
        for name in kept:
            kept[name].pop("version"), made[name].pop("version")
            self.assertIsNone(alike(kept[name], made[name], name), "run scripts/make-figures and look at the pictures")

    def test_every_picture_on_a_page_is_there_with_its_data(self):
        for page in (FIGURES / "README.md", SOURCE / "README.md"):
            names = re.findall(r"!\[[^]]+\]\(([^)]+\.png)\)", page.read_text())
            self.assertTrue(names, page)
            for name in names:
                picture = page.parent / name
                self.assertTrue(picture.with_suffix(".json").is_file(), name)
                self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n", name)

    def test_every_listed_figure_is_on_the_page_and_in_its_command_s_help(self):
        listed = re.findall(r'^FIGURE\("([\w-]+)", "(\w+)"\)', (SOURCE / "src" / "figure" / "figures.def").read_text(), re.M)
        shown = re.findall(r"!\[[^]]+\]\(([^)]+)\.png\)", (FIGURES / "README.md").read_text())
        names = [json.loads((FIGURES / f"{name}.json").read_text())["name"] for name in shown]
        for name, command in listed:
            self.assertIn(name, names, f"docs/figures/README.md has no picture of figure {name}")
            help_text = run(command, "--help-all").stdout
            self.assertRegex(help_text, rf"as a picture \([^)]*\b{name}\b", command)
        self.assertEqual(set(names), {name for name, _ in listed}, "src/figure/figures.def")

    def test_pictures_are_small(self):
        for path in FIGURES.glob("*.png"):
            self.assertLess(path.stat().st_size, 300_000, path.name)
