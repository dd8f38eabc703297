# SPDX-License-Identifier: MIT
"""ripplenotch spectrum --map as users meet it: Campbell diagram and order map as numbers."""

import csv
import io
import json
import pathlib

from commands import DATA, Case, ended, run

MOVE = str(DATA / "paper_move_2s.csv")


def spectrum(*words):
    return run("spectrum", *words)


class Maps(Case):
    def cells(self, *words):
        done = ended(0, spectrum(*words))
        table = list(csv.reader(io.StringIO(done.stdout)))
        rows = {}
        for speed, where, amplitude in table[1:]:
            rows.setdefault(float(speed), []).append((float(where), float(amplitude)))
        return table[0], rows

    def test_orders_stay_in_their_column_of_an_order_map(self):
        header, rows = self.cells(MOVE, "--map", "order", "--gear-ratio", "100", "--resolution", "0.25",
                                  "--highest", "4")
        self.assertEqual(header, ["speed_deg_s", "order", "amplitude_nm"])
        for cells in rows.values():
            where, amplitude = max((c for c in cells if c[0] > 0.5), key=lambda c: c[1])
            self.assertAlmostEqual(where, 1.0, delta=0.09)
            self.assertAlmostEqual(amplitude, 0.8, delta=0.06)  # a bin's offset of 0.04 orders costs up to 4 %

    def test_without_a_ratio_orders_are_those_of_the_output(self):
        header, rows = self.cells(MOVE, "--map", "order", "--resolution", "10", "--highest", "300")
        self.assertEqual(header[1], "order_output")
        for cells in rows.values():
            where, _ = max((c for c in cells if c[0] > 50), key=lambda c: c[1])
            self.assertAlmostEqual(where, 100.0, delta=4.0)

    def test_a_log_at_one_speed_is_one_row_of_its_frequencies(self):
        header, rows = self.cells(str(DATA / "paper_90deg_s.csv"), "--map", "campbell", "--resolution", "1.5")
        self.assertEqual(header[1], "frequency_hz")
        self.assertEqual(len(rows), 1)
        where, amplitude = max(next(iter(rows.values())), key=lambda c: c[1])
        self.assertAlmostEqual(where, 25.0, delta=0.5)
        self.assertAlmostEqual(amplitude, 0.8, delta=0.01)

    def test_a_resolution_that_the_log_cannot_give_is_not_pretended(self):
        done = ended(0, spectrum(MOVE, "--map", "order", "--gear-ratio", "100", "--resolution", "0.001", "--highest", "4", "--json"))
        result = json.loads(done.stdout)
        self.assertEqual((result["schema"], result["domain"]), ("ripplenotch/spectrum/1", "order-map"))
        self.assertAlmostEqual(result["resolution"], 1.5 / 50, delta=0.002)  # the move is 50 motor turns
        self.assertIn("instead of 0.001", done.stderr)
        for row in result["rows"]:
            self.assertEqual(len(row["amplitude_nm"]), len(result["axis_values"]))

    def test_the_orders_of_a_joint_file_are_the_lines_of_the_figure(self):
        joint, figure = f"{self.folder}/joint.json", f"{self.folder}/map.json"
        logs = [str(DATA / f"paper_{speed}deg_s.csv") for speed in (60, 120, 180)]
        self.good("identify", *logs, "-o", joint, "-q")
        for words, orders in ((["--joint-file", joint], [1, 2]), (["--gear-ratio", "100"], [1, 2]),
                              (["--gear-ratio", "100", "--orders", "1,2,3,4"], [1, 2, 3, 4]),
                              ([], [])):
            for kind, scale in (("campbell", 100 / 360), ("order", 1)):
                ended(0, spectrum(MOVE, "--map", kind, "--highest", "5", *words, "-o", f"{self.folder}/map.csv",
                             "--plot", figure, "--force"))
                result = json.loads(pathlib.Path(figure).read_text())
                lines = result["panels"][0]["lines"]
                self.assertEqual([line["name"] for line in lines], [f"order {n}" for n in orders])
                for line, order in zip(lines, orders, strict=True):
                    self.assertAlmostEqual(line["value"], order * scale, delta=2e-5)
                names = [entry["name"] for entry in result["inputs"]]
                self.assertEqual(names, [MOVE, joint] if "--joint-file" in words else [MOVE])

    def test_a_joint_file_that_is_none_is_refused(self):
        ended(3, spectrum(MOVE, "--map", "order", "--joint-file", MOVE), "expected schema \"ripplenotch/joint/1\"")
        ended(2, spectrum(MOVE, "--joint-file", "joint.json"), "belong to --map and --track")

    def test_requests_that_make_no_sense_are_refused(self):
        for words, part in ((["--resolution", "1"], "--map"), (["--map", "waterfall"], "campbell"),
                            (["--map", "order", "--bins"], "--bins"),
                            (["--map", "order", "--resolution", "0"], "above 0")):
            done = spectrum(MOVE, *words)
            self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
            self.assertIn(part, done.stderr)
        ended(3, spectrum(str(DATA / "paper_rest.csv"), "--map", "campbell"), "does not move")
