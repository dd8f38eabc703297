# SPDX-License-Identifier: MIT
"""What is asked is done or refused; nothing else takes its place without a word."""

import json

from commands import COMMANDS, DATA, WRITES_A_LOG, asked
from test_one_gear import MOVE, Case

PAPER_90 = DATA / "paper_90deg_s.csv"
LOW = ["--method", "lowpass,cutoff=13rad/s"]


class NamesOfJson(Case):
    def test_a_name_that_ends_in_json_gives_the_bytes_of_the_option(self):
        (self.folder / "t.json").write_text(self.good(
            "design", "--gear-ratio", 100, "--sample-rate", "1kHz", "--speed", "18:90:18", "--json").stdout)
        for name in COMMANDS:
            # What these write with -o is another thing.
            if name in (*WRITES_A_LOG, "diagnose", "diagnose --effects", "export", "report", "features"):
                continue
            words = asked(name)
            with self.subTest(words=words):
                expected = self.good(*words, "--json").stdout
                self.good(*words, "-o", "by_name.json", "--force")
                self.assertEqual((self.folder / "by_name.json").read_text(), expected)
                json.loads(expected)


class NamesOfOtherKinds(Case):
    """-o writes what the name promises, or is refused: no text in a .csv, no CSV in a .svg."""

    ENDINGS = ("txt", "json", "csv", "tsv", "npy", "svg", "png", "pdf", "html", "h", "m", "yaml", "mat", "xlsx", "gz")
    SIMULATE = ["simulate", "--gear-ratio", 100, "--ripple", "1:1Nm", "--motion", "constant,speed=60deg/s,duration=1s",
                "--sample-rate", "1kHz"]
    DESIGN = ["design", "--gear-ratio", 100, "--sample-rate", "1kHz", "--speed", "18:90:18"]

    def commands(self):
        self.good(*self.DESIGN, "-o", "t.json", "--json")
        yield from (["info", MOVE], ["identify", PAPER_90], ["compare", MOVE, *LOW], self.DESIGN,
                    ["spectrum", PAPER_90],
                    ["spectrum", PAPER_90, "--bins"], ["spectrum", MOVE, "--map", "order"],
                    ["spectrum", MOVE, "--track", "--gear-ratio", 100], ["spectrum", MOVE, "--track", "--gear-ratio", 100, "--json"],
                    ["filter", MOVE, *LOW], self.SIMULATE, ["report", "t.json"],
                    ["diagnose", MOVE, "--model", DATA / "paper_model.json"])
        for target in ("c-header", "cmsis-dsp", "scipy", "matlab", "ros-filters", "servo-drive", "json"):
            yield ["export", "--method", f"fixed,centers=60Hz,q=1,depth=40dB", "--sample-rate", "1kHz", "--to", target]

    def kind_of(self, path):
        """The endings that what a file holds may have."""
        data = path.read_bytes()
        if data.startswith(b"\x93NUMPY"):
            return {"npy"}
        if data.startswith(b"MATLAB 5.0 MAT-file"):
            return {"mat"}
        if data.startswith(b"\x89HDF\r\n\x1a\n"):
            return {"h5", "hdf5"}
        text = data.decode()
        if text.startswith("<!"):
            return {"html"}
        if text.startswith("{"):
            json.loads(text)
            return {"json", "txt"}
        if "#ifndef" in text or "#pragma once" in text:
            return {"h"}
        rows = [line for line in text.splitlines() if line and not line.startswith(("#", "%"))]
        if len(rows) > 1 and "," in rows[0] and len({row.count(",") for row in rows}) == 1:
            return {"csv", "tsv", "txt"}
        return {"txt"} | ({"m"} if "sos" in text else set()) | ({"yaml"} if text.rstrip().count(":") else set())

    def test_a_file_is_of_the_kind_that_its_name_says_or_is_refused(self):
        for words in self.commands():
            option = "--improved-model" if words[0] == "diagnose" else "-o"
            fitting = []
            for ending in self.ENDINGS:
                path = self.folder / f"x.{ending}"
                path.unlink(missing_ok=True)
                done = self.run_tool(*words, option, path.name, "--force", "-q")
                with self.subTest(words=words, ending=ending):
                    if done.returncode == 0:
                        fitting.append(ending)
                        self.assertIn(ending, self.kind_of(path))
                        continue
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertRegex(done.stderr, rf"{option} x\.{ending}: .*(name it \.|name the file)")
                    self.assertFalse(path.exists())
            self.assertTrue(fitting, words)
