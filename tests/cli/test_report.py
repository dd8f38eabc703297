# SPDX-License-Identifier: MIT
"""ripplenotch report: pages as a browser without a network sees them."""

import html.parser
import json
import os
import re
import shutil
import subprocess
import time
import unittest

from commands import DATA, SOURCE, SharedCase, good, new_folder, run

PLOTLY = SOURCE / "scripts/report-assets/node_modules/plotly.js-cartesian-dist-min/plotly-cartesian.min.js"
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

needs_browser = unittest.skipUnless(BROWSER and PLOTLY.is_file(), "SKIPPED: there is no Chromium or no plotly.js here")


class Pages(SharedCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        os.symlink(DATA, cls.folder / "data")
        for command in (
                "identify data/paper_60deg_s.csv data/paper_120deg_s.csv data/paper_180deg_s.csv --json -o joint.json",
                "design joint.json --speed 18:180:18 --json -o table.json",
                "filter data/paper_move_2s.csv --method switching,table=table.json -o out.csv --metrics metrics.json --plot torque.json",
                "spectrum data/paper_90deg_s.csv -o s.csv --plot spectrum.json",
                "spectrum data/paper_move_2s.csv --map campbell --gear-ratio 100 -o m.csv --plot campbell.json",
                "compare --step 10Nm --ramp 20Nm/s --speed 90deg/s --sample-rate 1kHz --gear-ratio 100 --orders 1,2 "
                "--method lowpass,cutoff=13Hz --json -o comparison.json --plot responses.json"):
            good(*command.split(), cwd=cls.folder)

    RESULTS = ["joint.json", "table.json", "metrics.json", "torque.json", "spectrum.json", "campbell.json",
               "comparison.json", "responses.json"]

    def page(self, *words):
        done = run("report", *words, "-q", "-o", "page.html", "--force", cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return (self.folder / "page.html").read_text()

    def open(self, name):
        """The page as Chromium leaves it, what it said on the console, and every address it asked for."""
        profile = new_folder(self)
        log = profile / "net.json"
        began = time.monotonic()
        done = subprocess.run(
            [BROWSER, "--headless=new", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}/p",
             "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
             "--host-resolver-rules=MAP * ~NOTFOUND", f"--log-net-log={log}", "--enable-logging=stderr",
             "--virtual-time-budget=8000", "--dump-dom", f"file://{self.folder / name}"],
            capture_output=True, timeout=120)
        took = time.monotonic() - began
        console = [line for line in done.stderr.decode("utf-8", "replace").splitlines() if "CONSOLE" in line]
        asked = re.findall(r'"url":"(\w+:[^"]*)"', log.read_text()) if log.is_file() else []
        ours = [url for url in asked if not re.match(r"(chrome|devtools|data|blob|about)", url)
                and "google" not in url and "gvt1" not in url]
        return done.stdout.decode(), console, ours, took

    @needs_browser
    def test_every_plot_is_drawn_without_a_network_and_without_a_complaint(self):
        html_text = self.page(*self.RESULTS)
        drawn, console, asked, took = self.open("page.html")
        self.assertEqual(console, [])
        self.assertEqual([url for url in asked if not url.startswith("file:")], [])
        figures = [json.loads(text) for text in
                   re.findall(r'data-figure="[^"]*">(.*?)</script>', html_text)]
        self.assertEqual(len(figures), 6)
        for number, figure in enumerate(figures, 1):
            place = re.search(rf'<div class="plot[^>]*id="figure-{number}"[^>]*>', drawn)[0]
            self.assertIn(f'data-drawn="{len(figure["data"])}"', place)
            points = sum(len(trace["x"]) for trace in figure["data"])
            self.assertIn(f'data-points="{points}"', place)
            for name, axis in figure["layout"].items():
                if re.fullmatch(r"[xy]axis\d*", name):
                    for line in axis["title"]["text"].replace("&#37;", "%").split("<br>"):
                        self.assertIn(line, drawn)
        self.assertLess(took, 20.0)

    @needs_browser
    def test_hostile_names_are_text_in_the_browser(self):
        hostile = "<img src=x onerror=document.title='pwned'> <b>bold %{x} `q`.csv"
        os.symlink(DATA / "paper_90deg_s.csv", self.folder / hostile)
        done = run("spectrum", hostile, "-o", "h.csv", "--plot", "hostile.json", "--force", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.page("hostile.json")
        drawn, console, asked, _ = self.open("page.html")
        self.assertNotIn("<img src=x", drawn)
        self.assertNotIn("<title>pwned", drawn)
        self.assertEqual(console, [])
        self.assertIn("&lt;b&gt;bold", drawn)

    @needs_browser
    def test_a_page_of_two_million_samples_is_small_and_opens_at_once(self):
        log = self.folder / "long.npy"
        if not log.exists():
            done = run("simulate", "--gear-ratio", "100", "--ripple", "1:0.8Nm", "--motion",
                       "constant,speed=90deg/s,duration=2000s", "--sample-rate", "1kHz", "--noise", "0.05Nm", "-o", log)
            self.assertEqual(done.returncode, 0, done.stderr)
        done = run("filter", log, "--method", "lowpass,cutoff=13Hz", "-o", self.folder / "long_out.npy", "--plot",
                   self.folder / "long.json", "--force")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.page("long.json")
        self.assertLess((self.folder / "page.html").stat().st_size, 8_000_000)
        drawn, console, _, took = self.open("page.html")
        self.assertEqual(console, [])
        self.assertIn("data-drawn", drawn)
        self.assertLess(took, 20.0)  # with the start of the browser, on a busy machine

    def test_the_same_results_give_the_same_bytes(self):
        words = self.RESULTS
        self.assertEqual(self.page(*words), self.page(*words))

    def test_a_page_is_well_formed_and_names_what_made_each_result(self):
        text = self.page(*self.RESULTS)

        class Balance(html.parser.HTMLParser):
            stack, void = [], {"meta", "img", "br", "link", "input"}

            def handle_starttag(self, tag, _):
                if tag not in self.void:
                    self.stack.append(tag)

            def handle_endtag(self, tag):
                assert self.stack.pop() == tag, tag

        parser = Balance()
        parser.feed(text)
        self.assertEqual(parser.stack, [])
        for part in ("ripplenotch design joint.json --speed 18:180:18", "Ripple at orders 1 and 2", "attenuation, dB",
                     "gear ratio value", "Ripple lines and gear ratio", "order 1: centre, Hz", "order 1: Q",
                     '<td class="words">lowpass, cutoff 13Hz</td>', "Content-Security-Policy", "viewport"):
            self.assertIn(part, text)
        if not PLOTLY.is_file():
            self.assertNotIn("http", text.replace("http-equiv", ""))

    def test_a_log_becomes_a_page_of_all_that_is_asked_of_it(self):
        good("simulate", "--gear-ratio", "100", "--ripple", "1:0.8Nm", "--ripple", "2:0.5Nm", "--motion",
             "ramp,from-speed=20deg/s,to-speed=65deg/s,duration=6s", "--sample-rate", "500Hz", "--noise", "0.05Nm", "--seed", "3",
             "-o", "moving.csv", cwd=self.folder)
        page = self.page("moving.csv")
        titles = re.findall(r'<h2 id="result-\d+"[^>]*>([^<]*)', page)
        self.assertEqual(titles[:3], ["moving.csv", "Which ripple, and which gear", "Which method, and why"])
        self.assertEqual(titles[-2:], ["What the log does not show", "How the log was read"])
        lead = page[:page.index("Which ripple, and which gear</h2>")]
        self.assertLess(lead.index("<figure>"), lead.index("Use "))
        self.assertRegex(lead, r"(?s)<th>order</th><th>before, Nm</th><th>after, Nm</th>.*<td>2</td>")
        self.assertRegex(lead, r"<pre>ripplenotch filter moving\.csv .*</pre><button")
        self.assertRegex(lead, r"<pre>ripplenotch export .*</pre><button")
        self.assertNotIn(str(self.folder), page)
        self.assertEqual(self.page("moving.csv"), page)  # no temporary names in it
        self.assertNotIn("ripplenotch-report", page)
        done = run("report", "data/paper_move_2s.csv", "--unit", "velocity=furlong", cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        done = run("report", "data/paper_move_2s.csv", "joint.json", cwd=self.folder)
        self.assertEqual((done.returncode, "a report is one of logs, or one of results" in done.stderr), (2, True))
        done = run("data/paper_move_2s.csv", cwd=self.folder)
        self.assertEqual((done.returncode, "ripplenotch report data/paper_move_2s.csv" in done.stderr), (2, True), done.stderr)

    def test_a_pipe_several_logs_several_joints_and_rest_have_a_page(self):
        log = (DATA / "paper_60deg_s.csv").read_text()
        done = run("report", "-", "-q", cwd=self.folder, stdin=log)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("<h1>standard input</h1>", done.stdout)
        self.assertIn("<pre>ripplenotch filter log.csv ", done.stdout)
        page = self.page("data/paper_60deg_s.csv", "data/paper_120deg_s.csv")
        self.assertRegex(page, r"(?s)<td[^>]*>paper_60deg_s.csv</td>.*<td[^>]*>paper_120deg_s.csv</td>.*Which ripple")
        rows = [line.split(",") for line in (DATA / "paper_move_2s.csv").read_text().split()]
        names = ["time_s", *(f"j{joint}_{name}" for joint in (1, 2) for name in rows[0][1:])]
        (self.folder / "two.csv").write_text("\n".join(",".join(row) for row in [names] + [row + row[1:] for row in rows[1:]]))
        self.assertRegex(self.page("two.csv"), r"(?s)The joints.*<td[^>]*>j1</td>.*<td[^>]*>j2</td>.*>j1</h2>.*>j2</h2>")
        self.assertRegex(self.page("two.csv", "--joint", "j2,j1"), r"(?s)The joints.*<td[^>]*>j1</td>.*<td[^>]*>j2</td>.*>j1</h2>.*>j2</h2>")
        os.mkfifo(self.folder / "fifo")
        with subprocess.Popen(["cp", DATA / "paper_60deg_s.csv", self.folder / "fifo"]):
            self.assertIn("<h1>fifo</h1>", self.page("fifo"))
        self.assertIn("record motion in one direction at several speeds", self.page("data/paper_rest.csv"))
