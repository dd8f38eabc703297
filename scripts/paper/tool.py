# SPDX-License-Identifier: MIT
"""Runs the tool in a folder of its own; numbers, columns and tables as text."""

import array
import ast
import csv
import io
import json
import math
import subprocess


class Tool:
    """The tool in a scratch folder, in which all files live by plain names."""

    def __init__(self, binary, folder):
        self.binary, self.folder = str(binary), folder

    def text(self, *words, stdin=None):
        """Standard output of a command; raises with its standard error unless it ends with 0."""
        done = subprocess.run([self.binary, *map(str, words)], cwd=self.folder, input=stdin, capture_output=True,
                              text=True, timeout=300)
        if done.returncode != 0:
            raise RuntimeError(f"ripplenotch {' '.join(map(str, words))}\nexit {done.returncode}: {done.stderr}")
        return done.stdout

    def json(self, *words):
        return json.loads(self.text(*words, "--json"))

    def log(self, *words):
        """A command that writes a log on standard output, as {column: [numbers]}."""
        return columns(self.text(*words))

    def torque(self, *words):
        """The torque of a log that a command writes as .npy, which is read faster than text."""
        done = subprocess.run([self.binary, *map(str, words), "--output-format", "npy"], cwd=self.folder,
                              capture_output=True, timeout=300)
        if done.returncode != 0:
            raise RuntimeError(f"ripplenotch {' '.join(map(str, words))}\nexit {done.returncode}: {done.stderr.decode()}")
        return torque_of(done.stdout)

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return name


def torque_of(content):
    """The torque of a log in .npy."""
    length = int.from_bytes(content[8:10], "little")
    head = ast.literal_eval(content[10:10 + length].decode("latin1"))
    place = [name for name, _ in head["descr"]].index("torque_nm")
    numbers = array.array("d", content[10 + length:])
    return list(numbers[place::len(head["descr"])])


def columns(text):
    rows = csv.reader(io.StringIO(text))
    names = next(rows)
    return {name: list(map(float, cells)) for name, cells in zip(names, zip(*rows))}


def csv_text(names, rows):
    """Rows of text or None (an empty cell), one line each."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(["" if cell is None else cell for cell in row] for row in rows)
    return out.getvalue()


def markdown(names, rows):
    lines = ["| " + " | ".join(names) + " |", "| " + " | ".join("---" for _ in names) + " |"]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def fixed(value, decimals):
    """Text with so many decimals, without the sign of a zero."""
    text = f"{value:.{decimals}f}"
    return text[1:] if text.startswith("-") and float(text) == 0.0 else text


def rms(values):
    return math.sqrt(math.fsum(v * v for v in values) / len(values))


def error(signal, truth):
    return rms([a - b for a, b in zip(signal, truth)])


def peak_to_peak(values):
    return max(values) - min(values)


def delay_samples(signal, truth, most=300):
    """The delay, in samples to a fraction of one, at which the truth is nearest to the signal in least squares."""
    def misfit(delay):
        inner = range(20, len(signal) - 20 - most)
        return math.fsum((signal[k + delay] - truth[k]) ** 2 for k in inner)
    at, known = 0, {}
    cost = lambda d: known.setdefault(d, misfit(d))
    for step in (64, 16, 4, 1):
        moved = True
        while moved:
            moved = False
            for other in (at - step, at + step):
                if -19 <= other <= most and cost(other) < cost(at):
                    at, moved = other, True
    before, here, after = cost(at - 1), cost(at), cost(at + 1)
    curve = before - 2.0 * here + after
    return at + (0.5 * (before - after) / curve if curve > 0.0 else 0.0)
