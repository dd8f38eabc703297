# SPDX-License-Identifier: MIT
"""One account of a recording: all commands say the same of one log, and each says what it decided."""

import csv
import json
import resource
import unittest

from commands import ACCOUNTS, DATA, GEAR, LOGS, TOOL, SharedCase, asked_for_json, ended, run, sanitized
import hard_logs

MOST_BYTES = 2 << 30


def without_effects():
    """Words that have diagnose read the log and measure the gap, and leave the search for names to its own tests."""
    effects = json.loads(run("diagnose", "--effects", "--json").stdout)["effects"]
    return [word for effect in effects for word in ("--without", effect["effect"])]


class Account(SharedCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # What runs these tests is under the same limit as the tool: set in each of 400 runs, it took a copy of Python each.
        # A sanitizer maps terabytes before the program begins, so that it runs without the limit.
        if not sanitized(TOOL):
            resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
        cls.nothing_tried = without_effects()
        cls.hard = hard_logs.Written(cls.folder)

    def commands(self, log, read):
        """Every command that tells of the recording, as words; none is asked to search for more than that."""
        for name in ACCOUNTS:
            if name != "recommend":
                words = asked_for_json(name, log, self.folder / "out.csv")
                yield name, [*words, *(self.nothing_tried if name == "diagnose" else []), *read]

    def accounts(self, log, read=(), leave_out=()):
        """The recording blocks by command; commands that refuse the log are left out, and have to say why."""
        found, refused, gears = {}, {}, []
        for name, words in self.commands(log, read):
            if name in leave_out:
                continue
            done = run(*words)
            if done.returncode == 0:
                result = json.loads(done.stdout)
                self.assertIn("recording", result, f"{name} of {log}")
                found[name] = result["recording"]
                if name in ("filter", "compare", "spectrum --track"):
                    gears.append((result["gear"]["ratio"], result["gear"]["orders"]))
            else:
                self.assertEqual(done.returncode, 3, f"{name} of {log}: {done.stderr}")
                refused[name] = done.stderr
        self.assertTrue(all(gear == (100, [1, 2]) for gear in gears), gears)
        return found, refused

    def one_account(self, log, read=(), leave_out=()):
        found, refused = self.accounts(log, read, leave_out)
        info = found.pop("info")
        for name, account in found.items():
            self.assertEqual(account, info, f"{name} and info of {log}")
        return info, refused


class Laws(Account):
    def test_all_commands_say_the_same_of_every_log_in_data(self):
        for log in sorted(DATA.glob("*.csv")):
            with self.subTest(log.name):
                info, _ = self.one_account(log)
                self.assertGreater(info["rows"], 0)

    def test_all_commands_say_the_same_of_logs_in_every_dialect(self):
        for log in sorted((DATA / "dialects").glob("*.csv")):
            with self.subTest(log.name):
                read = ["--sample-rate", "1kHz"] if log.stem == "no_time" else []
                joint = json.loads(run("info", log, "--json", *read).stdout)["joints"][0]["joint"]
                self.one_account(log, read + (["--joint", joint] if joint else []), leave_out=("diagnose", "simulate"))

    def test_all_commands_say_the_same_of_broken_logs(self):
        for name, log in self.hard.items():
            with self.subTest(name):
                self.one_account(log)


@unittest.skipUnless(LOGS.is_dir(), "the folder of real logs is not here")
class RealLogs(Account):
    def test_all_commands_say_the_same(self):
        for name, joint in (("gpl3/panda_gaz_j1.csv", None), ("kuka_kr300_trajA_all.csv", "j4"), ("neura_lara8_j3.csv", None),
                            ("ur10_unisa_exciting_all.csv", "shoulder_pan_joint")):
            if not (LOGS / name).is_file():
                continue
            with self.subTest(name):
                self.one_account(LOGS / name, ["--joint", joint] if joint else [])


class Angles(Account):
    """Metrics are measured on the joint's angle, whatever the position column is."""

    def metrics(self, name, *more):
        done = ended(0, run("filter", self.hard[name], "--method", "tracking", *GEAR, "-o", self.folder / "out.csv", "--json", "--force", "-v",
                            *more))
        return json.loads(done.stdout), done.stderr

    def test_the_ripple_is_found_and_what_was_decided_is_said(self):
        plain = self.metrics("clean")[0]["orders"]
        self.assertAlmostEqual(plain[0]["raw_nm"], hard_logs.RIPPLE_NM[1], delta=0.01)
        for name, source, said in (
                ("another_joints_position", "velocity", "0.3 times as much"),
                ("unrelated_position", "velocity", "another joint's"),
                ("motor_side_position", "position", "motor side"),
                ("reversed_position", "position", "opposite signs"),
                ("position_stops_on_the_way", "position", "from data row")):
            with self.subTest(name):
                metrics, messages = self.metrics(name)
                self.assertEqual(metrics["recording"]["angle"]["source"], source)
                self.assertIn(said, messages)
                self.assertIn(f"angle from {source}", messages)
                for order, expected in zip(metrics["orders"], plain):
                    self.assertAlmostEqual(order["raw_nm"], hard_logs.RIPPLE_NM[order["order"]], delta=0.01)
                    self.assertGreater(order["attenuation_db"], expected["attenuation_db"] - 1.0)

    def test_a_joint_whose_position_is_constant_is_at_rest(self):
        log = self.hard["standing_position"]
        for words, codes, said in ((("identify", log), (0, 5), "the joint is at rest"), (("recommend", log), (0, 5), "the joint is at rest"),
                                   (("diagnose", log, "--model", "auto", "--improved-model", self.folder / "m.json"), (3,), "does not move")):
            with self.subTest(words[0]):
                done = run(*words)
                self.assertIn(done.returncode, codes, done.stderr)
                self.assertIn(said, done.stdout + done.stderr)
                self.assertIn("position is constant", done.stderr)
        joint = json.loads(run("info", log, "--json").stdout)["joints"][0]
        self.assertEqual(joint["turns"], 0.0)
        self.assertFalse(any(not stretch["rest"] for stretch in joint["steady_stretches"]))

    def test_a_limit_is_kept_on_the_right_angle(self):
        ended(0, run("filter", self.hard["another_joints_position"], "--method", "tracking", *GEAR, "-o", self.folder / "out.csv", "--force",
                     "--min-attenuation", "15dB"))

    def test_compare_measures_what_filter_measures(self):
        for name in ("another_joints_position", "motor_side_position", "reversed_position",
                     "rate_falls_on_the_way", "lost_rows", "gaps", "position_stops_on_the_way"):
            with self.subTest(name):
                metrics, _ = self.metrics(name)
                done = ended(0, run("compare", self.hard[name], "--method", "tracking,gear-ratio=100,orders=1:2", *GEAR, "--json"))
                rows = {row["method"].split(",")[0]: row for row in json.loads(done.stdout)["methods"]}
                for one, other in zip(metrics["orders"], rows["tracking"]["attenuation_db"]):
                    self.assertAlmostEqual(one["attenuation_db"], other["db"], delta=0.02)


class Clocks(Account):
    def account(self, name):
        done = ended(0, run("info", self.hard[name], "--json"))
        return json.loads(done.stdout)

    def test_a_change_of_rate_is_told_with_its_row_and_is_no_gap(self):
        info = self.account("rate_falls_on_the_way")
        account = info["recording"]
        self.assertEqual((account["nominal_rate_hz"], account["gap_count"]), (2000, 0))
        self.assertAlmostEqual(account["mean_rate_hz"], 2000, delta=0.01)
        self.assertEqual([change["row"] for change in account["rate_changes"]], [17000])
        self.assertAlmostEqual(account["rate_changes"][0]["to_hz"], 167, delta=0.01)
        self.assertTrue(any("data row 17001" in warning for warning in info["warnings"]))

    def test_rows_at_another_rate_pass_as_they_are(self):
        log, out = self.hard["rate_falls_on_the_way"], self.folder / "passed.csv"
        ended(0, run("filter", log, "--method", "lowpass,cutoff=5Hz,order=1", "-o", out, "--force"))
        before, after = log.read_text().split("\n"), out.read_text().split("\n")
        changed = [k for k in range(1, len(before) - 1) if before[k] != after[k]]
        self.assertGreater(len(changed), 16000)
        self.assertLessEqual(max(changed), 17001)

    def test_lost_rows_do_not_change_the_controllers_rate(self):
        log = self.hard["lost_rows"]
        account = self.account("lost_rows")["recording"]
        self.assertEqual(account["nominal_rate_hz"], 1000)
        self.assertAlmostEqual(account["mean_rate_hz"], 978.4, delta=0.1)
        joint = self.folder / "joint.json"
        ended(0, run("identify", log, "-o", joint, "--force"), "mean rate 978.399 Hz, typical step 1 ms (1000 Hz): samples are missing or delayed")
        self.assertEqual(json.loads(joint.read_text())["sample_rate_hz"], 1000)
        table = self.folder / "table.json"
        ended(0, run("design", joint, "-o", table, "--force"))
        self.assertEqual(json.loads(table.read_text())["sample_rate_hz"], 1000)

    def test_info_says_what_filter_will_do(self):
        for name, log in self.hard.items():
            with self.subTest(name):
                uses = {use["name"]: use for use in self.account(name)["uses"]}
                done = run("filter", log, "--method", "lowpass,cutoff=5Hz,order=1", "-o", self.folder / "out.csv", "--force")
                self.assertEqual(done.returncode, 0 if uses["filter"]["possible"] else 3, done.stderr)
                if done.returncode:
                    self.assertIn(uses["filter"]["reason"], done.stderr)

    def test_every_second_torque_held_is_one_count(self):
        account = self.account("every_second_torque_held")["recording"]
        self.assertEqual((account["held_samples"], account["longest_hold"]), (2000, 1))

    def test_no_clock_of_any_kind_makes_memory_grow(self):
        log = self.folder / "nanoseconds.csv"
        with open(self.hard["clean"]) as read, open(log, "w") as write:
            rows = list(csv.reader(read))
            write.write(",".join(rows[0]) + "\n")
            for row in rows[1:6001]:
                write.write(",".join([str(int(float(row[0]) * 1e9) + 1_700_000_000_000_000_000)] + row[1:]) + "\n")
        for name, words in self.commands(log, ["--unit", "time=s"]):
            with self.subTest(name):
                done = run(*words)
                self.assertIn(done.returncode, (0, 2, 3), done.stderr)  # 2: 5 Hz is beyond half of such a rate
