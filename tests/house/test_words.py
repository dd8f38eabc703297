# SPDX-License-Identifier: MIT
"""What people read, the strings of the program and its pages, is standard technical English: these words are not used."""

import re
import unittest

from commands import SOURCE

# (what is not written, what is written instead)
WORDS = [
    (r"\btold\b|\btelling\b", "reported, determined, distinguished, stated"),
    # "Cannot tell" is the name of an outcome.
    (r"(?<!annot )(?<!annot\n)\btells?\b", "shows, determines, distinguishes, states"),
    (r"\bbeside\b", "with, next to, alongside, in addition to"),
    (r"\bleft-?overs?\b|\b[Ww]hat is left\b|\bis left of\b", "residual, remaining"),
    (r"\bmere\b", "only"),
    (r"\bstand(?:s|ing)? out\b|\bstood out\b", "rises above the noise"),
    (r"\blate at most\b|\bms late\b|\blate, ms\b", "delay, maximum delay"),
    (r"\b(?:take[sn]?|taking) off\b|\bdB off\b", "attenuates by, subtracts"),
    (r"\b(?:take[sn]?|taking) out\b|\btakes the ripple out\b", "removes, attenuates"),
    (r"\b[Hh]um(?:s|ming)?\b", "tone, narrow-band noise"),
    (r"\bevenness\b", "consistency"),
    (r"\bforth and back\b", "back and forth"),
    (r"\bto and fro\b", "back and forth"),
    (r"\bnot there\b", "ignored, missing, atomically"),
    (r"\bin force\b", "active"),
    (r"\bbelie(?:ve[ds]?|f)\b", "expected, accepted"),
    (r"\boff by\b|\b[Oo]ff by\b", "error"),
    (r"\bof ripple left\b|\bof its power left\b", "remaining"),
    (r"\bmend(?:s|ed)?\b", "correct"),
    (r"\bsay (?:-|which|what|how|where)", "use, select, state"),
    (r"\bhouse\b|\brooms?\b|\bguests?\b|\bdoors?\b", "architecture, module, new entry, entry point"),
    (r"(?:^|[.:;!?]\s+|\n\n)Of (?:an?|the|what|one|several|two|all|every|each|results)\b",
     "a whole sentence that begins with its subject"),
]


def prose(markdown):
    """Without code, which is quoted as it is."""
    return re.sub(r"`[^`\n]*`|\]\([^)\s]*\)", "CODE", re.sub(r"^ *```.*?^ *```", "", markdown, flags=re.S | re.M))


def strings(code):
    """The string literals, those that the compiler joins joined; a string without a space is a name."""
    code = re.sub(r"//[^\n\"]*$", "", re.sub(r"^\s*(?://|#).*$", "", code, flags=re.M), flags=re.M)
    literal = r'"(?:[^"\\\n]|\\.)*"'
    for joined in re.findall(rf'{literal}(?:\s*{literal})*', code):
        text = "".join(part[1:-1] for part in re.findall(literal, joined)).replace("\\n", "\n")
        if " " in text:
            yield text


def read():
    for path in [SOURCE / "README.md", *sorted((SOURCE / "docs").rglob("*.md"))]:
        yield path, [prose(path.read_text())]
    for kind in ("cpp", "hpp", "def"):
        for path in sorted((SOURCE / "src").rglob(f"*.{kind}")):
            yield path, list(strings(path.read_text()))


class Words(unittest.TestCase):
    def test_text_that_people_read_is_standard_english(self):
        found = []
        for path, texts in read():
            name = str(path.relative_to(SOURCE))
            for text in texts:
                for pattern, instead in WORDS:
                    for hit in re.finditer(pattern, text):
                        around = " ".join(text[max(0, hit.start() - 60):hit.end() + 60].split())
                        found.append(f"{name}: '{hit[0].strip()}' ({instead}) in: {around}")
        self.assertEqual([], found, "\n" + "\n".join(found))

    def test_the_check_sees_strings_that_are_split_and_leaves_names(self):
        self.assertEqual(["the ripple takes off", "a b"], list(strings('f("the ripple "\n   "takes off", "doubts", "a b");')))
