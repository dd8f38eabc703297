# SPDX-License-Identifier: MIT
"""Every command line that is printed runs: by recommend and its pages, by help, and as the remedy of an error."""

import html
import re
import shlex
import shutil
import unittest

from commands import COMMANDS, DATA, LOGS, SharedCase, ended, run

# Logs of robots, with one joint of each of a kind: one that a map filters, one without a gear ratio, one that is too short.
REAL = (("gpl3/panda_gaz_j1.csv",), ("gpl3/panda_gaz_j4.csv",), ("kuka_kr300_trajA_all.csv", "--joint", "j2"), ("kuka_kr300_trajB_all.csv", "--joint", "j6"),
        ("neura_lara8_j3.csv",), ("ur10_unisa_exciting_all.csv", "--joint", "elbow_joint"), ("ur3e_rad_L1L2_j345.csv", "--joint", "j4"))


def printed(text):
    """The command lines in it, each once; what makes a file for others comes first."""
    lines = dict.fromkeys(line.strip(' ",') for line in text.split("\n") if re.match(r' *"?ripplenotch [a-z]+ ', line))
    return sorted(lines, key=lambda line: line.split()[1] not in ("map", "design"))


class Printed(SharedCase):
    def paste(self, line):
        """Runs it in the folder of the test; what it writes may be there already."""
        words = []
        for word in shlex.split(line):
            words += sorted(map(str, self.folder.glob(word))) if word.endswith("/*.csv") else [word]
        force = ["--force"] if "-o" in words or "--metrics" in words else []
        piped = (self.folder / "log.csv").read_text() if "-" in words else None
        done = run(*words[1:], *force, cwd=self.folder, stdin=piped)
        self.assertEqual(done.returncode, 0, f"{line}: {done.stderr}")

    def paste_all(self, text, least=0):
        lines = printed(text)
        self.assertGreaterEqual(len(lines), least, text)
        for line in lines:
            with self.subTest(line):
                self.paste(line)

    def advice(self, log, *words):
        done = run("recommend", log, "-q", *words, cwd=self.folder)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return done.stdout


class Recommended(Printed):
    def test_of_the_logs_of_the_paper(self):
        for log in sorted(DATA.glob("*.csv")):
            self.paste_all(self.advice(log))

    @unittest.skipUnless(LOGS.is_dir(), "SKIPPED: the folder of real logs is not here")
    def test_of_logs_of_robots(self):
        for name, *words in REAL:
            self.paste_all(self.advice(LOGS / name, *words))

    @unittest.skipUnless(LOGS.is_dir(), "SKIPPED: the folder of real logs is not here")
    def test_of_export_targets(self):
        log = LOGS / "gpl3" / "panda_gaz_j1.csv"
        for target in ("c-header", "c-header,precision=q31,range=50Nm", "cmsis-dsp"):
            text = self.advice(log, "--target", target)
            self.assertRegex(text, r"(?m)^    ripplenotch export ")
            self.paste_all(text, 3)

    def test_of_a_log_whose_name_has_blanks_and_whose_columns_are_stated(self):
        rows = (DATA / "paper_move_2s.csv").read_text().split("\n")
        names = rows[0].split(",")
        renamed = {"time_s": "t", "velocity_deg_s": "dq", "torque_nm": "tau", "position_deg": "q"}
        rows[0] = ",".join(renamed.get(name, name) for name in names)
        (self.folder / "a log.csv").write_text("\n".join(rows))
        self.paste_all(self.advice("a log.csv", "--unit", "dq=deg/s", "--unit", "q=deg", "--unit", "tau=Nm"), 3)


class Pages(Printed):
    def test_of_the_page_of_a_log(self):
        ended(0, run("report", DATA / "paper_move_2s.csv", "-o", "page.html", "-q", cwd=self.folder))
        text = re.sub(r"(?s)<script.*?</script>", "", (self.folder / "page.html").read_text())
        text = html.unescape(re.sub(r"<[^>]+>", "\n", text))
        self.paste_all(text, 4)


class Help(Printed):
    """The example in the help of each command, on files of the names that it takes."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.folder / "logs").mkdir()
        for log in ("log.csv", "run7.csv", "other.csv", "60.csv", "120.csv", "180.csv", "logs/j1_2026-11-29.csv"):
            shutil.copy(DATA / "paper_move_2s.csv", cls.folder / log)
        shutil.copy(DATA / "paper_model.json", cls.folder / "model.json")
        shutil.copy(DATA / "fleet.ndjson", cls.folder)
        for words in (("identify", "log.csv", "-o", "joint.json"), ("identify", "log.csv", "--json", "-o", "torque.json"),
                      ("design", "--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "18:180:18", "-o", "table.json")):
            done = run(*words, cwd=cls.folder)
            assert done.returncode == 0, done.stderr

    def test_examples(self):
        names = sorted({words.split()[0] for words in COMMANDS.values()})
        seen = 0
        for name in names:
            about = " ".join(run(name, "--help-all").stdout.strip().split("\n\n")[-1].split("\n"))
            about = re.sub(r"\\\s+", " ", about)
            for example in re.findall(r"(ripplenotch [a-z]+ -*\w.*?)(?= Example: | cat | \||$)", about):
                seen += 1
                with self.subTest(example):
                    self.paste(example.strip())
        self.assertGreater(seen, 5)
