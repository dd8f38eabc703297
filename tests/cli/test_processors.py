# SPDX-License-Identifier: MIT
"""The same bytes on other processors: docs/decisions/0004-same-bytes.md.

glibc chooses its functions by the processor's instruction sets, and lets itself be told that there are fewer. An emulator,
where one is installed, hides them from FFTW and from the tool's own kernels too."""

import os
import shutil
import subprocess
import unittest

from commands import DATA, TOOL, SharedCase, run

FEWER = "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-AVX,-BMI2"
EMULATOR = next(filter(None, map(shutil.which, ("qemu-x86_64-static", "qemu-x86_64"))), None)
OLD_PROCESSOR = "Nehalem"  # of 2008, without AVX

GEAR = ("--gear-ratio", "100", "--orders", "1,2")
STEADY = tuple(str(DATA / f"paper_{speed}deg_s.csv") for speed in (60, 120))
MOVE = str(DATA / "paper_move_2s.csv")
MADE = ("simulate", "--gear-ratio", "100", "--inertia", "0.4", "--ripple", "1:0.7Nm:30deg", "--effect",
        "coulomb-friction,torque_nm=0.5,width_deg_s=0.2", "--motion", "poly6,to=120deg,duration=2s", "--motion",
        "poly6,to=-60deg,duration=3s", "--sample-rate", "1kHz", "--noise", "0.05Nm", "--seed", "7")
MODEL = ('{"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [{"effect": "inertia"}, '
         '{"effect": "ripple", "order": 1}]}')

COMMANDS = {
    "simulate": MADE,
    "identify": ("identify", *STEADY, "--json"),
    "identify a move": ("identify", "made.csv", "--json"),
    "spectrum": ("spectrum", "made.csv", "--bins"),
    "spectrum over orders": ("spectrum", "made.csv", "--domain", "order", "--json"),
    "track": ("spectrum", MOVE, "--track", *GEAR),
    "design": ("design", *GEAR, "--sample-rate", "1kHz", "--speed", "18:180:18", "--json"),
    "compare": ("compare", MOVE, *GEAR, "--method", "tracking", "--method", "oscillator", "--json"),
    "recommend": ("recommend", "made.csv", *GEAR, "--json"),
    "a method as code": ("export", "--method", "oscillator,gear-ratio=100,orders=1:2", "--sample-rate", "1kHz", "--to", "c-header,precision=double"),
    "fixed": ("filter", MOVE, "--method", "fixed,centers=25Hz:50Hz"),
    "tracking": ("filter", MOVE, *GEAR, "--method", "tracking"),
    "oscillator": ("filter", MOVE, *GEAR, "--method", "oscillator"),
    "info": ("info", "made.csv", "--json"),
    "spectrum in pieces": ("spectrum", "made.csv", "--segment", "1s", "--json"),
    "filter by a table": ("filter", MOVE, "--method", "switching,table=table.json"),
    "low-pass": ("filter", MOVE, "--method", "lowpass,cutoff=13rad/s,order=4", "--decimals", "6"),
    "export": ("export", "table.json", "--to", "c-header"),
    "map": ("map", MOVE, *GEAR),
    "a map as JSON": ("map", MOVE, *GEAR, "--json"),
    "filter by a map": ("filter", MOVE, "--method", "oscillator,map=map.json"),
    "export a map": ("export", "map.json", "--to", "c-header"),
    "features": ("features", "made.csv", *GEAR),
    "trend": ("trend", str(DATA / "fleet.ndjson"), "--json"),
    "report": ("report", "table.json", "-q"),
    "effects": ("diagnose", "--effects"),
    "diagnose": ("diagnose", "--model", "model.json", "made.csv", "--json"),
}
SLOW_UNDER_EMULATION = ("diagnose",)


class Processors(SharedCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = cls.folder
        (folder / "model.json").write_text(MODEL)
        (folder / "made.csv").write_bytes(cls.run_tool(*MADE))
        (folder / "table.json").write_bytes(cls.run_tool(*COMMANDS["design"]))
        (folder / "map.json").write_bytes(cls.run_tool("map", MOVE, *GEAR, "--json"))
        cls.here = {name: cls.run_tool(*words) for name, words in COMMANDS.items()}

    @classmethod
    def run_tool(cls, *words, before=(), **settings):
        done = subprocess.run([*before, TOOL, *words], capture_output=True, timeout=300, cwd=cls.folder,
                              stdin=subprocess.DEVNULL, env={**os.environ, **settings})
        if done.returncode != 0 or not done.stdout:
            raise AssertionError(f"{words}: exit {done.returncode}: {done.stderr.decode()}")
        return done.stdout

    def test_without_the_instruction_sets_that_the_c_library_would_choose_by(self):
        for name, words in COMMANDS.items():
            with self.subTest(name):
                self.assertEqual(self.run_tool(*words, GLIBC_TUNABLES=FEWER), self.here[name])

    def test_every_command_is_compared(self):
        listed = run("--help").stdout
        commands = {line.split()[0] for line in listed.partition("Look at a log:\n")[2].splitlines() if line.startswith("  ")}
        self.assertGreater(len(commands), 10)
        self.assertEqual(commands, {words[0] for words in COMMANDS.values()})

    def test_without_the_vectors_of_its_own_kernels(self):
        for name, words in COMMANDS.items():
            with self.subTest(name):
                self.assertEqual(self.run_tool(*words, RIPPLENOTCH_VECTORS="none"), self.here[name])

    @unittest.skipUnless(EMULATOR, "no qemu-x86_64 here; Debian's qemu-user brings it")
    def test_on_a_processor_of_2008(self):
        for name, words in COMMANDS.items():
            if name in SLOW_UNDER_EMULATION:
                continue
            with self.subTest(name):
                self.assertEqual(self.run_tool(*words, before=(EMULATOR, "-cpu", OLD_PROCESSOR)), self.here[name])
