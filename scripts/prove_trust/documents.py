# SPDX-License-Identifier: MIT
"""Documents that the tool made, mutated by their structure, and the commands that read them."""

import copy
import json
import pathlib
import random
import resource
import subprocess
import time

LONGEST_S = 2.0
# What a command may end with on a document that nobody would write: it worked, a limit, usage, data, cannot tell.
ALLOWED = {0, 1, 2, 3, 5}
EXTREMES = [0, -0.0, -1, 1, 2, 0.5, 1e-320, 1e-300, 1e99, -1e99, 1e100, 1e300, 2**31, 2**53, 2**63, 2**64, -2**63, 1e18, 255, 1000000]
TEXTS = ["", "nan", "inf", "\u001b]0;x\u0007", "\u009b31m", "\u202eabc", "a\nb", "</script><script>", "%s%n", "x" * 3000, "\u0000", "order"]


def run_tool(tool, folder, *words):
    subprocess.run([tool, *map(str, words)], cwd=folder, check=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                   stderr=subprocess.PIPE, timeout=60)


def make(tool, source, folder):
    """One valid document of each kind in `folder`, and a short log beside them. {kind: text}"""
    folder = pathlib.Path(folder)
    data = pathlib.Path(source, "data")

    def run(*words):
        run_tool(tool, folder, *words)

    run("simulate", "--gear-ratio", "100", "--inertia", "0.3", "--ripple", "1:0.8Nm", "--ripple", "2:0.4Nm:30deg",
        "--effect", "offset,torque_nm=0.4", "--motion", "constant,speed=60deg/s,duration=1s", "--motion",
        "sine,amplitude=40deg,frequency=0.5Hz,duration=3s", "--sample-rate", "500Hz", "--noise", "0.05Nm", "-o", "log.csv", "--force")
    (folder / "base.json").write_text(json.dumps({"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [
        {"effect": "inertia"}, {"effect": "ripple", "order": 1}, {"effect": "ripple", "order": 2}]}))
    logs = sorted(data.glob("paper_*deg_s.csv"))
    made = {
        "joint": ("identify", *logs, "--json", "-o"),
        "table": ("design", "joint.json", "--speed", "18:180:54", "--q", "0.25", "--json", "-o"),
        "diagnosis": ("diagnose", "log.csv", "--model", "base.json", "--improved-model", "model.json", "--json"),
        "info": ("info", "log.csv", "--json", "-o"),
        "spectrum": ("spectrum", "log.csv", "--json", "-o"),
        "track": ("spectrum", "log.csv", "--track", "--gear-ratio", "100", "--orders", "1,2", "--json", "-o"),
        "comparison": ("compare", "--step", "10Nm", "--speed", "90deg/s", "--sample-rate", "1kHz", "--gear-ratio", "100",
                       "--orders", "1,2", "--method", "lowpass,cutoff=13Hz,order=1", "--json", "-o"),
        "effects": ("diagnose", "--effects", "--json"),
        "figure": ("design", "joint.json", "--speed", "18:180:54", "--q", "0.25", "--plot"),
    }
    for kind, words in made.items():
        target = pathlib.Path(folder, f"{kind}.json").name
        if kind in ("diagnosis", "effects"):
            done = subprocess.run([tool, *map(str, words), "--force"], cwd=folder, capture_output=True, timeout=60)
            (folder / target).write_bytes(done.stdout)
        else:
            run_tool(tool, folder, *words, target, "--force")
    run("filter", "log.csv", "--method", "lowpass,cutoff=13Hz,order=1",
        "--gear-ratio", "100", "--orders", "1,2", "-o", "filtered.csv", "--metrics", "metrics.json", "--force")
    kinds = [*made, "model", "metrics"]
    return {kind: (folder / f"{kind}.json").read_text() for kind in kinds}


def places(document, path=()):
    """Every value of a document as the path to it, the document itself first."""
    yield path
    children = document.items() if isinstance(document, dict) else enumerate(document) if isinstance(document, list) else ()
    for key, value in children:
        yield from places(value, (*path, key))


def at(document, path):
    for key in path:
        document = document[key]
    return document


def anything(rng):
    return rng.choice([None, True, False, rng.choice(EXTREMES), rng.choice(TEXTS), [], {}, [[]], [None], {"a": 1}, [1e99, -1e99],
                       [{}], "ripplenotch/table/1", rng.uniform(-1e3, 1e3)])


NEST = "@nest@"  # becomes lists in each other, deeper than Python's own writer goes


def mutate(rng, document, others):
    """A copy with one to four changes."""
    document = copy.deepcopy(document)
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        paths = [path for path in places(document) if path]
        if not paths:
            break
        path = rng.choice(paths)
        holder, key = at(document, path[:-1]), path[-1]
        value = holder[key]
        what = rng.randrange(9)
        if what == 0:
            del holder[key]
        elif what == 1:
            holder[key] = anything(rng)
        elif what == 2 and isinstance(value, (int, float)) and not isinstance(value, bool):
            holder[key] = rng.choice([*EXTREMES, value * 10.0**rng.randint(-12, 12), -value, value + 1])
        elif what == 3 and isinstance(value, list):
            holder[key] = value * rng.choice([2, 10, 500])
        elif what == 4 and isinstance(value, list):
            rng.shuffle(value)
        elif what == 5 and isinstance(holder, dict):
            holder[rng.choice(["x", "schema", str(key) + "_", rng.choice(TEXTS)])] = copy.deepcopy(value)
        elif what == 6:
            donor = rng.choice(others)
            holder[key] = copy.deepcopy(at(donor, rng.choice(list(places(donor)))))
        elif what == 7 and rng.random() < 0.2:
            holder[key] = NEST
        elif isinstance(value, str):
            holder[key] = rng.choice([*TEXTS, value[:len(value) // 2], value + rng.choice(TEXTS)])
        else:
            holder[key] = anything(rng)
    return document


def as_text(rng, document):
    """JSON, now and then with what a dump never writes: a name twice, 1e400, a cut."""
    text = json.dumps(document, ensure_ascii=rng.random() < 0.5)
    depth = rng.choice([5, 20, 40, 20000])
    text = text.replace(f'"{NEST}"', rng.choice(["[" * depth + "]" * depth, '{"a":' * depth + "1" + "}" * depth]))
    way = rng.random()
    if way < 0.05:
        marks = [i for i, c in enumerate(text) if c.isdigit()]
        if marks:
            i = rng.choice(marks)
            text = text[:i] + rng.choice(["1e400", "-1e999", "1" * 400, "0x1", "NaN", "01", "1e-400"]) + text[i + 1:]
    elif way < 0.08 and '": ' in text:
        i = text.index("{") + 1
        text = text[:i] + text[i:].split(",", 1)[0] + ", " + text[i:]
    elif way < 0.12:
        text = text[:rng.randrange(len(text) + 1)]
    return text.encode("utf-8", "surrogatepass")


def commands(kind):
    """Words after the tool that read the document mutant.json."""
    report = ("report", "mutant.json", "-o", "page.html", "--force")
    readers = {
        "table": [("export", "mutant.json", "--to", "c-header", "-o", "-"),
                  ("filter", "log.csv", "--method", "switching,table=mutant.json", "-o", "-"),
                  ("design", "mutant.json", "--speed", "18:180:54")],
        "joint": [("design", "mutant.json", "--speed", "18:180:54", "--q", "0.25")],
        "model": [("simulate", "--model", "mutant.json", "--motion", "constant,speed=60deg/s,duration=0.2s", "--sample-rate", "100Hz",
                   "-o", "-")],
    }
    return [report, *readers.get(kind, [])]


def shows_control(text):
    """Whether bytes for people hold what would act on a terminal."""
    decoded = text.decode("utf-8", "replace")
    return any((ord(c) < 0x20 and c not in "\n\t\r") or 0x7F <= ord(c) < 0xA0 or c in "\u202e\u2028\u2066" for c in decoded)


def processor_s():
    """Of all processes that have ended; what the clock says depends on who else is at work."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def try_one(tool, folder, words, limit_s=LONGEST_S):
    """None, or what went wrong."""
    before = processor_s()
    try:
        done = subprocess.run([tool, *words], cwd=folder, capture_output=True, stdin=subprocess.DEVNULL, timeout=30 * limit_s)
    except subprocess.TimeoutExpired:
        return f"no end within {30 * limit_s:g} s"
    taken = processor_s() - before
    if done.returncode not in ALLOWED:
        return f"exit code {done.returncode}: {done.stderr.decode('utf-8', 'replace')[-200:]}"
    if taken > limit_s:
        return f"{taken:.1f} s"
    if shows_control(done.stderr):
        return f"escapes on standard error: {done.stderr[-200:]!r}"
    if words[0] in ("design",) and shows_control(done.stdout):
        return "escapes on standard output"
    return None


def round_of(tool, source, folder, seed, seconds=None, runs=None, keep=None):
    """(runs, findings) of mutants of every kind, each through every command that reads it."""
    folder = pathlib.Path(folder)
    documents = {kind: json.loads(text) for kind, text in make(tool, source, folder).items()}
    rng = random.Random(seed)
    kinds = sorted(documents)
    end = time.monotonic() + seconds if seconds else float("inf")
    count, findings = 0, []
    while time.monotonic() < end and (runs is None or count < runs):
        kind = kinds[count % len(kinds)] if rng.random() < 0.7 else rng.choice(["table", "model", "joint", "figure", "diagnosis"])
        bytes_ = as_text(rng, mutate(rng, documents[kind], [documents[k] for k in kinds]))
        (folder / "mutant.json").write_bytes(bytes_)
        for words in commands(kind):
            count += 1
            wrong = try_one(tool, folder, words)
            if wrong is None:
                continue
            name = f"{kind}-{seed}-{count}.json"
            if keep:
                pathlib.Path(keep).mkdir(parents=True, exist_ok=True)
                pathlib.Path(keep, name).write_bytes(bytes_)
            findings.append(f"{' '.join(words)} on {name}: {wrong}")
    return count, findings
