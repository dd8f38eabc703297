# SPDX-License-Identifier: MIT
"""Several joints of a log: which are meant by --joint, and that each gives what it gives alone."""

import csv
import io
import json
import math

from commands import GEAR, OF_A_LOG, Case, SharedCase, asked, ended

# Those that take several joints, with what each gives: a document with `joints`, or CSV with a column `joint`.
LISTS = {
    "compare": "comparisons", "spectrum": "spectra", "spectrum --segment": "spectra", "spectrum --domain order": "spectra",
    "spectrum --map campbell": "spectra", "spectrum --map order": "spectra", "spectrum --track": "tracks",
    "identify": "joints", "recommend": "recommendations",
}
CSV = {"spectrum": ["--bins"], "spectrum --segment": ["--bins"], "spectrum --domain order": ["--bins"], "spectrum --map campbell": [], "spectrum --track": []}
HEAD = ("schema", "tool", "version", "command", "inputs", "recording", "recordings")


def wide_log(joints=("j1", "j2", "j3"), rows=4000, without=()):
    """Joints that move through all speeds, each with ripple of its own. `without`: columns that are not there."""
    lines = ["time_s," + ",".join(name for joint in joints for name in columns_of(joint) if name not in without)]
    position = [0.0] * len(joints)
    for k in range(rows):
        cells = [f"{k / 1000:.3f}"]
        for j, joint in enumerate(joints):
            speed = 90 + 60 * math.sin(k / 500 + j)
            ripple = 0.5 / (j + 1) * math.cos(math.radians(100 * position[j])) + 0.2 * math.cos(math.radians(200 * position[j]))
            noise = 0.02 * math.sin(7.3 * k * k + j)
            values = (speed, 3 * math.sin(k / 900) + ripple + noise, position[j])
            cells += [f"{value:.5f}" for name, value in zip(columns_of(joint), values) if name not in without]
            position[j] += speed / 1000
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def columns_of(joint):
    return f"{joint}_velocity_deg_s", f"{joint}_torque_nm", f"{joint}_position_deg"


def without_head(document):
    return {name: value for name, value in document.items() if name not in HEAD}


def rows_of(text):
    return list(csv.reader(io.StringIO(text)))


class EachAsAlone(SharedCase):
    """The law: of a log of several joints each gives what the run with --joint of it alone gives."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.folder / "wide.csv").write_text(wide_log())

    def alone(self, name, joint, *more):
        return self.good(*asked(name, "wide.csv"), "--joint", joint, *more).stdout

    def test_every_command_that_reads_a_log_is_under_a_law_here_or_takes_one_joint(self):
        elsewhere = {"info", "filter", "map", "features", "diagnose"}  # below
        self.assertEqual(set(OF_A_LOG) - set(LISTS) - elsewhere, {"simulate"})

    def test_documents(self):
        for name, kind in LISTS.items():
            with self.subTest(name):
                whole = json.loads(self.good(*asked(name, "wide.csv"), "--json").stdout)
                self.assertEqual(whole["schema"], f"ripplenotch/{kind}/1")
                self.assertEqual([one["joint"] for one in whole["joints"]], ["j1", "j2", "j3"])
                for one in whole["joints"]:
                    alone = {"joint": one["joint"], **json.loads(self.alone(name, one["joint"], "--json"))}
                    found, expected = (json.dumps(without_head(each), sort_keys=True) for each in (one, alone))
                    self.assertEqual(found, expected)
                    if name == "identify":
                        self.assertTrue(one["amplitude_by_speed_and_direction"])

    def test_rows(self):
        for name, more in CSV.items():
            with self.subTest(name):
                head, *rows = rows_of(self.good(*asked(name, "wide.csv"), *more).stdout)
                for joint in ("j1", "j2", "j3"):
                    alone = rows_of(self.alone(name, joint, *more))
                    self.assertEqual(head, ["joint", *alone[0]])
                    self.assertEqual([row[1:] for row in rows if row[0] == joint], alone[1:])

    def test_reports(self):
        for name in ("compare", "recommend", "spectrum", "identify"):
            with self.subTest(name):
                whole = self.good(*asked(name, "wide.csv")).stdout
                for joint in ("j1", "j2", "j3"):
                    prefix = "" if name == "identify" else f"{joint}: "
                    self.assertIn(prefix + self.alone(name, joint), whole)

    def test_a_file_each(self):
        for name in LISTS:
            with self.subTest(name):
                self.good(*asked(name, "wide.csv"), "--json", "-o", "own_{joint}.json", "--force")
                for joint in ("j1", "j2", "j3"):
                    own = json.loads((self.folder / f"own_{joint}.json").read_text())
                    alone = json.loads(self.alone(name, joint, "--json"))
                    self.assertEqual(own["schema"], alone["schema"])
                    self.assertEqual(without_head(own), without_head(alone))

    def test_filter_map_features_and_info(self):
        self.good(*asked("filter", "wide.csv"), "--joint", "all", "-o", "all.csv", "--force")
        last = "wide.csv"
        for joint in ("j1", "j2", "j3"):
            self.good(*asked("filter", last), "--joint", joint, "-o", f"{joint}.csv", "--force")
            last = f"{joint}.csv"
        self.assertEqual((self.folder / "all.csv").read_bytes(), (self.folder / last).read_bytes())
        self.good(*asked("map", "wide.csv"), "--joint", "all", "-o", "map_{joint}.json", "--force")
        features = [json.loads(line) for line in self.good(*asked("features", "wide.csv")).stdout.splitlines()]
        info = json.loads(self.good("info", "wide.csv", "--json").stdout)["joints"]
        for place, joint in enumerate(("j1", "j2", "j3")):
            own = json.loads((self.folder / f"map_{joint}.json").read_text())
            self.assertEqual(without_head(own), without_head(json.loads(self.alone("map", joint, "--json"))))
            self.assertEqual(features[place], json.loads(self.alone("features", joint)))
            alone = json.loads(self.good("info", "wide.csv", "--joint", joint, "--json").stdout)["joints"]
            self.assertEqual([info[place]], alone)

    def test_diagnose(self):
        whole = json.loads(self.good(*asked("diagnose", "wide.csv"), "--joint", "j1,j3", "--json").stdout)["joints"]
        self.assertEqual([one["joint"] for one in whole], ["j1", "j3"])
        for one in whole:
            alone = without_head(json.loads(self.alone("diagnose", one["joint"], "--json")))
            self.assertEqual({n: v for n, v in without_head(one).items() if n != "joint"}, {n: v for n, v in alone.items() if n != "joint"})


class Selection(Case):
    """--joint: names, numbers, lists and ranges."""

    def taken(self, *words, log="wide.csv"):
        return [line.split(":")[0] for line in self.good("spectrum", log, "-q", *words).stdout.splitlines() if ": " in line[:20]]

    def write(self, name, text):
        (self.folder / name).write_text(text)

    def test_lists_ranges_and_repeats(self):
        self.write("wide.csv", wide_log(("j1", "j2", "j3", "j4"), 600))
        for words, joints in ((["--joint", "j1,j3"], "j1 j3"), (["--joint", "j2-j4"], "j2 j3 j4"), (["--joint", "2-3,j1"], "j1 j2 j3"),
                              (["--joint", "j4", "--joint", "1"], "j1 j4"), (["--joint", "joint2,3"], "j2 j3"),
                              (["--joint", "all"], "j1 j2 j3 j4"), ([], "j1 j2 j3 j4"), (["--joint", "3,3,j1"], "j1 j3")):
            with self.subTest(words):
                self.assertEqual(self.taken(*words), joints.split())

    def test_a_number_is_that_of_the_log(self):
        self.write("zero.csv", wide_log(("arm_joint0", "arm_joint1", "arm_joint2"), 600))
        self.assertEqual(self.taken("--joint", "0,arm_joint2", log="zero.csv"), ["arm_joint0", "arm_joint2"])
        self.assertEqual(self.taken("--joint", "1-2", log="zero.csv"), ["arm_joint1", "arm_joint2"])

    def test_what_is_wrong_names_the_joints_that_there_are(self):
        self.write("wide.csv", wide_log(rows=300))
        for words, said in ((["j1,j7"], "no joint 'j7'"), (["j7"], "no joint 'j7'"), (["j1-j7"], "no joint 'j1-j7'"), (["j1,,j2"], "no joint ''"),
                            (["j3-j1"], "runs backwards"), (["j1", "--joint", "elbow"], "no joint 'elbow'")):
            for command in ("info", "spectrum", "identify", "filter", "map", "diagnose", "compare", "spectrum --track", "recommend"):
                with self.subTest(words=words, command=command):
                    ended(2, self.run_tool(*asked(command, "wide.csv"), "--joint", *words), said, "j1, j2, j3")

    def test_what_is_of_one_joint_says_so(self):
        self.write("wide.csv", wide_log(rows=1500))
        for command in ("spectrum", "spectrum --track", "compare", "identify"):
            with self.subTest(command):
                if command == "identify":  # draws which motor is in which torque
                    self.good(*asked(command, "wide.csv"), "--plot", "a.json")
                    self.assertEqual(json.loads((self.folder / "a.json").read_text())["name"], "motor-matrix")
                else:
                    ended(2, self.run_tool(*asked(command, "wide.csv"), "--plot", "a.json"), "a picture shows one joint")
                self.good(*asked(command, "wide.csv"), "--plot", f"{command}_{{joint}}.json")
                self.assertTrue((self.folder / f"{command}_j2.json").exists())
        ended(2, self.run_tool(*asked("spectrum --track", "wide.csv"), "-o", "a.npy"), "put {joint} into the name")
        self.good(*asked("spectrum --track", "wide.csv"), "-o", "a_{joint}.npy")
        self.assertTrue((self.folder / "a_j3.npy").exists())


class LeftOut(Case):
    """A joint without what a command needs is left out with a warning; where none is left, it is an error."""

    def setUp(self):
        super().setUp()
        (self.folder / "wide.csv").write_text(wide_log(without=("j2_torque_nm",)))

    def test_no_torque(self):
        for command in ("spectrum", "spectrum --track", "compare", "identify", "recommend", "filter"):
            for words in (["--joint", "all"], ["--joint", "j1-j3"]):
                with self.subTest(command=command, words=words):
                    done = self.good(*asked(command, "wide.csv"), *words)
                    self.assertIn("warning: joint j2 is left out: it has no torque", done.stderr)
                    self.assertEqual(done.stderr.count("left out: it has no torque"), 1)
            ended(2, self.run_tool(*asked(command, "wide.csv"), "--joint", "j2"), "it has no torque")

    def test_no_table_or_joint_file(self):
        self.good("design", *GEAR, "--sample-rate", "1kHz", "--speed", "20:180:20", "--q", "1", "-o", "table_j1.json", "--json")
        words = ("filter", "wide.csv", "--joint", "all", "--method", "switching,table=table_{joint}.json")
        done = self.good(*words, "-o", "all.csv")
        self.assertIn("joint j3 is left out: table_j3.json", done.stderr)
        self.good("filter", "wide.csv", "--joint", "j1", "--method", "switching,table=table_j1.json", "-o", "one.csv")
        self.assertEqual((self.folder / "all.csv").read_bytes(), (self.folder / "one.csv").read_bytes())
        (self.folder / "table_j1.json").unlink()
        self.assertEqual(self.run_tool(*words, "-o", "none.csv").returncode, 4)
        self.assertFalse((self.folder / "none.csv").exists())
        self.good("identify", "wide.csv", "--joint", "j1", "-o", "found_j1.json")
        done = self.good("spectrum", "wide.csv", "--track", "--joint-file", "found_{joint}.json", "-o", "track.csv")
        self.assertIn("joint j3 is left out: found_j3.json", done.stderr)
        self.assertEqual({row[0] for row in rows_of((self.folder / "track.csv").read_text())}, {"joint", "j1"})

    def test_nothing_is_left(self):
        done = ended(4, self.run_tool("spectrum", "wide.csv", "--track", "--joint-file", "found_{joint}.json"))
        self.assertEqual(done.stdout, "")


class SaidOnce(Case):
    """What is said of several joints in the same words is said once."""

    def test_the_same_warning(self):
        text = wide_log(rows=1500).split("\n")
        (self.folder / "wide.csv").write_text("\n".join(text))
        done = self.good("compare", "wide.csv", "--method", "lowpass,cutoff=5Hz,order=1")
        self.assertEqual(done.stderr.count("no line is known"), 1, done.stderr)
        self.assertNotIn("joint j", done.stderr)

    def test_of_some_joints_with_their_names(self):
        (self.folder / "wide.csv").write_text(wide_log(rows=1500, without=("j1_position_deg", "j3_position_deg")))
        done = self.good("spectrum", "wide.csv", "--track", *GEAR, "-o", "track.csv")
        self.assertEqual([line for line in done.stderr.splitlines() if "no usable position" in line],
                         ["ripplenotch: warning: joints j1, j3: no usable position: the angle is integrated velocity, and phases "
                          "count from the first sample"])


class Currents(Case):
    """A motor current without --kt: everything is in A, and says so."""

    def setUp(self):
        super().setUp()
        (self.folder / "amps.csv").write_text(wide_log(("j1", "j2")).replace("_torque_nm", "_current_A"))

    def test_reports_and_documents(self):
        for name in ("compare", "recommend", "spectrum", "identify", "map", "info"):
            with self.subTest(name):
                words = [*asked(name, "amps.csv"), "--joint", "j1", "-q"]
                report = self.good(*words).stdout.split("\nwarnings\n")[0]
                self.assertNotRegex(report, r"(?m)(^|[ (])Nm\b")
                self.assertRegex(report, r"(?m)[ (]A\b")
                document = json.loads(self.good(*words, "--json").stdout)
                self.assertEqual(document["recording"]["torque_unit"], "A")
                self.assertNotIn(" Nm", document.get("verdict", ""))
                with_constant = self.good(*words, "--kt", "2").stdout
                self.assertIn("Nm", with_constant)
                self.assertNotIn("torque_unit", json.loads(self.good(*words, "--kt", "2", "--json").stdout)["recording"])

    def test_the_columns_of_a_table_keep_their_places(self):
        amps = self.good("spectrum", "amps.csv", "--joint", "j1", "-q").stdout
        newton_metres = self.good("spectrum", "amps.csv", "--joint", "j1", "-q", "--kt", "1").stdout
        self.assertEqual([len(line) for line in amps.splitlines()[1:3]], [len(line) for line in newton_metres.splitlines()[1:3]])


class Columns(Case):
    def test_every_column_of_a_file_is_listed_with_what_it_was_taken_for(self):
        names = ["time_s", "j1_velocity_deg_s", "j1_torque_nm", "j1_target_torque_nm", "j2_torque_percent", "temperature_degc"]
        names += [f"note_{k}" for k in range(20)]
        rows = [",".join([f"{k / 100}", "90", f"{k % 7}", "1", "3"] + ["20"] * 21) for k in range(300)]
        (self.folder / "log.csv").write_text("\n".join([",".join(names), *rows]) + "\n")
        self.assertIn("other columns", self.good("info", "log.csv").stdout)
        listed = self.good("info", "log.csv", "-v").stdout
        for name in names:
            self.assertIn(name, listed)
        for name, said in (("time_s", "time"), ("j1_torque_nm", "torque"), ("j1_target_torque_nm", "not used: a torque that is a wish"),
                           ("temperature_degc", "not used: its name"), ("note_19", "not used: its name")):
            self.assertRegex(listed, rf"(?m)^ +\d+  {name} +{said}")
        self.assertRegex(listed, r"(?m)^ +\d+  j2_torque_percent +not used: ")
