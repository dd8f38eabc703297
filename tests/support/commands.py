# SPDX-License-Identifier: MIT
"""What the tests of commands share: the tool as it was built, a run of it, a folder that goes with its test, and one table
of the commands."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

# A test that is started by hand (cases.py run tests/cli/test_map.py) takes what was built last.
SOURCE = pathlib.Path(os.environ.get("RIPPLENOTCH_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
BUILT = sorted(SOURCE.glob("build/*/ripplenotch"), key=lambda path: path.stat().st_mtime)
TOOL = os.environ.get("RIPPLENOTCH", str(BUILT[-1]) if BUILT else "ripplenotch")
for name, value in (("BUILD", str(pathlib.Path(TOOL).parent)), ("MODULE", str(SOURCE / "build/python/python")), ("LACKS", ""), ("CXX", "c++")):
    os.environ.setdefault(f"RIPPLENOTCH_{name}", value)
DATA = SOURCE / "data"
LOGS = pathlib.Path(os.environ.get("RIPPLENOTCH_LOGS", SOURCE.parent / "shared/logs"))  # real logs, which few have
SHORT = os.environ.get("RIPPLENOTCH_SHORT") == "1"  # what takes long is left to scripts/nightly
# Exported C is compiled as strictly as firmware compiles it, where there is a compiler.
COMPILER = shutil.which(os.environ.get("CC", "cc"))
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wdouble-promotion", "-Wconversion", "-Wshadow")
SELF_TEST = """
#define RIPPLENOTCH_SELF_TEST
#include "notch.h"
#include <stdio.h>
int main(void)
{
    const double error = (double)ripplenotch_self_test();
    printf("%.17g\\n", error);
    return !(error <= (double)RIPPLENOTCH_GOLDEN_TOLERANCE_NM);
}
"""
FILTER = """
#include "notch.h"
#include <stdio.h>
int main(void)
{
    double speed, torque;
    ripplenotch_state state;
    ripplenotch_init(&state);
    while (scanf("%lf %lf", &speed, &torque) == 2) {
        printf("%.17g\\n", (double)ripplenotch_step(&state, (ripplenotch_real)torque, (ripplenotch_real)speed));
    }
    return 0;
}
"""
sys.path.insert(0, str(SOURCE / "scripts"))
sys.dont_write_bytecode = True

GEAR = ("--gear-ratio", "100", "--orders", "1,2")
# Every command, and every kind of answer of `spectrum`, each as the shortest call that gives a result; the laws go through
# them. What has {gear} takes any gear, what has {log} reads a log.
COMMANDS = {
    "info": "info {log}",
    "filter": "filter {log} --method tracking {gear}",
    "compare": "compare {log} --method lowpass,cutoff=5Hz,order=1 {gear}",
    "spectrum": "spectrum {log}",
    "spectrum --segment": "spectrum {log} --segment 0.5s",
    "spectrum --domain order": "spectrum {log} --domain order",
    "spectrum --map campbell": "spectrum {log} --map campbell {gear}",
    "spectrum --map order": "spectrum {log} --map order {gear}",
    "spectrum --track": "spectrum {log} --track {gear}",
    "identify": "identify {log}",
    "map": "map {log} {gear}",
    "recommend": "recommend {log} {gear}",
    "features": "features {log} {gear}",
    "simulate": "simulate {log} --model {data}/paper_model.json",
    "diagnose": "diagnose {log} --model {data}/paper_model.json",
    "design": "design {gear} --sample-rate 1kHz --speed 18:90:18",
    "export": "export --method lowpass,cutoff=13Hz,order=1 --sample-rate 1kHz --to c-header",
    "diagnose --effects": "diagnose --effects",
    "trend": "trend {data}/fleet.ndjson",
    "report": "report result.json",
}
OF_A_LOG = [name for name, words in COMMANDS.items() if "{log}" in words]
TAKES_A_GEAR = [name for name, words in COMMANDS.items() if "{gear}" in words]
# Those whose JSON holds the account of the recording.
ACCOUNTS = [name for name in OF_A_LOG if name != "features"]
WRITES_A_LOG = ("filter", "simulate")


def asked(name, log=DATA / "paper_move_2s.csv", gear=GEAR):
    """The words of a command of the table."""
    words = []
    for word in COMMANDS[name].split():
        words += gear if word == "{gear}" else [log if word == "{log}" else word.format(data=DATA)]
    return words


def asked_for_json(name, log, out="out.csv"):
    """The same for its result as JSON; a log that it writes beside is `out`."""
    return [*asked(name, log), *(["-o", str(out), "--force"] if name in WRITES_A_LOG else []), "--json"]


def run(*words, stdin=None, environment=None, text=True, timeout=300, **more):
    """The tool with these words as it ended. stdin: text, bytes or an open file; nothing by default. environment: beside
    that of the test. text=False gives its output as bytes."""
    if isinstance(stdin, (str, bytes)):
        more["input"] = stdin
    else:
        more["stdin"] = stdin or subprocess.DEVNULL
    if environment:
        more["env"] = {**os.environ, **environment}
    command = [TOOL, *(word if isinstance(word, bytes) else str(word) for word in words)]
    return subprocess.run(command, capture_output=True, text=text, timeout=timeout, **more)


def good(*words, **more):
    """The same where it has to succeed."""
    done = run(*words, **more)
    if done.returncode != 0:
        raise AssertionError(f"{words}: {done.stderr}")
    return done


def ended(code, done, *said):
    """The same run, which has to have ended with this code and to have said each of these words on standard error."""
    missing = [words for words in said if words not in done.stderr]
    if done.returncode != code or missing:
        raise AssertionError(f"{done.args}: exit code {done.returncode}, expected {code} and {missing}: {done.stderr}")
    return done


def new_folder(test):
    """A folder that goes when the test has ended, or with the last test of a class that is given."""
    folder = tempfile.TemporaryDirectory()
    (test.addClassCleanup if isinstance(test, type) else test.addCleanup)(folder.cleanup)
    return pathlib.Path(folder.name)


def sanitized(program):
    """Whether a program was built with a sanitizer, which takes memory, address space and time of its own."""
    # In pieces: what this process holds counts as its children's, too. A name across two pieces is met again in the
    # program's symbols.
    with open(program, "rb") as file:
        return any(b"__asan_init" in piece or b"__tsan_init" in piece for piece in iter(lambda: file.read(1 << 20), b""))


class Case(unittest.TestCase):
    """Tests that run the tool in a folder of their own. bytes_out: what it says is kept as bytes."""

    bytes_out = False

    def setUp(self):
        self.folder = new_folder(self)

    def here(self, more):
        return {"cwd": self.folder, "text": not self.bytes_out, **more}

    def run_tool(self, *words, **more):
        return run(*words, **self.here(more))

    def good(self, *words, **more):
        return good(*words, **self.here(more))

    def compiled(self, source, *flags, stdin=None):
        """What a C program with the header notch.h prints, compiled without a warning."""
        (self.folder / "main.c").write_text(source)
        subprocess.run([COMPILER, *STRICT, *flags, "main.c", "-o", "main", "-lm"], cwd=self.folder, check=True, timeout=60)
        return subprocess.run(["./main"], cwd=self.folder, input=stdin, check=True, capture_output=True, text=True, timeout=60).stdout


class SharedCase(Case):
    """The same in one folder for all tests of a class."""

    @classmethod
    def setUpClass(cls):
        cls.folder = new_folder(cls)

    def setUp(self):
        pass
