# SPDX-License-Identifier: MIT
"""Every command, method, format and effect that is listed has its page, and a command's page names every option."""

import re
import unittest

from commands import COMMANDS, SOURCE, ended, run


# kind, which is its folder of docs -> (the list, the pattern of its lines)
REGISTRIES = {
    "commands": ("src/cli/commands.def", r"COMMAND\((\w+)\)"),
    "methods": ("src/filter/methods/methods.def", r"METHOD\((\w+)\)"),
    "formats": ("src/log/formats/formats.def", r"FORMAT\((\w+)\)"),
    "effects": ("src/model/effects/effects.def", r"EFFECT\((\w+)\)"),
    "motions": ("src/model/motions.cpp", r"const MotionKind (\w+)_motion\{"),
    "export": ("src/export/targets/targets.def", r"TARGET\((\w+)\)"),
}


def listed(kind):
    path, pattern = REGISTRIES[kind]
    text = (SOURCE / path).read_text()
    return [name.rstrip("_").replace("_", "-") for name in re.findall(rf"^{pattern}", text, re.M)]


def named(kind, but=()):
    return ", ".join(name for name in listed(kind) if name not in but)


# Formats that are read and not written; none so far.
READ_ONLY = [name for name in listed("formats")
             if ".write_columns" not in (SOURCE / "src/log/formats" / f"{name.replace('-', '_')}.cpp").read_text()]
# Option -> the list that its help prints, for the commands that have it.
HELP_LISTS = {
    ("filter", "--method"): named("methods"),
    ("compare", "--method"): named("methods"),
    ("export", "--to"): named("export"),
    ("simulate", "--motion"): named("motions"),
    **{(command, "--format"): named("formats")
       for command in ("info", "spectrum", "identify", "map", "filter", "compare", "recommend", "diagnose")},
    ("simulate", "--format"): named("formats", READ_ONLY),
    ("filter", "--output-format"): named("formats", READ_ONLY),
}


class HelpLists(unittest.TestCase):
    def help_of(self, command, option):
        text = run(command, "--help-all").stdout
        found = re.search(rf"^ +(?:-\w,)?{option}\b.*?(?=^ +-|^[A-Z\n]|\Z)", text, re.M | re.S)
        self.assertIsNotNone(found, f"{command} has no {option}")
        return " ".join(found[0].split())

    def test_help_names_all_that_is_listed_in_the_order_of_the_list(self):
        for (command, option), names in HELP_LISTS.items():
            self.assertIn(names, self.help_of(command, option), f"{command} {option}")

    def test_every_option_stands_on_the_page_of_its_command(self):
        """Or on the page of all commands, but for what only some of them have."""
        common = (SOURCE / "docs/commands/README.md").read_text()
        for command in listed("commands"):
            page = f"docs/commands/{command}.md"
            text = (SOURCE / page).read_text()
            for option in re.findall(r"^ +(?:-\w,)?(--[a-z][a-z0-9-]+)", run(command, "--help-all").stdout, re.M):
                places = text if option == "--plot" else text + common
                self.assertTrue(re.search(rf"{option}(?![\w-])", places), f"{page} has no {option}")

    def test_no_list_is_written_by_hand(self):
        for kind in REGISTRIES:
            if kind == "commands":
                continue
            names = [re.escape(name) for name in listed(kind)]
            two = re.compile(rf"\b({'|'.join(names)}), ({'|'.join(names)})\b")
            for path in sorted((SOURCE / "src").rglob("*.cpp")):
                code = re.sub(r"^ *//.*", "", path.read_text(), flags=re.M)
                for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', code):
                    self.assertIsNone(two.search(text), f"{path.relative_to(SOURCE)} lists {kind} by hand: {text}")


class Pages(unittest.TestCase):
    def test_the_laws_of_the_commands_go_through_every_one(self):
        self.assertEqual({words.split()[0] for words in COMMANDS.values()}, set(listed("commands")))

    def test_every_command_that_is_defined_is_listed(self):
        defined = {name.rstrip("_") for path in (SOURCE / "src" / "cli").rglob("*.cpp")
                   for name in re.findall(r"^const Command commands::(\w+)", path.read_text(), re.M)}
        self.assertEqual(defined, set(listed("commands")))

    def test_everything_listed_has_a_page(self):
        for kind in REGISTRIES:
            names = listed(kind)
            self.assertTrue(names, kind)
            page = SOURCE / "docs" / kind / "README.md"
            for name in names:
                one_page = (SOURCE / "docs" / kind / f"{name}.md").is_file()
                self.assertTrue(one_page or f"`{name}`" in page.read_text(), f"docs/{kind} has no page and no row of {name}")

    def test_a_page_of_a_command_names_every_option_of_its_help(self):
        common = (SOURCE / "docs" / "commands" / "README.md").read_text()
        for name in listed("commands"):
            done = run(name, "--help-all")
            self.assertEqual((done.returncode, done.stderr), (0, ""), f"{name} cannot declare its options")
            page = (SOURCE / "docs" / "commands" / f"{name}.md").read_text() + common
            for option in sorted(set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", done.stdout))):
                self.assertRegex(page, re.escape(option) + r"(?![a-z-])", f"docs/commands/{name}.md lacks {option}")

    def test_every_command_refuses_an_unknown_option_with_exit_code_2(self):
        for name in listed("commands"):
            done = run(name, "--no-such-option")
            self.assertEqual(done.returncode, 2, name)
            self.assertEqual(done.stdout, "")
            self.assertIn("--no-such-option", done.stderr)

    def test_a_mistyped_option_is_answered_with_the_nearest(self):
        ended(2, run("design", "--gear-ration", "100"), "did you mean --gear-ratio?")

    def test_a_mistyped_name_of_any_list_is_answered_with_the_nearest(self):
        log = SOURCE / "data" / "paper_rest.csv"
        for words, nearest in ((("info", log, "--format", "cvs"), "csv"), (("filter", log, "--method", "swiching"), "switching"),
                               (("export", log, "--to", "c-heder"), "c-header"), (("diagnose", "--effect", "vicous-friction"), "viscous-friction"),
                               (("simulate", "--sample-rate", "1kHz", "--gear-ratio", "100", "--motion", "sien"), "sine")):
            ended(2, run(*map(str, words)), f"(did you mean {nearest}?)")

    def test_a_mistyped_option_before_a_command_is_answered_too(self):
        for words, message in ((("--vesrion",), "there is no option --vesrion before a command (did you mean --version?)"),
                               (("--nosuch", "identify", "log.csv"), "there is no option --nosuch before a command; see ripplenotch --help")):
            done = run(*words)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(message, done.stderr)

    def test_an_option_given_twice_is_named(self):
        ended(2, run("design", "--gear-ratio", "100", "--gear-ratio", "101"), "--gear-ratio is given more than once")

    def test_a_mistyped_command_is_answered_with_the_nearest(self):
        ended(2, run("filtre"), "did you mean filter?")
