# SPDX-License-Identifier: MIT
"""Commands killed at random moments: a result is there whole or not at all, what was there before stays, the spool of a
pipe is gone, and what is left behind stands in nobody's way."""

import pathlib
import random
import signal
import tempfile
import time

from prove_trust.outcome import Row
from prove_trust.workshop import Workshop

LONG_ROUND = 1000  # kills, all commands together
ROWS = 300_000
CAUGHT = ("TERM", "INT", "HUP", "PIPE", "QUIT", "XCPU", "ALRM", "USR1")


def whole_or_nothing(shop, names, before, after):
    """A sentence about each file that is neither as before nor as after a run that was let alone."""
    now = shop.contents(names)
    return [f"{name} is neither whole nor as before" for name in names
            if now.get(name) not in (before.get(name), after[name])]


class Killer:
    def __init__(self, shop, seed, settings=None):
        self.shop, self.random, self.settings = shop, random.Random(seed), settings
        self.undisturbed = {}  # by command: what it writes, and how long it takes

    def learn(self, name):
        words, outputs = self.shop.commands()[name]
        if name not in self.undisturbed:
            self.shop.put_old_file()
            start = time.monotonic()
            done = self.shop.run(*words, settings=self.settings)
            took = time.monotonic() - start
            if done.returncode != 0:
                raise SystemExit(f"prove-trust: {words}: {done.stderr.decode()}")
            self.undisturbed[name] = self.shop.contents(outputs), took
            self.shop.remove(outputs)
        return words, outputs, *self.undisturbed[name]

    def kill(self, name, number):
        """One kill by signal `number`; sentences about what is wrong afterwards."""
        words, outputs, whole, took = self.learn(name)
        self.shop.remove(outputs)
        self.shop.put_old_file()
        before = self.shop.contents(outputs)
        running = self.shop.start(*words, settings=self.settings)
        moment = self.random.uniform(0.0, 1.1 * took)
        try:
            running.wait(moment)
        except Exception:  # still at it: that is the usual case
            running.send_signal(number)
        code = running.wait()
        self.shop.close_pipes()
        wrong = whole_or_nothing(self.shop, outputs, before, whole)
        if code not in (0, -number):
            wrong.append(f"ended with {code}")
        litter = self.shop.litter(outputs)
        named = (self.settings or {}).get("FAULT_NAMELESS")
        if litter and (number != signal.SIGKILL or not named):
            wrong.append(f"left {', '.join(litter)}")
        self.shop.remove(outputs)
        again = self.shop.run(*words, settings=self.settings)
        self.shop.close_pipes()
        if again.returncode != 0 or self.shop.contents(outputs) != whole:
            wrong.append(f"the run after it gave {again.returncode}: {again.stderr.decode()[:200]}")
        self.shop.remove([*outputs, *litter])
        return [f"{' '.join(words)}: {number.name} after {moment * 1000:.1f} ms: {sentence}" for sentence in wrong]


def round_of(killer, name, signals, kills, until):
    row = Row(f"`{name}`", 0, 0.0, "outputs complete or unchanged, no other file, the next run works")
    start = time.monotonic()
    while row.runs < kills and time.monotonic() < until:
        row.findings += killer.kill(name, signals[row.runs % len(signals)])
        row.runs += 1
    row.seconds = time.monotonic() - start
    return row


def prove(options):
    rows = []
    every = [signal.SIGKILL] + [getattr(signal, f"SIG{name}") for name in CAUGHT]
    end = time.monotonic() + (options.seconds or 3600.0)
    with tempfile.TemporaryDirectory() as folder:
        shop = Workshop(pathlib.Path(options.tool).resolve(), options.source, folder, ROWS)
        killer = Killer(shop, options.seed)
        names = list(shop.commands())
        for at, name in enumerate(names):
            share = (end - time.monotonic()) / (len(names) - at)
            # Half of them by the signal that nobody can catch.
            signals = [number for caught in every[1:] for number in (every[0], caught)]
            rows.append(round_of(killer, name, signals, LONG_ROUND // len(names), time.monotonic() + share))
        # What a slow command was not killed in its time, the quickest is killed more often.
        at = min(range(len(rows)), key=lambda at: rows[at].seconds / max(rows[at].runs, 1))
        more = round_of(killer, names[at], signals, LONG_ROUND - sum(row.runs for row in rows), end)
        rows[at] = Row(more.what, rows[at].runs + more.runs, rows[at].seconds + more.seconds, more.checked, rows[at].findings + more.findings)
    return rows
