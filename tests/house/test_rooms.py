# SPDX-License-Identifier: MIT
"""Which room may include which, where third-party headers are included, formatting, and what must not be in the repository."""

import collections
import functools
import os
import re
import shutil
import subprocess
import sys
import unittest

from commands import SOURCE


# A room sees only the rooms named here, and itself. docs/decisions/0001-rooms.md says why.
SEES = {
    "core": set(),
    "log": {"core"},
    "analysis": {"core"},
    "design": {"core"},
    "model": {"core"},
    "arm": {"core", "model"},
    "survey": {"core", "log", "analysis"},
    "filter": {"core", "log", "analysis", "design"},
    "evaluate": {"core", "filter", "analysis", "design"},
    "export": {"core", "design", "model"},
    "diagnose": {"core", "model", "analysis"},
    "fleet": {"core", "analysis", "model"},
    "figure": {"core"},
    "chart": {"core", "log", "analysis", "design", "filter", "evaluate", "model", "diagnose", "fleet", "figure"},
    "document": {"core", "figure", "log", "analysis", "survey", "design", "filter", "evaluate", "model", "export", "diagnose", "arm", "fleet"},
    "page": {"core", "diagnose", "figure", "chart", "document"},
    "verdict": {"core", "log", "analysis", "design", "filter", "evaluate", "model", "diagnose", "arm", "document"},
    "cli": {"core", "log", "analysis", "survey", "design", "filter", "evaluate", "model", "export", "diagnose", "figure", "chart",
            "document", "page", "verdict", "arm", "fleet"},
    "python": {"core", "log", "cli"},
}

# Third-party header -> the files that may include it.
DOORS = {
    r"fftw3": {"src/analysis/spectrum/fourier.cpp"},
    r"nlohmann/": {"src/document/json/json.hpp", "src/log/formats/json.cpp"},
    r"CLI/": {"src/cli/options/options_implementation.hpp"},
    r"fast_float/": {"src/core/text/number.cpp"},
    r"nettle/": {"src/core/files/sha256.cpp"},
    r"(\w+mm|x86)intrin": {"src/core/vectors/bytes_avx2.hpp"},
    r"arm_neon": {"src/core/vectors/bytes_neon.hpp"},
    r"pugixml": {"src/arm/readers/xml_tree.cpp"},
    r"zlib\.h": {"src/log/unpack/unpackers.cpp"},
    r"zstd\.h": {"src/log/unpack/unpackers.cpp"},
    r"lz4": {"src/log/unpack/unpackers.cpp"},
    r"hdf5\.h": {"src/log/formats/hdf5.cpp"},
    r"sqlite3": {"src/log/formats/rosbag2.cpp"},
    r"pybind11": {"src/python/module.cpp"},
    r"Eigen/": {"src/core/matrices/linear_algebra.hpp"},
}

@functools.cache
def sources():
    """(path, room, what it includes) of each source; read once for all tests."""
    return list(read_sources())


def read_sources():
    for top in ("include/ripplenotch", "src"):
        for path in sorted((SOURCE / top).rglob("*")):
            if path.suffix in (".hpp", ".cpp"):
                room = path.relative_to(SOURCE / top).parts[0]
                yield path, room, re.findall(r'^\s*#include\s+[<"]([^>"]+)[>"]', path.read_text(), re.M)


class Rooms(unittest.TestCase):
    def test_a_room_sees_only_the_rooms_it_may(self):
        looked_at = 0
        for path, room, includes in sources():
            for include in includes:
                target = re.match(r"(?:ripplenotch/)?([a-z]+)/", include)
                if target and target[1] in SEES and include.endswith((".hpp", ".def")):
                    looked_at += 1
                    self.assertTrue(target[1] == room or target[1] in SEES[room],
                                    f"{path.relative_to(SOURCE)} in {room} includes {include}")
        self.assertGreater(looked_at, 50)

    def test_the_decision_tells_every_room_and_names_files_that_there_are(self):
        page = (SOURCE / "docs/decisions/0001-rooms.md").read_text()
        self.assertEqual(re.findall(r"^\| `([a-z]+)` \|", page, re.M), list(SEES))
        floors = {room: int(floor) for floor, rooms in re.findall(r"^ (\d)   ((?:[a-z]+ {1,3})+)  ", page, re.M)
                  for room in rooms.split()}
        self.assertEqual(set(floors), set(SEES))
        for room, seen in SEES.items():
            for below in seen:
                self.assertLess(floors[below], floors[room], f"{room} sees {below}")
        named = re.findall(r"`((?:src|include)/[\w/.]+)`", page)
        self.assertGreater(len(named), 15)
        self.assertEqual([name for name in named if not (SOURCE / name).exists()], [])

    def test_names_without_linkage_differ_within_a_room_since_the_release_preset_compiles_files_together(self):
        apart = re.search(r'EXCLUDE REGEX "(.+)"', (SOURCE / "src/CMakeLists.txt").read_text())[1]
        places = collections.defaultdict(set)
        for path, room, _ in sources():
            if path.suffix == ".cpp" and not re.search(apart, str(path)):
                for scope in re.findall(r"^namespace \{$(.*?)^\}  // namespace", path.read_text(), re.M | re.S):
                    types = re.findall(r"^(?:struct|class|enum class) (\w+)", scope, re.M)
                    for name in types + re.findall(r"^(?:constexpr|const) [^\n(={;]*?(\w+)\s*[={;]", scope, re.M):
                        places[room, name].add(str(path.relative_to(SOURCE)))
        self.assertGreater(len(places), 300)
        self.assertEqual({name: sorted(files) for (_, name), files in places.items() if len(files) > 1}, {})

    def test_third_party_headers_have_one_door_each(self):
        for path, _, includes in sources():
            name = str(path.relative_to(SOURCE))
            for include in includes:
                for pattern, doors in DOORS.items():
                    if re.match(pattern, include):
                        self.assertIn(name, doors, f"{name} includes {include}")

    def test_tests_take_catch2_from_the_header_that_knows_both_versions(self):
        doors = {SOURCE / "tests" / "support" / name for name in ("catch.hpp", "main.cpp")}
        using = {path for path in (SOURCE / "tests").rglob("*.[ch]pp") if "<catch2/" in path.read_text()}
        self.assertEqual(using, doors)

    def test_functions_that_libraries_choose_by_processor_are_our_own(self):
        open_functions = "a?cos|a?sin|a?tan|atan2|tanh|exp|exp2|expm1|log|log10|log2|log1p|pow|cbrt|hypot|polar|arg|lgamma|tgamma"
        for path, _, _ in sources():
            text = path.read_text()
            if found := re.search(rf"std::({open_functions})\(", text):
                number = text.count("\n", 0, found.start()) + 1
                self.fail(f"{path.relative_to(SOURCE)}:{number} uses {found[0]}...); take it from core/portable_math.hpp")

    def test_processors_are_told_apart_in_one_folder(self):
        told_apart = r"\b_mm\d*_|\b__m(128|256|512)|\btarget(_clones)?\(\"|__builtin_(ia32|cpu|neon)|__(SSE|AVX|ARM_NEON|x86_64|aarch64)|\bvector_size\("
        for path, _, _ in sources():
            if "core/vectors/" not in path.as_posix():
                found = re.search(told_apart, path.read_text())
                self.assertIsNone(found, f"{path.relative_to(SOURCE)} has {found and found[0]}; kernels are written once, over src/core/vectors")

    def test_every_source_file_names_its_licence(self):
        for path, _, _ in sources():
            self.assertIn("SPDX-License-Identifier: MIT", path.read_text().split("\n", 1)[0], str(path))


class Repository(unittest.TestCase):
    def test_no_absolute_path_of_a_machine_and_no_finished_binary_is_kept(self):
        listed = subprocess.run(["git", "ls-files"], cwd=SOURCE, capture_output=True, text=True)
        if listed.returncode != 0:
            self.skipTest("not a git checkout")
        for name in listed.stdout.split("\n"):
            path = SOURCE / name
            if not name or not path.is_file():
                continue
            self.assertLess(path.stat().st_size, 1_500_000, f"{name} is large for a source repository")
            text = path.read_bytes()
            for forbidden in (b"/ho" b"me/", b"/ro" b"ot/", b"/wo" b"rk/"):
                self.assertNotIn(forbidden, text, f"{name} holds an absolute path")


def clang_format_14():
    done = subprocess.run(["clang-format", "--version"], capture_output=True, text=True) if shutil.which("clang-format") else None
    return done is not None and " version 14." in done.stdout


@unittest.skipUnless(clang_format_14(), "no clang-format 14 here; other versions break lines elsewhere")
class Format(unittest.TestCase):
    def test_every_file_is_as_clang_format_leaves_it(self):
        files = [str(path) for top in ("include", "src", "tests", "cmake") for path in sorted((SOURCE / top).rglob("*.[ch]pp"))]
        self.assertGreater(len(files), 400)
        done = subprocess.run(["clang-format", "--dry-run", "-Werror", *files], cwd=SOURCE, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


class ByHand(unittest.TestCase):
    def test_a_file_of_tests_is_found_without_what_ctest_says_in_the_environment(self):
        bare = {name: value for name, value in os.environ.items() if not name.startswith("RIPPLENOTCH")}
        for path in sorted((SOURCE / "tests").glob("*/test_*.py")):
            done = subprocess.run([sys.executable, "-B", SOURCE / "tests/support/cases.py", "run", path, "no_such_test"], capture_output=True,
                                  text=True, env=bare)
            self.assertRegex(done.stdout + done.stderr, r"(?im)has no attribute 'no_such_test'|^skipped", path.name)
