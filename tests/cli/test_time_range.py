# SPDX-License-Identifier: MIT
"""--from and --to: the law that rows outside are as if they were not there, and what is said about them."""

import json
import math

from commands import ACCOUNTS, DATA, Case, asked_for_json

METHOD = ["--method", "tracking,gear-ratio=100,orders=1:2"]

# Every command that tells of a log, {}.
LAWS = {name: asked_for_json(name, "{}") for name in ACCOUNTS}
LAWS["compare --truth"] = [*LAWS["compare"], "--truth", "{}"]


def motion(rows):
    """Row, speed, torque and position of a joint that changes its speed, with ripple of a gear of 100."""
    position, found = 0.0, []
    for k in range(rows):
        speed, motor = 60.0 + 20.0 * math.sin(k / 500), math.radians(100 * position)
        found.append((k, speed, 1.0 + 0.8 * math.sin(motor) + 0.5 * math.sin(2 * motor) + 0.01 * math.sin(k * k), position))
        position += speed / 1000
    return found


def plain(k, speed, torque, position):
    return f"{k / 1000},{speed:.4f},{torque:.5f},{position:.5f}"


HEAD = "time_s,velocity_deg_s,torque_nm,position_deg"


def spoilt(lines, first, last):
    """Rows outside that nobody may look at: held, at another rate, broken, back in time, of another length."""
    before = [f"{k / 500},0,0,0" for k in range(first // 3)] + ["# a remark", "0.15,x,0,0", "0.14,1,2", "", "0.13,nan,,1"]
    after = ["9,1,2,x", "8.5,1,2,3", "7,,,", "99,1e400,1,1", "99,1"]
    return before + lines[first:last + 1] + after


class TwoLogs(Case):
    """A whole log and one that was cut, each in a folder of its own."""

    bytes_out = True

    def setUp(self):
        super().setUp()
        for name in ("whole", "cut"):
            (self.folder / name).mkdir()

    def write(self, side, lines, name="log.csv", end="\n"):
        (self.folder / side / name).write_bytes(end.join([*lines, ""]).encode())

    def said(self, side, *words, **more):
        return self.good(*words, cwd=self.folder / side, **more).stdout

    def result(self, side, *words, **more):
        """The JSON without what names the input and the range, and what was left out."""
        result = json.loads(self.said(side, *words, **more))
        for command in "command", "check", "take_commands", "runner_up_commands":
            result.pop(command, None)
        for one in result["inputs"]:
            one.pop("sha256", None)
        recordings = [result["recording"]] if "recording" in result else result["recordings"]
        return result, [one.pop("rows_outside", None) for one in recordings]

    def law(self, words, limits, name="log.csv", **more):
        """The same of the whole log with a range, and of the log that was cut; returns what was left out."""
        words = [str(word).replace("{}", name) for word in words]
        found, outside = self.result("whole", *words, *limits, **more)
        expected, nothing = self.result("cut", *words, **more)
        self.assertEqual(found, expected)
        self.assertEqual(set(nothing), {None})
        for output in {"out.csv", "out.npy"} & set(words):
            self.assertEqual((self.folder / "whole" / output).read_bytes(), (self.folder / "cut" / output).read_bytes())
        return outside[0]

    def info_and_filter(self, limits, name="log.csv", read=(), out="out.csv"):
        self.law(["info", "{}", "--json", *read], limits, name)
        return self.law(["filter", "{}", *METHOD, "-o", out, "--json", "--force", *read], limits, name)


class Law(TwoLogs):
    def test_every_command_says_what_it_says_of_the_cut_log(self):
        head, *rows = (DATA / "paper_move_2s.csv").read_text().splitlines()
        self.write("whole", [head, *spoilt(rows, 300, 2600)])
        self.write("cut", [head, *rows[300:2601]])
        for name, words in LAWS.items():
            with self.subTest(name):
                outside = self.law(words, ["--from", "300ms", "--to", "2.6"])
                self.assertEqual(outside, {"before": 103, "after": 5, "from_s": 0.3, "to_s": 2.6, "zero_s": 0.0})

    def test_the_help_of_every_command_names_both(self):
        for name, words in LAWS.items():
            text = self.said("whole", words[0], "--help-all").decode()
            for option in ("--from TIME", "--to TIME"):
                self.assertIn(option, text, name)

    def test_stamps_in_another_unit_are_met_exactly(self):
        rows = [f"{1000 + k};{1 + k % 3},5;{k},25" for k in range(3000)]
        self.write("whole", ["time_ms;velocity_deg_s;torque_nm", *rows], end="\r\n")
        for at in range(1001, 3990, 331):
            written = self.said("whole", "filter", "log.csv", "--method", "none", "--from", at / 1000, "--to", (at + 2) / 1000)
            self.assertEqual(written.decode().split("\r\n")[1:-1], rows[at - 1000:at - 997])

    def test_text_of_many_kinds(self):
        rows = motion(1500)
        read_as = {
            "quoted": (HEAD, [f'"{k / 1000}",{v:.3f},"{t:.4f}",{p:.4f}' for k, v, t, p in rows], []),
            "comments": (HEAD, [line for row in rows for line in (plain(*row), "# so far", "")], []),
            "two columns of time": ("sec,nanosec,velocity_deg_s,torque_nm",
                                    [f"0,{k}000000,{v:.3f},{t:.4f}" for k, v, t, _ in rows], []),
            "time last, by place": ("", [f"{v:.3f} {t:.4f}  {k / 1000}" for k, v, t, _ in rows],
                                    ["--columns", "velocity,torque,time", "--no-header"]),
        }
        for name, (head, lines, read) in read_as.items():
            with self.subTest(name):
                each, head = len(lines) // len(rows), [head] if head else []
                self.write("whole", [*head, *lines])
                self.write("cut", [*head, *lines[300 * each:1201 * each]])
                outside = self.info_and_filter(["--from", "0.3", "--to", "1.2"], read=read)
                self.assertEqual((outside["before"], outside["after"]), (300, 299))

    def test_arrays(self):
        for rows, side in ((motion(1500), "whole"), (motion(1500)[300:1201], "cut")):
            self.write(side, [HEAD, *(plain(*row) for row in rows)])
            self.said(side, "filter", "log.csv", "--method", "none", "-o", "log.npy")
        for out in ("out.csv", "out.npy"):
            outside = self.info_and_filter(["--from", "0.3", "--to", "1.2"], "log.npy", out=out)
            self.assertEqual((outside["before"], outside["after"]), (300, 299))
        self.law(["spectrum", "{}", "--segment", "0.2s", "--json"], ["--from", "0.3", "--to", "1.2"], "log.npy")
        piped = self.said("whole", "filter", "-", *METHOD, "--output-format", "npy", "--from", "0.3", "--to", "1.2",
                          stdin=(self.folder / "whole" / "log.npy").read_bytes())
        self.assertEqual(piped, (self.folder / "cut" / "out.npy").read_bytes())

    def test_every_joint(self):
        head = "time_s,j1_velocity_deg_s,j1_torque_nm,j2_velocity_deg_s,j2_torque_nm"
        rows = [f"{k / 1000},{v:.3f},{t:.4f},{-v:.3f},{-t:.4f}" for k, v, t, _ in motion(1500)]
        self.write("whole", [head, *rows])
        self.write("cut", [head, *rows[300:1201]])
        limits = ["--from", "0.3", "--to", "1.2"]
        for words in (["info", "{}", "--json"], ["info", "{}", "--joint", "j2", "--json"]):
            self.law(words, limits)
        words = ["filter", "log.csv", "--joint", "all", *METHOD]
        self.assertEqual(self.said("whole", *words, *limits), self.said("cut", *words))


class Paths(TwoLogs):
    def test_pipes_threads_and_files_give_the_same_bytes(self):
        cells = [row[row.index(","):] + "," + "0" * 60 for row in (plain(*each) for each in motion(3000))]
        rows = [f"{k / 1000}{cells[k % 3000]}" for k in range(60000)]
        self.write("whole", [HEAD + ",note", *rows])
        self.write("cut", [HEAD + ",note", *rows[1500:58001]])
        whole = (self.folder / "whole" / "log.csv").read_bytes()
        self.assertGreater(len(whole), 5 << 20)  # threads start behind 4 MiB
        limits = ["--from", "1.5", "--to", "58"]
        expected = self.said("cut", "filter", "log.csv", *METHOD)
        for threads in (1, 2, 4):
            self.assertEqual(self.said("whole", "filter", "log.csv", *METHOD, *limits, "--threads", threads), expected)
        self.assertEqual(self.said("whole", "filter", "-", *METHOD, *limits, stdin=whole), expected)


class Clocks(TwoLogs):
    """What hours and minutes mean, and where the zero is."""

    def test_plain_times_count_minutes_from_zero(self):
        rows = [f"{100 + k / 10},{k % 7},{k % 5}" for k in range(600)]
        self.write("whole", ["time_s,velocity_deg_s,torque_nm", *rows])
        for at, seconds in (("1:50", 110), ("01:50.0", 110), ("0:01:50", 110), ("110s", 110), ("1.9min", 114), ("110000ms", 110)):
            written = self.said("whole", "filter", "log.csv", "--method", "none", "--from", at, "--to", "2:00")
            self.assertEqual(written.decode().splitlines()[1:], rows[10 * (seconds - 100):201], at)

    def log_of_stamps(self, stamp, head="time"):
        head = f"{head},velocity_deg_s,torque_nm,position_deg"
        rows = [f"{stamp(k)},{v:.3f},{t:.4f},{p:.4f}" for k, v, t, p in motion(4000)]
        self.write("whole", [head, *rows])
        self.write("cut", [head, *rows[1500:2501]])

    def test_times_of_day(self):
        self.log_of_stamps(lambda k: f"12:{29 + (57500 + k) // 60000:02}:{(57500 + k) // 1000 % 60:02}.{(57500 + k) % 1000:03}")
        for start, end in (("12:29:59", "12:30"), ("12:29:59.0", "12:30:00.000"), ("44999", "45000s")):
            outside = self.info_and_filter(["--from", start, "--to", end])
            self.assertEqual(outside, {"before": 1500, "after": 1499, "from_s": 44999.0, "to_s": 45000.0, "zero_s": 0.0})

    def test_dates_count_from_their_first_second_and_say_so(self):
        self.log_of_stamps(lambda k: f"2024-05-01T14:29:{50 + k // 1000:02}.{k % 1000:03}+02:00")
        for start, end in (("14:29:51.5", "14:29:52.5"), ("1.5", "2.5"), ("2024-05-01T12:29:51.5Z", "2024-05-01T14:29:52.5")):
            outside = self.info_and_filter(["--from", start, "--to", end])
            self.assertEqual(outside, {"before": 1500, "after": 1499, "from_s": 1.5, "to_s": 2.5, "zero_s": 1.0})
        self.assertIn(b"times count from 1 s", self.said("whole", "info", "log.csv", "--from", "1.5"))

    def test_counts_since_1970(self):
        self.log_of_stamps(lambda k: 1714566600123456789 + 1000000 * k, "timestamp_ns")
        outside = self.info_and_filter(["--from", "0:01.5", "--to", "2.5"])
        self.assertEqual((outside["before"], outside["zero_s"]), (1500, 1.5))

    def test_a_stated_rate_counts_rows(self):
        self.log_of_stamps(lambda k: k % 13, "note")
        outside = self.info_and_filter(["--from", "1.5", "--to", "2.5"], read=["--sample-rate", "1kHz"])
        self.assertEqual((outside["before"], outside["after"], outside["zero_s"]), (1500, 1499, 1.5))
