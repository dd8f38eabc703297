# SPDX-License-Identifier: MIT
"""A public header stands alone: it includes, itself or through another, what declares the names it uses.

A compiler is the better judge, and the preset `odr` asks it (each header alone, without precompiled headers). Here the names
are looked up, which costs no compiling: 155 headers compiled alone took a tenth of the whole build."""

import os
import pathlib
import re
import unittest

INCLUDE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"]) / "include"

COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"', re.S)
DIRECTIVE = re.compile(r"^\s*#.*$", re.M)
PROJECT_INCLUDE = re.compile(r'#include "(ripplenotch/[^"]+)"')
STANDARD_INCLUDE = re.compile(r"#include <(\w+)>")
DEFINED = re.compile(r"^(?:template <[^>]*>\s*)?(?:class|struct|enum class)\s+(\w+)[^;{()]*\{|^using (\w+) =|"
                     r"^(?:inline )?constexpr [\w:]+ (\w+)[ {=\[]", re.M)
OWN = re.compile(r"\b(?:class|struct|enum class|using|concept) (\w+)")

# std name -> headers of which any declares it.
STANDARD = {
    "vector": {"vector"}, "string": {"string"}, "string_view": {"string_view", "string"}, "optional": {"optional"}, "span": {"span"},
    "map": {"map"}, "set": {"set"}, "array": {"array"}, "function": {"functional"}, "variant": {"variant"}, "complex": {"complex"},
    "unique_ptr": {"memory"}, "shared_ptr": {"memory"}, "pair": {"utility", "map", "vector"}, "numeric_limits": {"limits"},
    "chrono": {"chrono"}, "initializer_list": {"initializer_list", "vector", "string"}, "deque": {"deque"}, "thread": {"thread"},
    "uint8_t": {"cstdint"}, "uint16_t": {"cstdint"}, "uint32_t": {"cstdint"}, "uint64_t": {"cstdint"}, "int64_t": {"cstdint"},
    "int32_t": {"cstdint"}, "exception": {"exception", "stdexcept"}, "runtime_error": {"stdexcept"}, "filesystem": {"filesystem"},
    "abs": {"cmath", "cstdlib", "complex"}, "sqrt": {"cmath", "complex"}, "max": {"algorithm"}, "min": {"algorithm"}, "numbers": {"numbers"},
}


class Headers:
    """Headers by the name under which they are included, with their text."""

    def __init__(self, texts):
        self.includes = {name: set(PROJECT_INCLUDE.findall(text)) for name, text in texts.items()}
        self.standard = {name: set(STANDARD_INCLUDE.findall(text)) for name, text in texts.items()}
        self.code = {name: DIRECTIVE.sub("", COMMENT_OR_TEXT.sub(" ", text)) for name, text in texts.items()}
        self.owners = {}
        for name, code in self.code.items():
            for groups in DEFINED.findall(code):
                self.owners.setdefault(next(group for group in groups if group), set()).add(name)

    def seen_from(self, name):
        seen, waiting = set(), [name]
        while waiting:
            one = waiting.pop()
            if one not in seen:
                seen.add(one)
                waiting += self.includes.get(one, ())
        return seen

    def missing(self, name):
        """What the header uses and nothing that it includes declares."""
        code, seen = self.code[name], self.seen_from(name)
        standard = set().union(*(self.standard.get(one, set()) for one in seen))
        used = set(re.findall(r"(?<![.>:\w])(?:ripplenotch::)?(\w+)\b", code)) - set(OWN.findall(code))
        wanted = {word for word in used if word in self.owners and not self.owners[word] & seen}
        # A member or a parameter may have the name of a constant elsewhere; types begin with a capital letter.
        wanted = {word for word in wanted if word[0].isupper()}
        for word in set(re.findall(r"\bstd::(\w+)", code)):
            if word in STANDARD and not STANDARD[word] & standard:
                wanted.add("std::" + word)
        return wanted


class StandAlone(unittest.TestCase):
    def test_each_public_header_includes_what_declares_its_names(self):
        headers = Headers({str(path.relative_to(INCLUDE)): path.read_text() for path in sorted(INCLUDE.rglob("*.hpp"))})
        self.assertGreater(len(headers.code), 100)
        self.assertGreater(len(headers.owners), 300)
        for name in headers.code:
            with self.subTest(header=name):
                self.assertEqual(headers.missing(name), set())

    def test_an_include_that_was_left_out_is_seen(self):
        texts = {"ripplenotch/a.hpp": "struct First {\n};\nusing Second = int;\n",
                 "ripplenotch/b.hpp": '#include "ripplenotch/a.hpp"\nstruct Third { First first; };\n',
                 "ripplenotch/c.hpp": "struct First;\nvoid of(const First&, Second, Third, std::vector<int>);  // Fourth\n",
                 "ripplenotch/d.hpp": '#include <vector>\n#include "ripplenotch/b.hpp"\nSecond of(Third, std::vector<int>);\n'}
        headers = Headers(texts)
        self.assertEqual(headers.missing("ripplenotch/c.hpp"), {"Second", "Third", "std::vector"})
        self.assertEqual(headers.missing("ripplenotch/d.hpp"), set())


if __name__ == "__main__":
    unittest.main()
