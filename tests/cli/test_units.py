# SPDX-License-Identifier: MIT
"""Never a unit by default: each spelling of a unit and each form of one log is read right, or asked about with a remedy
that works; nothing is wrong with exit code 0."""

import json
import math
import re

from commands import SOURCE, Case, ended

CASES = [SOURCE.parent / "shared" / folder for folder in ("cases", "cases-4")]
RATE, AMPLITUDE = 250.0, 0.8
DEG = math.pi / 180.0
ROWS = 2000


def rows():
    """8 s to and fro at 30 deg/s, a ripple of 0.8 Nm at order 1 of a gear of 100."""
    position = 5.0
    for k in range(ROWS):
        t = k / RATE
        speed = 0.0 if t < 0.3 else 30.0 if t < 4.0 else -30.0
        position += speed / RATE
        yield t, speed, 5.0 + AMPLITUDE * math.cos(100.0 * position * DEG), position


LOG = list(rows())


def table(names, time=1.0, speed=1.0, torque=1.0, position=1.0, delimiter=",", decimal=".", cell=None, digits=9):
    """The log under these names, as numbers times these factors; a name for the time, speed, torque and position."""
    lines = [delimiter.join(names)] if names else []
    for row in LOG:
        cells = [f"{value * factor:.{digits}g}" for value, factor in zip(row, (time, speed, torque, position))]
        if cell:
            cells = cell(cells)
        lines.append(delimiter.join(one.replace(".", decimal) for one in cells[:len(names) or 4]))
    return "\n".join(lines) + "\n"


def four(torque="torque_Nm"):
    return ["time_s", "velocity_deg_s", torque, "position_deg"]


KGF, LBF = 9.80665, 4.4482216152605
# As it is written, and what 1 Nm is in it; None: no factor is known, and it is asked about.
TORQUES = [("Nm", 1), ("nm", 1), ("N.m", 1), ("N*m", 1), ("N-m", 1), ("N·m", 1), ("N_m", 1), ("N m", 1), ("newton_meters", 1),
           ("mNm", 1e3), ("uNm", 1e6), ("µNm", 1e6), ("cNm", 1e2), ("kNm", 1e-3), ("Nmm", 1e3), ("N.mm", 1e3), ("N_mm", 1e3),
           ("N.cm", 1e2), ("Ncm", 1e2), ("ozf.in", 16 / LBF / 0.0254), ("ozin", 16 / LBF / 0.0254),
           ("oz_in", 16 / LBF / 0.0254), ("lbf.in", 1 / LBF / 0.0254), ("in_lb", 1 / LBF / 0.0254),
           ("lbf.ft", 1 / LBF / 0.3048), ("ft_lbf", 1 / LBF / 0.3048), ("kgf.cm", 100 / KGF), ("kgf_cm", 100 / KGF),
           ("kgf.m", 1 / KGF), ("A", 1), ("mA", 1e3), ("V", None), ("percent", None), ("permille", None), ("adc", None),
           ("counts", None), ("stone", None)]


class Reading(Case):
    def read(self, text, *words, name="log.csv"):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return self.run_tool("identify", name, "--gear-ratio", "100", "--json", "-q", *words)

    def amplitude(self, done):
        """Of order 1."""
        lines = json.loads(done.stdout)["lines"]
        return max((line["amplitude_nm"] for line in lines), default=None)


class Units(Reading):
    def test_each_spelling_of_a_torque(self):
        for unit, per_nm in TORQUES:
            for name in (f"tau_{unit}", f"torque [{unit}]", f"motor torque ({unit})"):
                with self.subTest(name=name):
                    done = self.read(table(four(name), torque=per_nm or 1.0))
                    if per_nm is not None:
                        self.assertEqual(done.returncode, 0, done.stderr)
                        self.assertAlmostEqual(self.amplitude(done), AMPLITUDE, delta=0.01)
                        continue
                    self.assertEqual((done.returncode, done.stdout), (5, ""), done.stderr)
                    self.assertIn("--scale torque=0.04Nm", done.stderr)
                    self.assertAlmostEqual(self.amplitude(self.read(table(four(name)), "--scale", "torque=0.04Nm")),
                                           0.04 * AMPLITUDE, delta=0.001)
                    self.assertEqual(self.run_tool("info", "log.csv").returncode, 0)
        for unit in ("ozf.in", "kgf.cm", "N.mm"):
            text = table(four("torque"), torque=dict(TORQUES)[unit])
            self.assertAlmostEqual(self.amplitude(self.read(text, "--unit", f"torque={unit}")), AMPLITUDE, delta=0.01)
        stated = self.read(table(four("torque_stone")), "--unit", "torque=Nm")
        self.assertAlmostEqual(self.amplitude(stated), AMPLITUDE, delta=0.01)

    def test_each_form_of_the_log(self):
        for name, text in FORMS.items():
            with self.subTest(form=name):
                done = ended(0, self.read(text, name="log" + ("." + name.split(".")[1] if "." in name else ".csv")))
                self.assertAlmostEqual(self.amplitude(done), AMPLITUDE, delta=0.01)

    def test_forms_that_are_asked_about(self):
        for name, (text, words, asked) in ASKED.items():
            with self.subTest(form=name):
                done = self.read(text)
                said = done.stderr if done.returncode else json.dumps(json.loads(done.stdout)["doubts"])
                self.assertTrue(done.returncode in (3, 5) or not json.loads(done.stdout)["conclusive"], name)
                self.assertIn(asked, said)
                done = ended(0, self.read(text, *words))
                self.assertAlmostEqual(self.amplitude(done), AMPLITUDE, delta=0.01)

    def right(self, text):
        done = self.read(text)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertAlmostEqual(self.amplitude(done), AMPLITUDE, delta=0.01)

    def test_a_unit_in_the_cells(self):
        self.right(table(four(), cell=lambda c: [c[0], c[1] + " deg/s", *c[2:]]))
        self.right(table(["time_s", "velocity", "torque", "position"], torque=1e3, cell=lambda c: [
            c[0], c[1] + " deg/s", f"{float(c[2]):.3f}mNm", c[3] + " deg"]))

    def test_a_cell_in_another_unit_than_its_column_is_refused(self):
        rows = table(four("torque"), cell=lambda c: [c[0], c[1], c[2] + " Nm", c[3]]).split("\n")
        rows[1900] = rows[1900].replace("Nm", "mNm")
        done = self.read("\n".join(rows))
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("log.csv:1901:", done.stderr)

    def test_a_unit_in_the_cells_of_a_torque_stays_there(self):
        (self.folder / "log.csv").write_text(table(four("torque"), cell=lambda c: [c[0], c[1], c[2] + " Nm", c[3]]))
        done = self.run_tool("filter", "log.csv", "--method", "lowpass,cutoff=20Hz", "-o", "out.csv", "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        written = (self.folder / "out.csv").read_text().splitlines()
        self.assertEqual(len(written), ROWS + 1)
        self.assertTrue(all(row.split(",")[2].endswith(" Nm") for row in written[1:]), written[1])

    def test_the_exponent_of_fortran(self):
        self.right(table(four(), cell=lambda c: [f"{float(x):.9e}".replace("e", "D") for x in c]))

    def test_a_minus_of_typesetters(self):
        self.right(table(four(), cell=lambda c: [x.replace("-", "\u2212") for x in c]))

    def test_thousands_with_separators(self):
        self.right(table(four("torque_mNm"), torque=1e3, delimiter=";", cell=lambda c: [c[0], c[1], f"{float(c[2]):,.3f}", c[3]]))


class Names(Reading):
    def test_of_several_torques_the_sensor_is_read_where_names_say_so(self):
        def extra(cells):
            return [*cells[:4], f"{0.9 * float(cells[2]):.6f}"]

        for word, other in (("sm", "torque_2_Nm"), ("measured", "torque_2_Nm"), ("sensor", "torque_rne_2_Nm")):
            head = ["time_s", "velocity_2_deg_s", f"torque_{word}_2_Nm", "position_2_deg", other]
            done = ended(0, self.read(table(head, cell=extra)))
            self.assertAlmostEqual(self.amplitude(done), AMPLITUDE, delta=0.01)
        done = self.read(table(["time_s", "velocity_2_deg_s", "torque_foo_2_Nm", "position_2_deg", "torque_2_Nm"], cell=extra))
        self.assertEqual((done.returncode, "--columns torque=torque_foo_2_Nm" in done.stderr), (3, True), done.stderr)

    def test_a_current_is_never_read_beside_a_torque_in_silence(self):
        done = self.read(table(["time_s", "velocity_deg_s", "torque [stone]", "position_deg", "current_A"],
                               cell=lambda c: [*c[:4], "0.5"]))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("--columns torque=current_A", done.stderr)

    def test_names_are_read_in_time_linear_in_the_columns(self):
        names = ["time_s", *(f"j{j}_{what}" for j in range(166) for what in ("q", "dq", "tau"))]
        text = ",".join(names) + "\n" + "".join(
            ",".join([f"{0.01 * k:.2f}", *(f"{(k * c) % 97 / 97:.2f}" for c in range(1, len(names)))]) + "\n" for k in range(100))
        (self.folder / "wide.csv").write_text(text)
        self.assertIn("166 joints", self.run_tool("info", "wide.csv").stdout)
        ended(0, self.run_tool("identify", "wide.csv", "--joint", "j7"))


def remedies(text):
    """The options that a message names, without those that leave a name to be filled in."""
    found = re.findall(r"(--[a-z]+(?:-[a-z]+)*) ([^\s;)]*[^\s;,.)])", text)
    return [pair for pair in found if not re.search(r"NAME|UNIT|FILE|COLUMN", pair[1])]


class Remedies(Case):
    """What a refusal prints ends in an answer."""

    # One signal of a log each, and a simulation's signal alone.
    PARTS = {"split_position.csv", "split_velocity.csv", "split_torque.csv", "late5.csv.gz", "late50.csv.gz", "other.csv.gz"}

    def follow(self, path):
        """The exit code when no remedy is left, and what was said."""
        command = "diagnose" if path.name.startswith("friction") else "identify"
        words, said = [], []
        for _ in range(6):
            done = self.run_tool(command, path, *words, "-q")
            said.append(done.stderr.strip())
            fresh = [pair for pair in remedies(done.stderr) if pair[0] == "--scale" or pair[0] not in words]
            if done.returncode == 0 or not fresh:
                return done.returncode, said
            for pair in dict.fromkeys(fresh):
                words += pair if pair == fresh[0] or fresh[0][0] == pair[0] == "--scale" else ()
        return done.returncode, said

    def test_every_remedy_of_the_cases_is_followed_to_an_answer(self):
        logs = [path for folder in CASES if folder.is_dir() for path in sorted(folder.iterdir())
                if re.search(r"\.(csv|txt|lvm)(\.gz)?$", path.name) and path.name not in self.PARTS]
        if not logs:
            self.skipTest("no ../shared/cases")
        for path in logs:
            with self.subTest(log=path.name):
                code, said = self.follow(path)
                self.assertEqual(code, 0, "\n".join(said))


def lvm(units):
    head = ("LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
            "Multi_Headings\tNo\nX_Columns\tOne\nTime_Pref\tAbsolute\n***End_of_Header***\t\n\t\nChannels\t3\t\t\t\n"
            f"Samples\t{ROWS}\t{ROWS}\t{ROWS}\t\n" + (f"Y_Unit_Label\t{units}\t\n" if units else "")
            + "X_Dimension\tTime\tTime\tTime\t\nX0\t0.0\t0.0\t0.0\t\nDelta_X\t0.004\t0.004\t0.004\t\n***End_of_Header***\t\t\t\t\n")
    names = ["X_Value", "Velocity", "Torque", "Position"] if units else ["X_Value", "Velocity (deg/s)", "Torque (Nm)", "Position (deg)"]
    body = table([*names, "Comment"], delimiter="\t")
    return head + body


def times(form):
    return lambda cells: [form(float(cells[0])), *cells[1:]]


# Forms that test_log_dialects.py has not.
FORMS = {
    "comment above": "# bench 3\n# today\n" + table(four()),
    "quoted names": table([f'"{name}"' for name in four()]),
    "brackets": table(["Time [s]", "Speed [deg/s]", "Torque [Nm]", "Angle [deg]"]),
    "parentheses": table(["Time (s)", "Speed (deg/s)", "Torque (Nm)", "Angle (deg)"]),
    "slashes": table(["t / s", "omega / deg/s", "tau / Nm", "phi / deg"]),
    "capitals": table(["Time [s]", "speed [deg/s]", "torqueNm", "posDeg"]),
    "measured in brackets": table(["Time (s)", "Speed (measured) [deg/s]", "Torque (measured) [Nm]", "Angle [deg]"]),
    "milliradians": table(["time_s", "velocity_mrad_s", "torque_Nm", "position_mrad"], speed=1e3 * DEG, position=1e3 * DEG),
    "turns": table(["time_s", "velocity_turns_per_s", "torque_Nm", "position_turns"], speed=1 / 360, position=1 / 360),
    "rpm as a name": table(["time_s", "rpm", "torque_Nm", "position_deg"], speed=1 / 6),
    "U/min": table(["Zeit [s]", "Drehzahl [U/min]", "Moment [Nm]", "Winkel [Grad]"], speed=1 / 6),
    "1/min": table(["Zeit [s]", "n_ist Drehzahl [1/min]", "Drehmoment [Nm]", "Lage [°]"], speed=1 / 6),
    "German": table(["Uhrzeit [s]", "Geschwindigkeit [Grad/s]", "Abtriebsmoment [Nm]", "Position [Grad]"]),
    "German compounds": table(["Zeit_s", "Abtriebsdrehzahl_rpm", "Abtriebsdrehmoment_Nm", "Abtriebswinkel_deg"], speed=1 / 6),
    "German actual values": table(["Zeit_ms", "Geschwindigkeitsistwert_deg_s", "Momentenistwert_Nm", "Lageistwert_deg"], time=1e3),
    "French": table(["temps (s)", "vitesse (deg/s)", "couple (Nm)", "position (deg)"]),
    "French turns": table(["temps [s]", "vitesse [tr/min]", "couple mesuré [N.m]", "angle [°]"], speed=1 / 6),
    "microseconds": table(["time_us", *four()[1:]], time=1e6, digits=12),
    "microseconds by rule": table(["time", *four()[1:]], time=1e6, digits=12),
    "nanoseconds": table(["stamp_ns", *four()[1:]], time=1e9, digits=14),
    "minutes": table(["time [min]", *four()[1:]], time=1 / 60, digits=14),
    "hours": table(["time [h]", *four()[1:]], time=1 / 3600, digits=14),
    "days": table(["time [days]", *four()[1:]], time=1 / 86400, digits=15),
    "date of a spreadsheet": table(["Time", *four()[1:]], cell=times(lambda t: f"{45000.25 + t / 86400:.12f}")),
    "date of MATLAB": table(["Time", *four()[1:]], cell=times(lambda t: f"{739000.25 + t / 86400:.11f}")),
    "seconds in the cells": table(["Time", *four()[1:]], cell=times(lambda t: f"{t:.3f} sec")),
    "milliseconds in the cells": table(["Time", *four()[1:]], cell=times(lambda t: f"{1e3 * t:g} ms")),
    "German dates": table(["Zeit", *four()[1:]], cell=times(lambda t: f"1.5.2024 12:30:{t:06.3f}")),
    "row of units in brackets": table(["time", "velocity", "torque", "position"], torque=1e3).replace(
        "\n", "\n[s],[deg/s],[mNm],[deg]\n", 1),
    "LabVIEW, names with units": lvm(""),
    "exponents": table(four(), cell=lambda c: [f"{float(x):.8e}" for x in c]),
    "signs": table(four(), cell=lambda c: [x if x[0] == "-" else "+" + x for x in c]),
    "a joint in the names": table(["time_s", "j2_velocity_deg_s", "j2_torque_Nm", "j2_position_deg"]),
    "elements": table(["time_s", "velocity_deg_s[2]", "torque_Nm[2]", "position_deg[2]"]),
    "a motor's name": table(["time_s", "joint_velocity_deg_s", "motor_torque_Nm", "joint_position_deg"]),
}

# What is asked about, with the words that answer and a piece of the question.
ASKED = {
    "no units": (table(["time", "velocity", "torque", "position"]), ["--unit", "velocity=deg/s,position=deg"], "--unit velocity="),
    "no names, exponents": (table([], delimiter="   ", cell=lambda c: [f"{float(x):.6e}" for x in c]),
                            ["--columns", "time,velocity,torque,position", "--unit", "velocity=deg/s,position=deg"],
                            "--columns time,velocity,torque"),
    "pipe": (table(four(), delimiter="|"), ["--delimiter", "|"], "--delimiter"),
    "no time": (table(["velocity_deg_s", "torque_Nm"], cell=lambda c: c[1:3]), ["--sample-rate", "250Hz"], "--sample-rate"),
    "a bench in the name": (table(four("torque_bench")), ["--unit", "torque=Nm"], "--unit torque=Nm"),
    "counts": (table(["time_s", "velocity [inc/s]", "torque_Nm", "position [inc]"], speed=100, position=100),
               ["--scale", "velocity=1deg/s/100", "--scale", "position=1deg/100"], "--scale velocity="),
    "days from zero": (table(["time", *four()[1:]], time=1 / 86400, digits=15), ["--unit", "time=d"], "--unit time=d"),
}
