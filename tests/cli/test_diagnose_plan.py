# SPDX-License-Identifier: MIT
"""diagnose --plan: what is written and told, and what is refused."""

import json

from commands import Case

JOINT = "--gear-ratio 100 --inertia 0.4 --ripple 1:0.7Nm:30deg --effect coulomb-friction,torque_nm=0.5,width_deg_s=0.2".split()
ONE_WAY = ("--motion constant,speed=40deg/s,duration=3s --motion ramp,from-speed=40deg/s,to-speed=90deg/s,duration=1s "
           "--motion constant,speed=90deg/s,duration=3s").split()
LIMITS = "speed=2rad/s,acceleration=6rad/s^2,range=-100deg:1rad"


class Plan(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "model.json").write_text(json.dumps({
            "schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [{"effect": "inertia"}, {"effect": "ripple", "order": 1}]}))

    def run_tool(self, *words, code=0):
        done = super().run_tool(*words)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def logged(self, moves, name):
        self.run_tool("simulate", *JOINT, *moves, "--sample-rate", "500Hz", "--noise", "0.05Nm", "--velocity-noise", "0.1deg/s", "--seed", 3, "-o",
                      name)

    def planned(self, log, *words, code=0):
        return self.run_tool("diagnose", log, "--model", "model.json", "--plan", "plan.csv", "--limits", LIMITS, *words, code=code)

    def test_rows_keep_within_the_limits_and_are_those_that_simulate_makes_of_the_words(self):
        self.logged(ONE_WAY, "log.csv")
        told = self.planned("log.csv", "--json", "--improved-model", "improved.xml").stdout
        (self.folder / "told.json").write_text(told)
        self.run_tool("report", "told.json", "-o", "told.html")
        plan = json.loads(told)["plan"]
        self.assertEqual((plan["file"], plan["decides"]), ("plan.csv", True))
        self.assertLessEqual({"coulomb-friction", "offset"}, {one["effect"] for one in plan["questions"] if one["open"]})
        rows = [list(map(float, row.split(","))) for row in (self.folder / "plan.csv").read_text().splitlines()[1:]]
        self.assertEqual(len(rows), 500 * plan["duration_s"])
        self.assertLessEqual(max(abs(v) for _, _, v in rows), 114.6)
        self.assertGreaterEqual(min(q for _, q, _ in rows), -100.0)
        self.assertLessEqual(max(q for _, q, _ in rows), 57.3)
        for (t, _, v), (later, _, faster) in zip(rows, rows[1:]):
            self.assertLessEqual(abs(faster - v) / (later - t), 343.8)
        moves = [word for words in plan["motions"] for word in ("--motion", words)]
        self.logged(moves, "along.csv")
        again = [row.split(",") for row in (self.folder / "along.csv").read_text().splitlines()]
        place = again[0].index("position_deg")
        for row, other in zip(rows, again[1:]):
            self.assertAlmostEqual(row[1], float(other[place]), 6)
        done = json.loads(self.planned("along.csv", "--json", "--force").stdout)
        # What was asked is decided; friction may still be of one kind or of another.
        self.assertNotIn("offset", done["named"] + [name for tie in done["ambiguous"] for name in tie["effects"]])

    def test_nothing_open_nothing_written(self):
        self.logged(["--motion", "poly6,to=90deg,duration=2s", "--motion", "rest,duration=0.5s", "--motion", "poly6,to=-30deg,duration=3s"], "log.csv")
        self.assertIn("plan: no open question of this log would be decided by a motion", self.planned("log.csv").stdout)
        self.assertFalse((self.folder / "plan.csv").exists())

    def test_what_is_no_limit_is_refused_before_the_log_is_read(self):
        for limits, words in (("speed=90deg/s,acceleration=300deg/s2", "range"), ("speed=90deg/s,acceleration=300,range=0:9", "'300' is not in deg/s2"),
                              ("speed=90deg/s,acceleration=-3deg/s2,range=0:9", "not above 0"), ("speed=90deg/s,acceleration=3deg/s2,range=9", "1 positions"),
                              ("speed=90deg/s,acceleration=3deg/s2,range=9:9", "range"), ("speed=9Nm,acceleration=3deg/s2,range=0:9", "speed")):
            done = self.run_tool("diagnose", "none.csv", "--model", "model.json", "--plan", "p.csv", "--limits", limits, code=2)
            self.assertIn(words, done.stderr, limits)
        self.assertIn("--limits is missing", self.run_tool("diagnose", "none.csv", "--model", "model.json", "--plan", "p.csv", code=2).stderr)
        self.assertIn("--plan is missing", self.run_tool("diagnose", "none.csv", "--model", "model.json", "--limits", LIMITS, code=2).stderr)
        self.assertIn("with --arm or --simulated", self.planned("none.csv", "--simulated", "column,name=tau", code=2).stderr)
        self.assertIn("put {joint} into the name", self.planned("none.csv", "--joint", "all", code=2).stderr)
