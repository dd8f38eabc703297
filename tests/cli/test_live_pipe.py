# SPDX-License-Identifier: MIT
"""A log that arrives while it is written: how much of it `filter` waits for, and that the clock on the wall does not matter."""

import math
import select
import subprocess
import time
import unittest

from commands import TOOL

FILTER = [TOOL, "filter", "-", "--method", "lowpass,cutoff=13rad/s", "-q"]
OPENING_ROWS = 16384
STATED = ["--unit", "velocity=rad/s,position=rad"]


def rows(count, bare, rest=0):
    """The text of a log at 1 kHz, in degrees with units or in radians without; at rest at first."""
    unit, position, lines = math.pi / 180 if bare else 1.0, 0.0, []
    for k in range(count):
        velocity = 0.0 if k < rest else 80 * math.sin(0.0008 * (k - rest))
        position += velocity / 1000
        torque = 5 + 0.8 * math.cos(math.radians(100 * position))
        lines.append(f"{k / 1000:.3f},{velocity * unit:.6f},{torque:.6f},{position * unit:.6f}\n")
    return ["t,dq,tau_J,q\n" if bare else "time_s,velocity_deg_s,torque_nm,position_deg\n", *lines]


class LivePipe(unittest.TestCase):
    def first_output(self, lines, *options):
        """After how many lines something came out, while the pipe stayed open; none if nothing did."""
        with subprocess.Popen([*FILTER, *options], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            for first in range(0, len(lines), 2048):
                run.stdin.write("".join(lines[first:first + 2048]).encode())
                run.stdin.flush()
                if select.select([run.stdout], [], [], 0.1 if first < OPENING_ROWS else 0.5)[0]:
                    run.kill()
                    return first + 2048
            run.kill()
        return None

    def test_output_begins_after_the_opening_where_units_are_stated(self):
        for name, lines, options in (("in the header", rows(40000, False), []), ("by option", rows(40000, True), STATED),
                                     ("velocity alone", [",".join(line.split(",")[:3]) + "\n" for line in rows(40000, False)], [])):
            with self.subTest(name):
                after = self.first_output(lines, *options)
                self.assertIsNotNone(after)
                self.assertGreaterEqual(after, OPENING_ROWS)
                self.assertLessEqual(after, OPENING_ROWS + 3 * 2048)

    def test_without_units_more_of_the_log_is_awaited(self):
        with subprocess.Popen(FILTER, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as tool:
            tool.stdin.write("".join(rows(40000, True)).encode())
            tool.stdin.flush()
            self.assertEqual(select.select([tool.stdout], [], [], 2.0)[0], [])
            tool.kill()

    def test_the_same_bytes_however_slowly_they_come(self):
        logs = [rows(30000, bare, rest=200) for bare in (False, True)]
        slow = [subprocess.Popen(FILTER, stdin=subprocess.PIPE, stdout=subprocess.PIPE) for _ in logs]
        for begin, end in ((0, 200), (200, 17000)):
            for tool, lines in zip(slow, logs):
                tool.stdin.write("".join(lines[begin:end]).encode())
                tool.stdin.flush()
            time.sleep(0.7)
        for tool, lines in zip(slow, logs):
            at_once = subprocess.run(FILTER, input="".join(lines).encode(), capture_output=True, check=True).stdout
            self.assertEqual(tool.communicate("".join(lines[17000:]).encode())[0], at_once)
