# SPDX-License-Identifier: MIT
"""The Python module against the program: the same numbers, bit for bit, the same messages; and the page about it."""

import csv
import doctest
import importlib.metadata
import json
import os
import pathlib
import sys
import threading
import unittest
import warnings

from commands import DATA, SOURCE, Case, new_folder

MODULE = pathlib.Path(os.environ["RIPPLENOTCH_MODULE"])
if not MODULE.is_dir():
    print("SKIPPED: the Python module was not built: apt-get install pybind11-dev python3-dev, then -DRIPPLENOTCH_PYTHON=ON")
    sys.exit(77)
try:
    import numpy
except ImportError:
    print(f"SKIPPED: the Python module needs NumPy, which {sys.executable} has not: apt-get install python3-numpy")
    sys.exit(77)

sys.path.insert(0, str(MODULE))
import ripplenotch  # noqa: E402

STEADY = [DATA / f"paper_{speed}deg_s.csv" for speed in (60, 90, 120, 180)]
MOVE = DATA / "paper_move_2s.csv"
GEAR = ("--gear-ratio", "100")


def column(text, name):
    """A column of CSV as the nearest doubles of its digits."""
    return numpy.array([float(row[name]) for row in csv.DictReader(text.splitlines())])


class ModuleCase(Case):
    def setUp(self):
        super().setUp()
        catcher = warnings.catch_warnings(record=True)
        self.warned = catcher.__enter__()
        self.addCleanup(catcher.__exit__, None, None, None)
        warnings.simplefilter("always")

    def result(self, *words):
        """What the program prints with --json."""
        return self.good(*words, "--json").stdout

    def same(self, array, expected):
        self.assertEqual(array.dtype, numpy.float64)
        numpy.testing.assert_array_equal(array, expected, strict=True)

    def arrays(self, path=MOVE):
        log = ripplenotch.read(path)
        return {"time_s": log.time_s, "velocity_deg_s": log.velocity_deg_s, "torque_nm": log.torque_nm, "position_deg": log.position_deg}

    def as_npy(self, arrays, name="arrays.npy"):
        table = numpy.empty(len(arrays["time_s"]), dtype=[(key, float) for key in arrays])
        for key in arrays:
            table[key] = arrays[key]
        numpy.save(self.folder / name, table)
        return name


class Read(ModuleCase):
    def test_a_log_is_what_stands_in_the_file(self):
        log = ripplenotch.read(MOVE)
        text = MOVE.read_text()
        for name in ("time_s", "velocity_deg_s", "torque_nm", "position_deg"):
            self.same(getattr(log, name), column(text, name))
            self.assertFalse(getattr(log, name).flags.writeable)
        self.assertEqual((log.sample_rate_hz, log.torque_unit, log.joint, log.joints, log.path), (1000.0, "Nm", "", [""], str(MOVE)))

    def test_arrays_outlive_their_log(self):
        torque = ripplenotch.read(MOVE).torque_nm
        self.same(torque, column(MOVE.read_text(), "torque_nm"))

    def test_options_are_those_of_the_commands(self):
        (self.folder / "plain.txt").write_text("".join(f"{0.01 * k} {1000 * k}\n" for k in range(300)))
        log = ripplenotch.read(self.folder / "plain.txt", columns=["velocity", "torque"], unit={"velocity": "rad/s"},
                               scale={"torque": "0.001Nm"}, sample_rate="500Hz", no_header=True, from_="0.1s")
        self.assertEqual((log.sample_rate_hz, len(log), log.position_deg), (500.0, 250, None))
        self.assertEqual(log.torque_nm[-1], 299.0)
        self.assertEqual(log.velocity_deg_s[-1], 2.99 * (180.0 / numpy.pi))

    def test_one_joint_of_several(self):
        path = DATA / "dialects" / "named_joints.csv"
        with self.assertRaisesRegex(ripplenotch.DataError, "--joint"):
            ripplenotch.read(path)
        names = json.loads(self.result("info", path))["joints"]
        first, log = (ripplenotch.read(path, joint=one["joint"]) for one in names)
        self.assertEqual((log.joint, log.joints), (names[1]["joint"], [one["joint"] for one in names]))
        self.assertNotEqual(log.torque_nm.tolist(), first.torque_nm.tolist())

    def test_motion_of_the_motor_is_divided_by_the_ratio(self):
        joint = ripplenotch.read(MOVE)
        motor = ripplenotch.read(MOVE, side="motor", gear_ratio=50)
        numpy.testing.assert_allclose(motor.velocity_deg_s, joint.velocity_deg_s / 50, rtol=1e-14)


class Equal(ModuleCase):
    """Results are the bytes that the program prints for the same words."""

    def test_identify(self):
        found = ripplenotch.identify([ripplenotch.read(path) for path in STEADY], gear_ratio=100)
        text = self.result("identify", *STEADY, *GEAR)
        self.assertEqual(found.to_json(), text)
        self.assertEqual(found.to_dict(), json.loads(text))
        ratio = json.loads(text)["gear_ratio"]
        self.assertEqual(found.gear_ratio, (ratio["value"], ratio["stderr"], tuple(ratio["ci95"])))
        self.assertEqual((found.verdict, found.conclusive, found.lines), tuple(json.loads(text)[name] for name in ("verdict", "conclusive", "lines")))
        self.assertEqual(ripplenotch.identify(STEADY, gear_ratio=100).to_json(), text)

    def test_identify_of_arrays(self):
        arrays = self.arrays()
        text = self.result("identify", self.as_npy(arrays))
        expected = json.loads(text)
        expected.pop("command")  # it would name a file that is gone
        self.assertEqual(ripplenotch.identify(arrays).to_dict(), expected)
        self.assertEqual(ripplenotch.identify(numpy.load(self.folder / "arrays.npy")).to_dict(), expected)
        # The numbers are those of the file that the arrays were read from.
        of_file, of_arrays = ripplenotch.identify(MOVE).to_dict(), json.loads(text)
        for name in ("lines", "gear_ratio", "verdict", "searched"):
            self.assertEqual(of_arrays[name], of_file[name])

    def test_design(self):
        found = ripplenotch.identify(STEADY)
        (self.folder / "joint.json").write_text(found.to_json())
        text = self.result("design", "joint.json", "--speed", "18:180:18", "--q", "0.25")
        self.assertEqual(ripplenotch.design(found, speed=(18, 180, 18), q=0.25).to_json(), text)
        self.assertEqual(ripplenotch.design(found.to_dict(), speed=(18, 180, 18), q=0.25)["bands"], json.loads(text)["bands"])
        text = self.result("design", *GEAR, "--orders", "1,2", "--sample-rate", "1kHz", "--bands", "18:36,36:60")
        table = ripplenotch.design(gear_ratio=100, orders=[1, 2], sample_rate="1kHz", bands=[(18, 36), (36, 60)])
        self.assertEqual(table.to_json(), text)
        self.assertEqual(table.bands, json.loads(text)["bands"])

    def test_filter(self):
        log = ripplenotch.read(MOVE)
        table = ripplenotch.design(ripplenotch.identify(STEADY), speed=(18, 180, 18))
        (self.folder / "table.json").write_text(table.to_json())
        for words, options in ((("--method", "switching,table=table.json"), {"table": table}),
                               (("--method", "lowpass,cutoff=13rad/s,order=1"), {"method": "lowpass,cutoff=13rad/s,order=1"}),
                               (("--method", "tracking,q=1", *GEAR, "--orders", "1,2"), {"method": "tracking,q=1", "gear_ratio": 100, "orders": [1, 2]}),
                               (("--method", "oscillator", *GEAR), {"method": "oscillator", "gear_ratio": 100})):
            expected = column(self.good("filter", MOVE, *words, "-q").stdout, "torque_nm")
            self.same(ripplenotch.filter(log, **options), expected)
            self.same(ripplenotch.filter(MOVE, **options), expected)
            self.same(ripplenotch.filter(self.arrays(), **options), expected)
        self.same(ripplenotch.filter(log, table=table.to_dict()), ripplenotch.filter(log, table=self.folder / "table.json"))
        with self.assertRaisesRegex(ripplenotch.UsageError, "expected one of them"):
            ripplenotch.filter(log, "none", table=table)

    def test_filter_of_a_numpy_file_is_in_newton_metres(self):
        arrays = self.arrays()
        arrays["tau_mNm"] = arrays.pop("torque_nm") * 1000
        self.as_npy(arrays, "milli.npy")
        filtered = ripplenotch.filter(self.folder / "milli.npy", "lowpass,cutoff=13rad/s,order=1")
        numpy.testing.assert_allclose(filtered, ripplenotch.filter(MOVE, "lowpass,cutoff=13rad/s,order=1"), rtol=0, atol=1e-14)
        self.same(ripplenotch.filter(ripplenotch.read(self.folder / "milli.npy"), "lowpass,cutoff=13rad/s,order=1"), filtered)

    def test_diagnose(self):
        text = self.result("diagnose", MOVE, "--model", "auto")
        answer = ripplenotch.diagnose(ripplenotch.read(MOVE))
        self.assertEqual(answer.to_json(), text)
        self.assertEqual((answer.verdict, answer.named), (json.loads(text)["verdict"], json.loads(text)["named"]))
        model = DATA / "paper_model.json"
        self.assertEqual(ripplenotch.diagnose(MOVE, model).to_json(), self.result("diagnose", MOVE, "--model", model))
        (self.folder / "model.json").write_text(json.dumps(json.loads(model.read_text())))
        self.assertEqual(ripplenotch.diagnose(MOVE, json.loads(model.read_text())).to_json(), self.result("diagnose", MOVE, "--model", "model.json"))

    def test_any_command(self):
        self.assertEqual(ripplenotch.run("spectrum", MOVE, domain="order").to_json(), self.result("spectrum", MOVE, "--domain", "order"))
        self.assertEqual(ripplenotch.help("filter"), self.good("filter", "--help").stdout)


    def test_recommend_and_report(self):
        self.assertEqual(ripplenotch.recommend(MOVE).to_json(), self.result("recommend", MOVE))
        advice = ripplenotch.recommend(self.arrays())
        self.assertEqual(advice.method, ripplenotch.recommend(MOVE).method)
        self.assertEqual({"command", "check", "take_commands"} & set(advice.to_dict()), set())  # the file of the arrays is gone
        page = ripplenotch.report(MOVE)
        for part in ("<h1>paper_move_2s.csv</h1>", advice.verdict, "<button"):
            self.assertIn(part, page)

    def test_columns_of_other_names_and_texts_beside_them(self):
        arrays = self.arrays()
        other = {"time_s": arrays["time_s"], "velocity_rad_s": numpy.radians(arrays["velocity_deg_s"]), "torque_nm": arrays["torque_nm"],
                 "position_deg": arrays["position_deg"], "temperature": arrays["time_s"], "state": ["run"] * len(arrays["time_s"])}
        self.assertAlmostEqual(ripplenotch.identify(other).gear_ratio.value, ripplenotch.identify(arrays).gear_ratio.value, places=6)
        numpy.testing.assert_allclose(ripplenotch.filter(other, "lowpass,cutoff=13rad/s,order=1"),
                                      ripplenotch.filter(arrays, "lowpass,cutoff=13rad/s,order=1"), atol=1e-12)

    def test_a_simulation_is_an_array(self):
        arrays = self.arrays()
        simulated = arrays["torque_nm"] - 0.4 * numpy.sign(arrays["velocity_deg_s"])
        (self.folder / "sim.csv").write_text("time_s,torque_nm\n" + "".join(f"{t!r},{tau!r}\n" for t, tau in zip(
            arrays["time_s"].tolist(), simulated.tolist())))
        expected = json.loads(self.result("diagnose", MOVE, "--simulated", "file=sim.csv,column=torque_nm", "--gear-ratio", "100"))
        for log in arrays, MOVE, ripplenotch.read(MOVE):
            answer = ripplenotch.diagnose(log, simulated=simulated, gear_ratio=100)
            self.assertEqual((answer.named, answer["gap"]), (expected["named"], expected["gap"]))

    def test_plot(self):
        panels = ripplenotch.plot("spectrum", MOVE, domain="order")
        self.assertEqual([(panel.y_label, panel.y_log, panel.map) for panel in panels], [("amplitude, zero to peak, Nm", True, None)])
        name, x, y = panels[0].curves[0]
        self.assertEqual((name, x.shape, round(x[y.argmax()])), ("torque", y.shape, 100))
        x, y, cells = ripplenotch.plot("spectrum", MOVE, map="campbell")[0].map
        self.assertEqual(cells.shape, (len(y) - 1, len(x) - 1))


class Messages(ModuleCase):
    def refused(self, error, message, call, *arguments, **options):
        with self.assertRaises(error) as caught:
            call(*arguments, **options)
        self.assertRegex(str(caught.exception), message)
        self.assertNotIn(os.sep + "ripplenotch-", str(caught.exception))

    def test_what_the_program_refuses_is_raised_with_its_message(self):
        short = {name: values[:40] for name, values in self.arrays().items()}
        self.refused(ripplenotch.DataError, "^arrays.npy: 40 samples, at least 64", ripplenotch.identify, short)
        self.refused(ripplenotch.FileError, "^no.csv: cannot open", ripplenotch.read, "no.csv")
        self.refused(OSError, "^no.csv: cannot open", ripplenotch.filter, "no.csv", "lowpass,cutoff=5Hz")
        self.refused(ripplenotch.UsageError, r"^there is no option --joind \(did you mean --joint\?\)", ripplenotch.read, MOVE, joind="j1")
        self.refused(ripplenotch.UsageError, r"^there is no option --gear-ration \(did you mean --gear-ratio\?\)", ripplenotch.identify, MOVE, gear_ration=100)
        self.refused(ValueError, "swiching", ripplenotch.filter, MOVE, "swiching")
        self.refused(ripplenotch.UsageError, "standard input", ripplenotch.identify, "-")
        self.refused(ripplenotch.LimitViolated, "max-delay", ripplenotch.filter, MOVE, "lowpass,cutoff=1Hz,order=1", max_delay="1ms")
        self.refused(ripplenotch.DataError, "result.json", ripplenotch.design, {"verdict": "none"})

    def test_what_is_refused_after_the_work_has_its_result(self):
        rest = DATA / "paper_rest.csv"
        with self.assertRaises(ripplenotch.Inconclusive) as caught:
            ripplenotch.identify(rest, require_conclusive=True)
        verdict = json.loads(self.result("identify", rest))["verdict"]
        self.assertEqual((caught.exception.result.verdict, str(caught.exception)), (verdict, verdict))
        with self.assertRaisesRegex(ripplenotch.LimitViolated, "^band 1 .* delays by") as caught:
            ripplenotch.design(gear_ratio=100, sample_rate="1kHz", speed=(18, 90, 18), q=0.25, max_delay="20ms")
        self.assertEqual(len(caught.exception.result.bands), 4)

    def test_arrays_are_checked(self):
        arrays = self.arrays()
        self.refused(ripplenotch.UsageError, r"torque_nm \(10,\)", ripplenotch.identify, {**arrays, "torque_nm": arrays["torque_nm"][:10]})
        self.refused(ripplenotch.DataError, "torque", ripplenotch.identify, {"time_s": arrays["time_s"], "speed": arrays["time_s"]})
        self.refused(ripplenotch.UsageError, r"simulated: read an array of shape \(10,\), expected \(3000,\)", ripplenotch.diagnose, arrays,
                     simulated=arrays["torque_nm"][:10])

    def test_logs_that_were_read_differently_are_refused_together(self):
        log, part = ripplenotch.read(MOVE), ripplenotch.read(MOVE, to="2s")
        self.refused(ripplenotch.UsageError, "different options", ripplenotch.identify, [log, part])
        self.refused(ripplenotch.UsageError, "different options", ripplenotch.identify, [part, MOVE])
        self.refused(ripplenotch.UsageError, "different options", ripplenotch.diagnose, log, validate=part)
        self.assertEqual(ripplenotch.identify((part, part)).to_json(), self.result("identify", MOVE, MOVE, "--to", "2s"))
        self.assertEqual(ripplenotch.diagnose(part, validate=part)["gap"], json.loads(
            self.result("diagnose", MOVE, "--to", "2s", "--model", "auto", "--validate", MOVE))["gap"])

    def test_several_joints_are_asked_about(self):
        path = DATA / "dialects" / "named_joints.csv"
        self.refused(ripplenotch.Error, "joint", ripplenotch.filter, path, "lowpass,cutoff=5Hz")

    def test_warnings_are_warnings(self):
        arrays = self.arrays()
        arrays["time_s"] = arrays["time_s"] + 0.5 * (numpy.arange(len(arrays["time_s"])) > 1000)
        ripplenotch.identify(arrays)
        self.assertTrue(self.warned)
        for one in self.warned:
            self.assertEqual((one.category, one.filename), (ripplenotch.RipplenotchWarning, __file__))
        self.assertIn("1 gap in the time", str(self.warned[0].message))

    def test_nothing_is_printed(self):
        read, write = os.pipe()
        kept = os.dup(1), os.dup(2)
        try:
            os.dup2(write, 1), os.dup2(write, 2)
            ripplenotch.diagnose(MOVE)
            ripplenotch.filter(MOVE, "lowpass,cutoff=5Hz", gear_ratio=100)
        finally:
            os.dup2(kept[0], 1), os.dup2(kept[1], 2)
        os.close(write)
        with open(read, "rb") as pipe:
            self.assertEqual(pipe.read(), b"")

    def test_a_file_may_change_between_calls_but_not_behind_a_log(self):
        path = self.folder / "log.csv"
        path.write_bytes(STEADY[0].read_bytes())
        log = ripplenotch.read(path)
        path.write_bytes(STEADY[1].read_bytes() + b"4.0,90,0,360\n")
        self.assertNotEqual(ripplenotch.read(path).velocity_deg_s[0], log.velocity_deg_s[0])
        self.refused(ripplenotch.FileError, "read it again", ripplenotch.identify, log)


class Threads(ModuleCase):
    def test_calls_of_several_threads_take_turns_and_let_others_run(self):
        expected = ripplenotch.filter(MOVE, "oscillator", gear_ratio=100)
        found, ticks, ended = [], [], threading.Event()

        def work():  # long enough for the clock to tick many times meanwhile
            for _ in range(10):
                found.append(ripplenotch.filter(MOVE, "oscillator", gear_ratio=100))

        workers = [threading.Thread(target=work) for _ in range(4)]
        for worker in workers:
            worker.start()
        ticker = threading.Thread(target=lambda: [ticks.append(1) for _ in iter(lambda: ended.wait(0.0005), True)])
        ticker.start()
        for worker in workers:
            worker.join()
        ended.set()
        ticker.join()
        self.assertEqual(len(found), 40)
        for one in found:
            self.same(one, expected)
        self.assertGreater(len(ticks), 3)


class Page(unittest.TestCase):
    def test_the_metadata_say_version_and_licence(self):
        metadata = importlib.metadata.metadata("ripplenotch")
        self.assertEqual((metadata["Version"], metadata["License"]), (ripplenotch.__version__, "GPL-2.0-or-later"))
        self.assertEqual(ripplenotch.__license__, metadata["License"])
        self.assertIn("version 2 or later", ripplenotch.__doc__)

    def test_everything_is_documented(self):
        for name in ripplenotch.__all__:
            self.assertTrue(getattr(ripplenotch, name).__doc__, name)

    def test_the_examples_of_the_page_print_what_it_says(self):
        folder = new_folder(self)
        (folder / "data").symlink_to(DATA)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder)
        done = doctest.testfile(str(SOURCE / "docs/python.md"), module_relative=False, optionflags=doctest.NORMALIZE_WHITESPACE)
        self.assertGreater(done.attempted, 8)
        self.assertEqual(done.failed, 0)
