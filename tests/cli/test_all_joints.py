# SPDX-License-Identifier: MIT
"""Several joints of a log: each gives what it gives alone."""

import csv
import io
import json

from commands import OF_A_LOG, Case, SharedCase, asked
from logs import wide

# Those that take several joints, with what each gives: a document with `joints`, or CSV with a column `joint`.
LISTS = {
    "compare": "comparisons", "spectrum": "spectra", "spectrum --segment": "spectra", "spectrum --domain order": "spectra",
    "spectrum --map campbell": "spectra", "spectrum --map order": "spectra", "spectrum --track": "tracks",
    "identify": "joints", "recommend": "recommendations",
}
CSV = {"spectrum": ["--bins"], "spectrum --segment": ["--bins"], "spectrum --domain order": ["--bins"], "spectrum --map campbell": [], "spectrum --track": []}
HEAD = ("schema", "tool", "version", "command", "inputs", "recording", "recordings")


def without_head(document):
    return {name: value for name, value in document.items() if name not in HEAD}


def rows_of(text):
    return list(csv.reader(io.StringIO(text)))


class EachAsAlone(SharedCase):
    """The law: of a log of several joints each gives what the run with --joint of it alone gives."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.folder / "wide.csv").write_text(wide(["j1", "j2", "j3"]))

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


class Currents(Case):
    """A motor current without --kt: everything is in A, and says so."""

    def setUp(self):
        super().setUp()
        (self.folder / "amps.csv").write_text(wide(["j1", "j2"]).replace("_torque_nm", "_current_A"))

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
