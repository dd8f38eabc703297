# SPDX-License-Identifier: MIT
"""Command lines and what they print, as text that a diff shows: cases/*.txt.

usage: frozen.py [SUBJECT...] [--accept]     --accept writes what the tool does today into the cases, for review by `git diff`

    # A sentence about a case           begins a new folder; `data` in it is the repository's, `shared` holds the real logs
    ## A sentence about another one     goes on in the same folder
    file NAME                           writes a file of the lines below that are indented by four blanks
    make NAME = steady(60, 0.5)         writes a log of tests/support/logs.py
    $ WORDS < NAME                      the tool with these words, or another program after `!`; `NAME=VALUE` before it is its environment
    ? 2                                 its exit code; 0 if none is said
    + NAME                              a new file that it left behind although it failed
    | TEXT                              standard output, line by line; `...` is any number of lines, or any text within a line
    ! TEXT                              standard error, likewise
    . joints.0.gear.ratio 100           a value of the JSON on standard output
    . out.json:gear.ratio 100           of a file; `bands#` is the hash of a list or an object
    = 0135652f0b932872                  hash of code, output, messages and what -o names, byte by byte
    ~ 0135652f0b932872                  the same with numbers at 5 significant digits

Of numbers 5 significant digits count, because libraries choose their instructions by the processor; bytes where the tool promises
them on every machine. A command that fails prints nothing, and one that succeeds has no message, if nothing else is said. Output
that no line speaks of is free. A change that is meant is accepted, and the CHANGELOG says what became different."""

import ast
import difflib
import hashlib
import itertools
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import logs  # noqa: E402
from commands import LOGS, SOURCE, TOOL  # noqa: E402

CASES = pathlib.Path(__file__).with_name("cases")
PATH = f"{pathlib.Path(TOOL).parent}:{os.environ.get('PATH', '')}"  # `! sh -c` finds the tool
NUMBER = re.compile(r"(?<![\w.])-?\d+\.\d+(?:e[-+]?\d+)?|(?<![\w.])-?\d+e[-+]?\d+")


def rounded(text):
    return NUMBER.sub(lambda number: f"{float(number[0]):.4e}", text)


def matches(wanted, text):
    """Whether lines with `...` describe a text."""
    lines = [re.escape(rounded(line)).replace(r"\.\.\.", ".*") + "\n" if line != "..." else "(?:.*\n)*" for line in wanted]
    return re.fullmatch("".join(lines), rounded(text).rstrip("\n") + "\n" if text.strip() else "") is not None


def accepted(wanted, text):
    """The lines that describe the text today: all of it, or those that are most like the ones that described it."""
    lines = text.rstrip("\n").split("\n") if text.strip() else []
    if "..." not in wanted:
        return lines
    near = [line if line == "..." else (difflib.get_close_matches(line, lines, 1, 0.0) or [line])[0] for line in wanted]
    return near if matches(near, text) else lines


def at(document, path):
    for step in path.rstrip("#").split("."):
        document = document[int(step) if isinstance(document, list) else step]
    text = json.dumps(document, ensure_ascii=False)
    if path.endswith("#"):
        return hashlib.sha256(rounded(text).encode()).hexdigest()[:16]
    short = NUMBER.sub(lambda number: f"{float(number[0]):.7g}", text)
    return short if rounded(short) == rounded(text) else text


def made(call):
    """The text of a log, of a call with literal arguments."""
    tree = ast.parse(call, mode="eval").body
    return getattr(logs, tree.func.id)(*map(ast.literal_eval, tree.args), **{one.arg: ast.literal_eval(one.value) for one in tree.keywords})


class Run:
    """A command of a case with the lines that describe it."""

    def __init__(self, words):
        self.words, self.about = words, []

    def said(self, kind):
        return [text for mark, text in self.about if mark == kind]

    def start(self, folder):
        words, stdin = self.words, subprocess.DEVNULL
        if " < " in words:
            words, name = words.rsplit(" < ", 1)
            stdin = open(folder / name, "rb")
        words = shlex.split(words)
        settings = dict(word.split("=", 1) for word in itertools.takewhile(lambda word: re.match(r"[A-Z_]+=", word), words))
        words = words[len(settings):]
        words = words[1:] if words[0] == "!" else [TOOL, *words]
        before = set(folder.rglob("*"))
        done = subprocess.run(words, cwd=folder, env={**os.environ, "PATH": PATH, **settings}, stdin=stdin, capture_output=True, timeout=300)
        self.code, self.out, self.err = done.returncode, *(text.decode("utf-8", "replace").replace(f"{folder}/", "") for text in (done.stdout, done.stderr))
        self.name = words[words.index("-o") + 1] if "-o" in words else None
        self.folder = folder
        self.left = sorted(str(path.relative_to(folder)) for path in set(folder.rglob("*")) - before) if self.code in (2, 3, 4) else []

    def hash(self, exact):
        text = self.out + self.err
        parts = [str(self.code).encode(), (text if exact else re.sub(r'"(?:sha256|version)": *"[^"]*"', "", rounded(text))).encode()]
        if self.name:
            path = self.folder / self.name
            bytes_ = path.read_bytes() if path.exists() else b"no file"
            parts.append(re.sub(rb'"(?:sha256|version)": *"[^"]*"', b"", bytes_ if exact else rounded(bytes_.decode("latin-1")).encode()))
        return hashlib.sha256(b"\0".join(parts)).hexdigest()[:16]

    def value(self, text):
        path = text.split(" ")[0]
        name, _, inside = path.rpartition(":")
        try:
            return f"{path} {at(json.loads((self.folder / name).read_text() if name else self.out), inside)}"
        except (OSError, ValueError, LookupError, TypeError):
            return f"{path} is not there"

    def today(self):
        """The lines that describe what it did: those that are there where they hold."""
        told = ([("?", str(self.code))] if self.code else []) + [("+", name) for name in self.left]
        for kind, text, unasked in (("|", self.out, self.code not in (0, 1, 5) and not self.said(".")), ("!", self.err, True)):
            wanted = self.said(kind)
            if wanted or unasked:
                told += [(kind, line) for line in (wanted if matches(wanted, text) else accepted(wanted, text))]
        for text in self.said("."):
            found = self.value(text)
            told.append((".", text if rounded(found) == rounded(text) else found))
        return told + [(kind, self.hash(kind == "=")) for kind, _ in self.about if kind in "=~"]


def check(path):
    """The case file as it would be written today, what differs, and how many commands ran and were skipped."""
    lines, differ, ran, skipped = path.read_text().split("\n"), [], 0, 0
    written, sentence, folder, keep, at_line = [], "", None, [], 0
    while at_line < len(lines):
        line = lines[at_line]
        at_line += 1
        if line.startswith("#"):
            sentence = line.lstrip("# ")
            if line.startswith("# "):
                keep.append(tempfile.TemporaryDirectory())
                folder = pathlib.Path(keep[-1].name)
                (folder / "data").symlink_to(SOURCE / "data")
                (folder / "shared").symlink_to(LOGS.parent)
        written.append(line)
        if line.startswith("file "):
            text = list(itertools.takewhile(lambda one: one.startswith("    "), lines[at_line:]))
            at_line += len(text)
            written += text
            (folder / line[5:]).write_text("".join(one[4:] + "\n" for one in text))
        elif line.startswith("make "):
            name, call = line[5:].split(" = ")
            (folder / name).write_text(made(call))
        elif line.startswith("$ "):
            run = Run(line[2:])
            about = list(itertools.takewhile(lambda one: re.match(r"[?+|!.=~]( |$)", one), lines[at_line:]))
            at_line += len(about)
            run.about = [(one[0], one[2:]) for one in about]
            if " shared/" in line and not LOGS.is_dir():
                skipped += 1
                written += about
                continue
            run.start(folder)
            ran += 1
            today = [f"{kind} {text}".rstrip() for kind, text in run.today()]
            written += today
            if today != about:
                differ.append(f"{path.name}:{at_line - len(about)}: {sentence}\n$ {run.words}\n" + "\n".join(
                    difflib.unified_diff(about, today, "expected", "today", lineterm="", n=1)))
    return "\n".join(written), differ, ran, skipped


def main(words):
    names = [word for word in words if not word.startswith("--")]
    paths = [CASES / f"{name}.txt" for name in names] or sorted(CASES.glob("*.txt"))
    wrong = ran = skipped = 0
    for path in paths:
        written, differ, done, left_out = check(path)
        wrong, ran, skipped = wrong + len(differ), ran + done, skipped + left_out
        if "--accept" in words:
            path.write_text(written)
        else:
            print("\n\n".join(differ))
    if skipped:
        print(f"SKIPPED: {skipped} commands, the folder of real logs is not here")
    print(f"{wrong} of {ran} commands differ" + (", accepted: look at git diff" if wrong and "--accept" in words else ""))
    return 1 if wrong and "--accept" not in words else 0 if ran else 77


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
