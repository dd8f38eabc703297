# SPDX-License-Identifier: MIT
"""One run of `identify`, and what its answer says. The only place that knows the names of the JSON."""

import json
import os
import re
import resource
import subprocess

TURNING = ("order", "unknown")


class Failed(Exception):
    pass


class Answer:
    def __init__(self, result, seconds):
        self.json, self.seconds = result, seconds
        self.verdict, self.conclusive, self.finding = result["verdict"], result["conclusive"], result["finding"]
        self.lines = [line for line in result["lines"] if line["kind"] in TURNING]
        self.tones = [line for line in result["lines"] if line["kind"] not in TURNING]
        self.ratio = result["gear_ratio"]["value"]
        self.interval = result["gear_ratio"]["ci95"]
        self.rivals = sorted(((rival["probability"] if "probability" in rival else rival["score"], rival["value"])
                              for rival in result["gear_ratio"]["candidates"]), reverse=True)

    def says_nothing(self):
        return self.finding == "nothing" and self.conclusive and not self.lines

    def searched(self):
        """The lowest and the highest order searched; None where the answer does not say."""
        stated = self.json.get("searched")
        return (stated["lowest_order"], stated["highest_order"]) if stated and stated["lowest_order"] is not None else None

    def bound_nm(self):
        """X of "no line above X Nm"; None where the answer gives none. From the verdict where the JSON has no range yet."""
        stated = self.json.get("searched")
        if stated and stated.get("detectable_nm") is not None:
            return stated["detectable_nm"]
        found = re.search(r"no line above ([0-9.e+-]+) Nm", self.verdict)
        return float(found[1]) if found else None

    def bound_at(self, order):
        """X of an order; None where it was not searched or no bound is given."""
        stated = self.json.get("searched") or {}
        if not (self.searched() and stated["lowest_order"] <= order <= stated["highest_order"]):
            return None
        within = [band["detectable_nm"] for band in stated.get("bounds") or [] if band["from_order"] <= order]
        return within[-1] if within else self.bound_nm()

    def near(self, order, tolerance):
        """The first line that is of this order; None without."""
        return next((line for line in self.lines if line["order_output"] is not None and abs(line["order_output"] - order) <= tolerance), None)



def identify(program, *texts, words=()):
    """Answer for logs given as CSV texts. Raises Failed where the program ends with an error."""
    descriptors = []
    for text in texts:
        descriptors.append(os.memfd_create("log"))
        view = memoryview(text.encode())
        while view:
            view = view[os.write(descriptors[-1], view):]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run([program, "identify", "--json", "-q", "--format", "csv", "--side", "joint", *words,
                               *(f"/proc/self/fd/{descriptor}" for descriptor in descriptors)],
                              capture_output=True, text=True, pass_fds=descriptors, timeout=120)
    finally:
        for descriptor in descriptors:
            os.close(descriptor)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 5):
        raise Failed(f"exit {done.returncode}: {done.stderr.strip()[-200:]}")
    return Answer(json.loads(done.stdout), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
