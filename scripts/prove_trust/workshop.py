# SPDX-License-Identifier: MIT
"""What kills and faults work on: a log, a table, and commands that write files."""

import hashlib
import os
import pathlib
import subprocess

GEAR = ("--gear-ratio", "100", "--orders", "1,2")


class Workshop:
    """A folder with a log of `rows` rows, and the commands that are broken on it."""

    def __init__(self, tool, source, folder, rows):
        self.tool, self.folder = str(tool), pathlib.Path(folder)
        self.spool = self.folder / "spool"
        self.spool.mkdir()
        self.cats = []
        self.put_log(pathlib.Path(source) / "data/paper_move_2s.csv", rows)
        table = self.run("design", *GEAR, "--sample-rate", "1kHz", "--speed", "18:180:18", "--json", "-o", "table.json")
        if table.returncode != 0:
            raise SystemExit(f"prove-trust: {table.stderr.decode()}")

    def put_log(self, model, rows):
        """The motion of `model` again and again, its clock going on."""
        head, *lines = model.read_text().splitlines()
        cells = [line.split(",", 1)[1] for line in lines]
        with open(self.folder / "log.csv", "w", encoding="ascii") as log:
            log.write(head + "\n")
            for at in range(0, rows, len(cells)):
                log.writelines(f"{(at + k) / 1000:.3f},{cell}\n" for k, cell in enumerate(cells[:rows - at]))

    def commands(self):
        """Name, words, and the files that the command writes."""
        return {
            "filter": (("filter", "log.csv", "--method", "switching,table=table.json", "-o", "out.csv", "--metrics", "out.json"),
                       ("out.csv", "out.json")),
            "filter, in place of an old file": (("filter", "log.csv", "--method", "switching,table=table.json", "--force", "-o", "old.csv"),
                                                ("old.csv",)),
            "identify": (("identify", "log.csv", "-o", "out.json"), ("out.json",)),
            "spectrum of a pipe": (("spectrum", "--segment", "1s", "-", "--json", "-o", "out.json"), ("out.json",)),
        }

    def run(self, *words, settings=None, timeout=300, **more):
        return subprocess.run([self.tool, *words], cwd=self.folder, env=self.environment(settings), capture_output=True,
                              timeout=timeout, **({"stdin": self.log_as_pipe(words)} | more))

    def close_pipes(self):
        for cat in self.cats:
            cat.stdout.close()
            cat.wait()
        self.cats = []

    def start(self, *words, settings=None):
        return subprocess.Popen([self.tool, *words], cwd=self.folder, env=self.environment(settings),
                                stdin=self.log_as_pipe(words), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def log_as_pipe(self, words):
        if "-" not in words:
            return subprocess.DEVNULL
        self.cats = [cat for cat in self.cats if cat.poll() is None]
        self.cats.append(subprocess.Popen(["cat", str(self.folder / "log.csv")], stdout=subprocess.PIPE))
        return self.cats[-1].stdout

    def environment(self, settings):
        return {**os.environ, "TMPDIR": str(self.spool), **(settings or {})}

    def put_old_file(self):
        (self.folder / "old.csv").write_text("what was there before\n")

    def contents(self, names):
        """SHA-256 of each of the files that is there."""
        found = {}
        for name in names:
            if (self.folder / name).exists():
                found[name] = hashlib.sha256((self.folder / name).read_bytes()).hexdigest()
        return found

    def remove(self, names):
        for name in names:
            (self.folder / name).unlink(missing_ok=True)

    def litter(self, but):
        """Files that nobody asked for."""
        known = {"log.csv", "table.json", "old.csv", "spool", *but}
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*")
                      if str(path.relative_to(self.folder)) not in known)
