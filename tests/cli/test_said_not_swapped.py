# SPDX-License-Identifier: MIT
"""What is asked is done or refused; nothing else takes its place without a word."""

import json

from commands import COMMANDS, DATA, WRITES_A_LOG, asked, ended
from test_filter_joints import wide_log
from test_gear_methods import MOVE, Case

PAPER_60, PAPER_90 = DATA / "paper_60deg_s.csv", DATA / "paper_90deg_s.csv"
LOW = ["--method", "lowpass,cutoff=13rad/s"]


class Told(Case):
    def refused(self, words, *pieces, code=2):
        done = ended(code, self.run_tool(*words))
        for piece in pieces:
            self.assertIn(piece, done.stderr)
        return done


class NamesOfJson(Told):
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


class NamesOfOtherKinds(Told):
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


class Lists(Told):
    def test_a_list_with_other_marks_is_refused_with_the_list_as_it_should_be(self):
        for words, hint in ((["1", "2"], "--orders 1,2"), (["1,", "2"], "--orders 1,2"), (["1 2"], "--orders 1,2"),
                            (["1:2"], "--orders 1,2"), (["1;2;4"], "--orders 1,2,4"), (["1, 2"], "--orders 1,2")):
            for command in (["spectrum", MOVE, "--track"], ["filter", MOVE, *LOW], ["compare", MOVE, *LOW],
                            ["design", "--sample-rate", "1kHz", "--speed", "18:90:18"]):
                with self.subTest(command=command[0], words=words):
                    self.refused([*command, "--gear-ratio", "100", "--orders", *words],
                                 "a list is written with commas and without spaces", hint)
        self.refused(["spectrum", MOVE, "--track", "--tones", "25Hz", "50Hz"], "--tones 25Hz,50Hz")

    def test_a_log_whose_name_is_a_number_is_a_log(self):
        (self.folder / "2").write_bytes(MOVE.read_bytes())
        self.good("spectrum", "--track", "--gear-ratio", "100", "--orders", "1", "2")


class Joints(Told):
    def setUp(self):
        super().setUp()
        (self.folder / "wide.csv").write_text(wide_log())

    def test_identify_writes_each_joint_under_its_name(self):
        self.good("identify", "wide.csv", "--joint", "all", "-o", "{joint}.json")
        together = json.loads(self.good("identify", "wide.csv", "--joint", "all", "--json").stdout)["joints"]
        self.assertEqual([one["joint"] for one in together], ["j1", "j2", "j3"])
        for one in together:
            alone = json.loads((self.folder / f"{one['joint']}.json").read_text())
            self.assertEqual(alone["schema"], "ripplenotch/joint/1")
            self.assertEqual(alone["gear_ratio"], one["gear_ratio"])
        self.assertFalse((self.folder / "{joint}.json").exists())

    def test_a_log_whose_joint_has_no_name_cannot_fill_the_mark(self):
        self.refused(["identify", PAPER_90, "-o", "{joint}.json"], "{joint} stands for a joint's name")

    def test_columns_that_are_added_one_after_another_bear_their_joints(self):
        self.good("filter", "wide.csv", "--joint", "j1", *LOW, "--append", "-o", "once.csv")
        self.good("filter", "once.csv", "--joint", "j2", *LOW, "--append", "-o", "twice.csv")
        head = (self.folder / "twice.csv").read_text().splitlines()[0]
        self.assertTrue(head.endswith(",j1_torque_filtered_nm,j2_torque_filtered_nm"), head)
        together = self.good("filter", "wide.csv", "--joint", "all", *LOW, "--append").stdout.splitlines()
        self.assertTrue(together[0].startswith(head))

    def test_a_second_column_of_one_joint_gets_another_name(self):
        self.good("filter", PAPER_90, *LOW, "--append", "-o", "once.csv")
        self.good("filter", "once.csv", "--columns", "torque=torque_nm", "--method", "none", "--append", "-o", "twice.csv")
        head = (self.folder / "twice.csv").read_text().splitlines()[0].split(",")
        self.assertEqual(head[-2:], ["torque_filtered_nm", "torque_filtered_2_nm"])


class RawLogs(Told):
    def setUp(self):
        super().setUp()
        self.raw = PAPER_60.read_bytes()
        (self.folder / "log.csv").write_bytes(self.raw)

    def test_a_log_is_not_written_over_itself_even_by_force(self):
        (self.folder / "alias.csv").symlink_to("log.csv")
        for words in (["-o", "log.csv"], ["-o", "./log.csv"], ["-o", "alias.csv"]):
            self.refused(["filter", "log.csv", *LOW, *words, "--force"], "name another file")
            self.assertEqual((self.folder / "log.csv").read_bytes(), self.raw)


class Belief(Told):
    def test_a_ratio_that_the_log_contradicts_is_told(self):
        for believed in (101, 99, 50.5, 120):
            done = self.good("identify", PAPER_60, PAPER_90, "--gear-ratio", believed)
            self.assertIn(f"{believed}", done.stdout.splitlines()[0] + done.stderr, done.stdout)
        done = self.good("identify", PAPER_60, PAPER_90, "--gear-ratio", 100)
        self.assertEqual(done.stderr, "")
