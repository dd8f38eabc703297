# SPDX-License-Identifier: MIT
"""Man pages and the completion for bash are made of what --help is made of: the same options, no more and no fewer; and the programs
that read them take them."""

import json
import re
import shutil
import subprocess
import tempfile
import unittest

from commands import SOURCE, Case, run


def printed(kind):
    done = run("--generate", kind)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    return done.stdout


def commands():
    listed = run("--help").stdout.split("Look at a log:")[1].split("Begin with")[0]
    return re.findall(r"^  (\S+)", listed, re.M)


def options_of_help(command):
    """Names of options, as --help-all has them: '-o', '--output'."""
    lines = run(command, "--help-all").stdout.split("\nOptions:\n")[1]
    return {name for line in re.findall(r"^  (-\S+)", lines, re.M) for name in line.split(",")}


class Reference(unittest.TestCase):
    def test_a_man_page_has_the_options_of_the_help(self):
        for command in commands():
            with self.subTest(command):
                section = printed(f"man-{command}").split(".SH OPTIONS\n")[1].split(".SH ")[0]
                heads = "\n".join(re.findall(r"^\.TP\n(.*)$", section, re.M))
                names = {name.replace("\\-", "-") for name in re.findall(r"\\fB(.*?)\\fR", heads)}
                self.assertEqual(names, options_of_help(command))

    def test_bash_has_the_options_of_the_help(self):
        script = printed("complete-bash")
        for command in commands():
            with self.subTest(command):
                branch = script.split(f"\n        {command})\n")[1].split("\n            ;;\n")[0]
                self.assertEqual(set(re.search(r'options="(.*)"', branch)[1].split()), options_of_help(command))

    def test_the_catalogue_has_all_that_the_commands_take(self):
        catalogue = json.loads(run("help", "--json").stdout)
        self.assertEqual([one["name"] for one in catalogue["commands"]], list(commands()))
        for command in catalogue["commands"]:
            with self.subTest(command["name"]):
                names = {name for option in command["options"] if option["kind"] != "argument" for name in option["names"]}
                self.assertEqual(names, options_of_help(command["name"]))
        effects = run("diagnose", "--effects").stdout
        for effect in catalogue["effects"]:
            self.assertIn(effect["name"], effects)
            self.assertIn(f"`{effect['name']}`", (SOURCE / "docs/effects/README.md").read_text())
        for kind in ("methods", "export", "formats"):
            pages = "".join(page.read_text() for page in (SOURCE / "docs" / kind).glob("*.md"))
            for one in catalogue["targets" if kind == "export" else kind]:
                self.assertIn(one["name"], pages)
        self.assertEqual(catalogue, json.loads(run("--generate", "catalogue").stdout))

    def test_exit_codes_are_those_of_the_docs(self):
        page = (SOURCE / "docs/commands/README.md").read_text().split("## Exit codes")[1]
        documented = re.findall(r"^\| (\d+) \|", page, re.M)
        told = re.findall(r"^\.TP\n\\fB(\d+)\\fR$", printed("man").split(".SH EXIT STATUS\n")[1], re.M)
        self.assertEqual(told, documented)

    def test_help_is_short_and_help_all_is_whole(self):
        short, whole = run("identify", "--help").stdout, run("identify", "--help-all").stdout
        self.assertNotIn("--hold-bad-values", short)
        self.assertIn("--help-all", short)
        self.assertIn("How the log is read:", whole)
        for text in (short, whole):
            self.assertNotIn("INT in [", text)
        listed = run("--help").stdout
        for group in ("Look at a log:", "Filter it:", "Model the joint:", "Fleets:", "Report:"):
            self.assertIn("\n" + group, listed)


class Bash(Case):
    def completed(self, *words):
        script = printed("complete-bash") + (
            f'COMP_WORDS=({" ".join(words)} "$1"); COMP_CWORD={len(words)}; _ripplenotch; printf "%s\\n" "${{COMPREPLY[@]}}"')
        done = subprocess.run(["bash", "-c", script, "bash", self.last], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def setUp(self):
        super().setUp()
        (self.folder / "log.csv").touch()

    def test_commands_options_choices_and_files(self):
        for words, last, expected in (
                (["ripplenotch"], "id", ["identify"]),
                (["ripplenotch", "spectrum"], "--dom", ["--domain"]),
                (["ripplenotch", "spectrum", "--domain"], "o", ["order"]),
                (["ripplenotch", "identify", "--gear-ratio"], "", []),
                (["ripplenotch", "identify"], "lo", ["log.csv"]),
                (["ripplenotch", "nonsense"], "--", [])):
            with self.subTest(" ".join(words)):
                self.last = last
                self.assertEqual(self.completed(*words), expected)


def checked_by(program, *words):
    @unittest.skipUnless(shutil.which(program), f"SKIPPED: there is no {program} here")
    def check(self):
        for kind in self.kinds():
            with self.subTest(kind), tempfile.NamedTemporaryFile("w", suffix=".1") as file:
                file.write(printed(kind))
                file.flush()
                done = subprocess.run([program, *words, file.name], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
    return check


class ManByGroff(unittest.TestCase):
    def kinds(self):
        return ["man"] + [f"man-{command}" for command in commands()]
    test_it_finds_nothing_wrong = checked_by("groff", "-man", "-ww", "-z")
