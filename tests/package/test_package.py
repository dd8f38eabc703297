# SPDX-License-Identifier: MIT
"""What Debian's packages hold, and what lintian says of them: scripts/debian packs the build around this test, which takes
seconds. scripts/package compiles what is shipped, and runs lintian on it."""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from commands import SOURCE

BUILD = pathlib.Path(os.environ["RIPPLENOTCH_BUILD"])
DEBIAN = SOURCE / "scripts" / "debian"
PROJECT_VERSION = re.search(r"project\(ripplenotch VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
# Of the build around this test alone, which is linked without shared libraries and has no folder for each architecture.
NOT_SHIPPED = "embedded-library,shared-library-lacks-prerequisites,statically-linked-binary,pkg-config-unavailable-for-cross-compilation"


def needed(tool, package):
    return unittest.skipIf(shutil.which(tool) is None, f"there is no {tool}: apt-get install {package}")


def pack(folder, **environment):
    """The packages of the build, in the folder, by their names."""
    source = pathlib.Path(folder, "source")
    shutil.copytree(DEBIAN, source / "debian")
    shutil.copy(SOURCE / "CHANGELOG.md", source)
    (source / "debian" / "debhelper-build-stamp").write_text("ripplenotch\nripplenotch-dev\n")  # debhelper's note of what is built
    done = subprocess.run(["debian/rules", "binary", f"BUILD={BUILD}"], cwd=source, capture_output=True, text=True,
                          env=dict(os.environ, LC_ALL="C.UTF-8", **environment))
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return {path.name.split("_")[0]: path for path in pathlib.Path(folder).glob("*.deb")}


def files(package):
    listed = subprocess.run(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE, check=True).stdout
    names = subprocess.run(["tar", "-tf", "-"], input=listed, stdout=subprocess.PIPE, check=True).stdout.decode().splitlines()
    return {name.removeprefix("./") for name in names if not name.endswith("/")}


def of_tree(top, pattern, target):
    return {f"{target}/{path.relative_to(SOURCE / top)}" for path in (SOURCE / top).rglob(pattern) if path.is_file()}


@needed("dh", "debhelper")
class Contents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.packages = pack(cls.folder.name, DPKG_DEB_COMPRESSOR_TYPE="none", DEB_BUILD_OPTIONS="nostrip")

    def test_the_program_comes_with_its_pages_and_completions_and_nothing_else(self):
        commands = re.findall(r"^COMMAND\(([a-z]+)_?\)", (SOURCE / "src/cli/commands.def").read_text(), re.M)
        self.assertGreater(len(commands), 10)
        pages = {f"usr/share/man/man1/{name}.1.gz" for name in ["ripplenotch", *(f"ripplenotch-{name}" for name in commands)]}
        own = {f"usr/share/doc/ripplenotch/{name}" for name in ("README.md", "copyright", "changelog.gz", "changelog.Debian.gz")}
        completions = {"usr/share/bash-completion/completions/ripplenotch"}
        expected = (pages | own | completions | of_tree("docs", "*", "usr/share/doc/ripplenotch/docs")
                    | {"usr/bin/ripplenotch", "usr/share/lintian/overrides/ripplenotch"})
        # Where npm had plotly.js.
        self.assertEqual({name for name in files(self.packages["ripplenotch"]) if not name.startswith("usr/share/ripplenotch/")}, expected)

    def test_the_library_comes_with_its_headers_and_how_it_is_found(self):
        found = {re.sub(r"usr/lib/([^/]+-linux-gnu/)?", "usr/lib/", name) for name in files(self.packages["ripplenotch-dev"])}
        cmake = {name for name in found if name.startswith("usr/lib/cmake/ripplenotch/")}
        self.assertLessEqual({f"usr/lib/cmake/ripplenotch/ripplenotch-{name}.cmake" for name in ("config", "config-version", "targets")}, cmake)
        own = {f"usr/share/doc/ripplenotch-dev/{name}" for name in ("copyright", "changelog.gz", "changelog.Debian.gz")}
        headers = of_tree("include", "*.hpp", "usr/include") | of_tree("include", "*.def", "usr/include")
        self.assertEqual(found - cmake, own | headers | {"usr/lib/libripplenotch.a", "usr/lib/pkgconfig/ripplenotch.pc",
                                                         "usr/share/lintian/overrides/ripplenotch-dev"})

    def test_the_library_asks_for_the_fmt_that_it_was_compiled_with(self):
        depends = subprocess.run(["dpkg-deb", "-f", self.packages["ripplenotch-dev"], "Depends"], stdout=subprocess.PIPE, check=True).stdout.decode()
        least, below = re.search(r"libfmt-dev \(>= (\d+)\), libfmt-dev \(<< (\d+)~\)", depends).groups()
        self.assertEqual(int(below), int(least) + 1)


@needed("dh", "debhelper")
@needed("lintian", "lintian")
class Lintian(unittest.TestCase):
    def test_it_has_no_error_and_no_warning(self):
        with tempfile.TemporaryDirectory() as folder:
            # The library's objects take three times as long as the program.
            packages = pack(folder, DPKG_DEB_COMPRESSOR_TYPE="gzip", DPKG_DEB_COMPRESSOR_LEVEL="1")
            done = subprocess.run(["lintian", "--allow-root", "--fail-on", "error,warning", "--suppress-tags", NOT_SHIPPED,
                                   *packages.values()], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)


class Agreement(unittest.TestCase):
    def test_packages_to_build_with_are_those_that_the_setup_installs(self):
        listed = set(re.findall(r"^build (\S+)", (SOURCE / "scripts/packages.txt").read_text(), re.M)) - {"g++"}  # build-essential
        control = (DEBIAN / "control").read_text()
        fields = {name: set(re.findall(r"^ *([a-z][a-z0-9+.-]+)(?: \([^)]*\))?,?$", text, re.M)) for name, text in
                  re.findall(r"^(Build-Depends|Depends):((?:[^\n]*\n)(?: [^\n]*\n)*)", control, re.M)}
        self.assertEqual(fields["Build-Depends"] - {"debhelper-compat"}, listed)
        # Who links the archive needs the libraries that are in no header of ours, too; fmt with its version.
        tools = {"cmake", "ninja-build", "pkg-config", "libcli11-dev", "libfmt-dev"}
        self.assertEqual(fields["Depends"], listed - tools)

    def test_versions_are_those_of_the_project(self):
        self.assertEqual(re.match(r"ripplenotch \((.+)-\d+\)", (DEBIAN / "changelog").read_text())[1], PROJECT_VERSION)
        self.assertEqual(re.search(r"^version: (.+)$", (SOURCE / "CITATION.cff").read_text(), re.M)[1], PROJECT_VERSION)
