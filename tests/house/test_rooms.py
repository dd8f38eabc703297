# SPDX-License-Identifier: MIT
"""Who may include whom, floor by floor; where third-party headers live; what must not stand in the repository."""

import functools
import os
import pathlib
import re
import shutil
import subprocess
import unittest

SOURCE = pathlib.Path(os.environ["RIPPLENOTCH_SOURCE"])

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
    "cli": {"core", "log", "analysis", "survey", "design", "filter", "evaluate", "model", "export", "diagnose", "figure", "chart",
            "document", "page", "arm", "fleet"},
}

# Third-party header -> the files that may include it.
DOORS = {
    r"fftw3": {"src/analysis/spectrum/fourier.cpp"},
    r"nlohmann/": {"src/document/json/json.hpp", "src/log/messages/json_message.cpp"},
    r"CLI/": {"src/cli/options/options_implementation.hpp"},
    r"fast_float/": {"src/core/text/number.cpp"},
    r"nettle/": {"src/core/files/sha256.cpp"},
    r"(\w+mm|x86)intrin": {"src/core/vectors/bytes_avx2.hpp"},
    r"arm_neon": {"src/core/vectors/bytes_neon.hpp"},
    r"pugixml": {"src/arm/readers/xml_tree.cpp"},
    r"zlib\.h": {"src/log/unpack/gzip_unpacker.cpp"},
    r"zstd\.h": {"src/log/unpack/zstd_unpacker.cpp"},
    r"lz4": {"src/log/unpack/lz4_unpacker.cpp"},
    r"lzma\.h": {"src/log/unpack/xz_unpacker.cpp"},
    r"hdf5\.h": {"src/log/containers/hdf5_handles.hpp"},
    r"sqlite3": {"src/log/messages/rosbag2_messages.cpp"},
    r"Eigen/Sparse": {"src/analysis/track/envelope_solver.cpp"},
    r"Eigen/(?!Sparse)": {"src/core/matrices/linear_algebra.hpp"},
}

# A header in src is its room's own. These go through a wall: header -> the rooms that may include it, and why.
PRIVATE_DOORS = {
    "core/": (set(SEES), "what lies in core is for every room of the library; what is public there is for its users too"),
    "log/opening.hpp": ({"filter"}, "a stream judges the same first rows as a log that is read whole"),
    "log/account/account.hpp": ({"filter"}, "a stream goes through the same account as a log that is read whole"),
    "model/carriers.hpp": ({"diagnose"}, "trials along one motion share what is the same in all of them"),
    "model/fit/fit_coordinates.hpp": ({"diagnose"}, "effects that are tried are screened in the coordinates of the fit"),
    "model/motion/local_motion.hpp": ({"diagnose", "fleet"}, "the noise of a torque is told as that of a velocity is, and so is that of what a descriptor rests on"),
    "model/fit/weighing.hpp": ({"diagnose"}, "effects that are tried are screened by the weights of the fit"),
    "document/fields/diagnosis_fields.hpp": ({"page"}, "values and places of a finding stand on the page as in the document"),
    "document/fields/document_head.hpp": ({"page"}, "the page takes any document, by the head that all have"),
    "document/json/json.hpp": ({"page"}, "the page shows JSON as tables; the library behind it has one door"),
    "figure/gnuplot_script.hpp": ({"page"}, "a map has the same colours on the page as in a picture"),
    "figure/picture_layout.hpp": ({"page"}, "names find their places on the page as they do in a picture"),
}


# Rooms whose folders stand in an order: what a folder includes never comes back to it.
ORDERED = ("arm", "diagnose", "document")


def folders_seen(room):
    """Folders of a room, each with those that it includes from."""
    seen = {}
    for path, of, includes in sources():
        folder = path.parent.relative_to(SOURCE)
        if of != room or folder.parts[0] != "src":
            continue
        headers = [SOURCE / "src" / include for include in includes if include.split("/")[0] == room]
        seen.setdefault(folder, set()).update(one.parent.relative_to(SOURCE) for one in headers if one.exists())
    return {folder: below - {folder} for folder, below in seen.items()}


def circle_in(seen):
    """Folders that are left when those that see none of the others are taken away, again and again."""
    left = dict(seen)
    while free := [folder for folder, below in left.items() if not below & set(left)]:
        for folder in free:
            del left[folder]
    return set(left)


def private_door(header, room):
    return any(header.startswith(door) and room in rooms for door, (rooms, _) in PRIVATE_DOORS.items())


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


def types_defined_in(text):
    """Types at the level of a namespace, with its name; those of an unnamed namespace are their file's own."""
    spaces = []
    for line in text.split("\n"):
        if opened := re.match(r"(?:inline )?namespace\b([^={]*)\{", line):
            spaces.append(opened[1].strip())
        elif re.match(r"\}  // namespace", line):
            spaces.pop()
        elif "" not in spaces:
            found = re.match(r"(?:template <.*> )?(?:struct|class|enum class|enum) ([\w:]+)[^;()]*$", line)
            if found:
                yield "::".join([*spaces, found[1]])


def names_unnamed_in(text):
    """Types, functions and values that a file defines at the level of its unnamed namespaces."""
    names, inside = set(), False
    for line in text.split("\n"):
        if line == "namespace {":
            inside = True
        elif line.startswith("}  // namespace"):
            inside = False
        elif not inside or not line[:1].isalpha() or line.startswith(("template <template", "namespace")):
            continue
        elif found := re.match(r"(?:struct|class|union|enum(?: class)?) (\w+)|using (\w+) =", line):
            names.add(found[1] or found[2])
        elif line.startswith("using"):
            continue
        elif found := re.match(r"(?:inline |static )*(?:constexpr|const|double|bool|int)\b[^({]*?[ &*](\w+)(?:\[[^]]*\])?(?: =|\{|;)", line):
            names.update([found[1], *re.findall(r", (\w+) = ", line)])
        elif found := re.match(r"[\w:<>,&*\[\] ]+?[ &*](\w+)\(", line):
            names.add(found[1])
    return names


def names_declared_in(text):
    """Types, functions and values that a header declares at the level of a namespace."""
    for line in text.split("\n"):
        line = re.sub(r"^(?:\[\[nodiscard\]\] |inline |constexpr |extern |template <.*?> |const )*", "", line)
        if line.startswith(("template", "namespace", "using namespace")):
            continue
        if found := re.match(r"(?:struct|class|enum(?: class)?) (\w+)|using (\w+) =|[\w:][\w:<>,&*\[\] ]*?[ &*](\w+)\(|[\w:<>]+ (\w+)(?:\[\w*\])? ?[={;]", line):
            yield next(filter(None, found.groups()))


class Together(unittest.TestCase):
    """Files of a room are compiled together (docs/decisions/0023-compiling-together.md)."""

    def setUp(self):
        lists = (SOURCE / "src/CMakeLists.txt").read_text()
        alone = re.findall(r'"(\^[^"]*)"', re.search(r"^set\(alone ([^#]*?)\)\n", lists, re.M)[1])
        self.assertGreater(len(alone), 1)
        self.found = {}
        for path in sorted((SOURCE / "src").rglob("*.cpp")):
            name = str(path.relative_to(SOURCE / "src"))
            if not any(re.match(place, name) for place in alone):
                for one in names_unnamed_in(path.read_text()):
                    self.found.setdefault((name.split("/")[0], one), []).append(name)
        self.assertGreater(len(self.found), 1500)

    def test_no_two_of_them_have_one_name_for_two_things(self):
        # The compiler sees most of these; of functions that differ in what they take it would choose one.
        self.assertEqual({name: files for name, files in self.found.items() if len(files) > 1}, {})

    def test_none_hides_from_its_neighbours_what_a_header_that_they_may_include_declares(self):
        declared = 0
        for path, of, _ in sources():
            if path.suffix != ".hpp":
                continue
            private = path.is_relative_to(SOURCE / "src")
            header = str(path.relative_to(SOURCE / "src")) if private else ""
            for name in names_declared_in(path.read_text()):
                declared += 1
                for room in SEES:
                    sees = of == room or of in SEES[room] and (not private or private_door(header, room))
                    if sees and (room, name) in self.found:
                        self.fail(f"{self.found[room, name][0]} hides {name} of {path.relative_to(SOURCE)}")
        self.assertGreater(declared, 1500)

    def test_a_name_is_seen_whatever_it_names(self):
        text = "\nnamespace {\n\nstruct A {\n    int no;\n};\nusing B = A;\nconstexpr double c = 1.0, d = 2.0;\n" \
               "constexpr int e[] = {1};\nstd::vector<A> f(int no) {\n}\n\n}  // namespace\n\nvoid no() {\n}\n"
        self.assertEqual(names_unnamed_in(text), set("ABcdef"))


class Rooms(unittest.TestCase):
    def test_no_two_types_have_one_name(self):
        files = {}
        for path, _, _ in sources():
            for name in types_defined_in(path.read_text()):
                files.setdefault(name, set()).add(str(path.relative_to(SOURCE)))
        self.assertGreater(len(files), 300)
        self.assertEqual({name: where for name, where in files.items() if len(where) > 1}, {})

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

    def test_folders_of_a_room_do_not_see_each_other_in_a_circle(self):
        for room in ORDERED:
            with self.subTest(room=room):
                seen = folders_seen(room)
                self.assertGreater(len(seen), 2)
                self.assertGreater(sum(map(len, seen.values())), 2)
                self.assertEqual(circle_in(seen), set())
        self.assertEqual(circle_in({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set()}), {"a", "b", "c"})

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

    def test_a_private_header_is_seen_by_another_room_only_where_a_reason_is_listed(self):
        used = set()
        for path, room, includes in sources():
            for include in includes:
                if include.split("/")[0] in SEES and include.split("/")[0] != room:
                    self.assertTrue(private_door(include, room),
                                    f"{path.relative_to(SOURCE)} includes {include}, which is private to its room: "
                                    "list it in PRIVATE_DOORS with a reason, or make it public")
                    used.update(door for door in PRIVATE_DOORS if include.startswith(door))
        self.assertEqual(used, set(PRIVATE_DOORS), "a door that nobody uses")

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

    def test_tests_leave_linear_algebra_to_the_library(self):
        # What a test makes of its templates, without an optimiser, the linker takes in place of the library's own.
        for path in (SOURCE / "tests").rglob("*.[ch]pp"):
            self.assertNotRegex(path.read_text(), r"#include [<\"](Eigen/|core/linear_algebra)", str(path))

    def test_no_name_of_a_test_holds_what_cmake_takes_for_the_end_of_an_entry(self):
        # CMake cut such a name in two with Catch2 v2, and neither part was the name of a test: nothing ran.
        for path in (SOURCE / "tests").rglob("*.cpp"):
            for name in re.findall(r'TEST_CASE\(\s*((?:"[^"]*"\s*)+)', path.read_text()):
                self.assertNotRegex(name, r"[;\[\]\\$]", f"{path.relative_to(SOURCE)}: {name}")

    def test_public_headers_show_no_linear_algebra_library(self):
        for path, _, includes in sources():
            if "include/ripplenotch" in str(path):
                self.assertNotIn("core/matrices/linear_algebra.hpp", includes, str(path))

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
        self.assertGreater(len(files), 600)
        done = subprocess.run(["clang-format", "--dry-run", "-Werror", *files], cwd=SOURCE, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
