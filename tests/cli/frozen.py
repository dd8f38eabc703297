# SPDX-License-Identifier: MIT
"""Command lines whose output is frozen: tests/cli/test_frozen.py compares the hashes with frozen.json.

A change that is meant runs `python3 tests/cli/frozen.py TOOL --update` and says in the CHANGELOG what became different. Bytes are compared
as they are where the tool promises them on every machine (filtered logs, tables, code, simulations); numbers of a JSON answer at
5 significant digits, because libraries choose their instructions by the processor."""

import hashlib
import json
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
HASHES = pathlib.Path(__file__).with_name("frozen.json")

MOVE, STEADY, REST, MODEL = ("data/paper_move_2s.csv", "data/paper_120deg_s.csv", "data/paper_rest.csv", "data/paper_model.json")
GEAR = "--gear-ratio 100"
# A name, the words behind `ripplenotch`; {d} is a folder that all share, and -o names a file of it, which is hashed.
BYTES = [
    *[(f"simulate {motion.split(',')[0]}", f"simulate --model {MODEL} --motion {motion} --sample-rate 1kHz --noise 0.04Nm --seed 7 -o {{d}}/sim_{k}.csv")
      for k, motion in enumerate(("rest,duration=2s", "constant,speed=90deg/s,duration=2s", "sine,amplitude=30deg,frequency=0.5Hz,duration=3s",
                                  "poly6,from=90deg,to=-90deg,duration=2s", "ramp,from-speed=20deg/s,to-speed=120deg/s,duration=3s"))],
    ("simulate npy", f"simulate --model {MODEL} --motion constant,speed=60deg/s,duration=2s --sample-rate 1kHz --seed 3 -o {{d}}/sim.npy"),
    ("simulate effects", "simulate --effect coulomb-friction,torque_nm=1.5,width_deg_s=0.2 --ripple 2:0.5Nm --motion "
     f"sine,amplitude=30deg,frequency=0.5Hz,duration=3s {GEAR} --sample-rate 500Hz --seed 3 -o {{d}}/effects.csv"),
    ("design", f"design {GEAR} --sample-rate 1kHz --speed 18:180:18 --q 0.25 --json -o {{d}}/table.json"),
    ("design orders", f"design {GEAR} --orders 1,2,4 --sample-rate 2kHz --speed 18:180 --min-attenuation 10dB --json -o {{d}}/table4.json"),
    *[(f"filter {method.split(',')[0]}", f"filter {MOVE} --method {method} {GEAR} -o {{d}}/filtered_{k}.csv")
      for k, method in enumerate(("none", "lowpass,cutoff=10Hz", "fixed,centers=33.3Hz:66.7Hz", "tracking", "oscillator"))],
    ("filter table", f"filter {MOVE} --method switching,table={{d}}/table.json -o {{d}}/filtered_table.csv"),
    *[(f"filter {transition}", f"filter {MOVE} --method switching,table={{d}}/table.json,transition={transition} -o {{d}}/filtered_{transition}.csv")
      for transition in ("crossfade", "parallel", "keep-state-variable")],
    ("filter one thread", f"filter {STEADY} --method switching,table={{d}}/table.json --threads 1 -o {{d}}/filtered_one.csv"),
    ("filter to npy", f"filter {STEADY} --method lowpass,cutoff=20Hz -o {{d}}/filtered.npy"),
    ("filter range", f"filter {MOVE} --method lowpass,cutoff=20Hz --from 0.5s --to 1.5s -o {{d}}/filtered_range.csv"),
    ("filter semicolons", "filter data/dialects/semicolon_decimal_comma_crlf.csv --method lowpass,cutoff=20Hz -o {d}/filtered_semicolons.csv"),
    ("map", f"map {MOVE} {STEADY} {GEAR} -o {{d}}/map.json --force"),
    *[(f"export {target}", f"export {{d}}/table.json --to {target} -o {{d}}/exported_{k}")
      for k, target in enumerate(("c-header", "cmsis-dsp", "json", "matlab", "scipy"))],
    *[(f"export map {target}", f"export {{d}}/map.json --to {target} -o {{d}}/exported_map_{k}") for k, target in enumerate(("c-header", "lut", "fourier"))],
    ("filter map", f"filter {MOVE} --method map,map={{d}}/map.json -o {{d}}/filtered_map.csv"),
]
ANSWERS = [
    ("recommend", f"recommend {MOVE} {GEAR} --json"),
    ("identify several", f"identify {STEADY} {MOVE} --json"),
    ("spectrum order", f"spectrum {MOVE} --domain order --json"),
    *[(f"info {name}", f"info {name} --json") for name in (MOVE, REST)],
    *[(f"info {path.name}", f"info {path.relative_to(SOURCE)} --json") for path in sorted((SOURCE / "data/dialects").glob("*.csv"))],
    *[(f"identify {name}", f"identify {name} --json") for name in (MOVE, STEADY, REST)],
    ("identify gear", f"identify {STEADY} {GEAR} --json"),
    ("compare", f"compare {MOVE} --method none --method lowpass,cutoff=10Hz --method switching,table={{d}}/table.json {GEAR} --json"),
    ("diagnose model", f"diagnose {MOVE} --model {MODEL} --json"),
    ("diagnose sine", f"diagnose {{d}}/sim_2.csv --model {MODEL} --json"),
    ("diagnose effects", f"diagnose {{d}}/effects.csv --model {MODEL} --without gravity --json"),
    ("spectrum", f"spectrum {STEADY} --json"),
    ("track", f"spectrum {STEADY} --track {GEAR} --json"),
    ("effects", "diagnose --effects --json"),
]


def rounded(text):
    text = re.sub(r"-?\d+\.\d+(?:e[-+]?\d+)?|-?\d+e[-+]?\d+", lambda number: f"{float(number[0]):.4e}", text)
    return re.sub(r"\"(?:sha256|version)\": *\"[^\"]*\"", "", text)


def outcome(tool, words, folder, exact):
    words = words.replace("{d}", folder).split()
    done = subprocess.run([tool, *words], cwd=SOURCE, capture_output=True)
    text = (done.stdout + done.stderr).decode().replace(folder, "")
    parts = [str(done.returncode).encode(), (text if exact else rounded(text)).encode()]
    if "-o" in words:
        path = pathlib.Path(words[words.index("-o") + 1])
        parts.append(re.sub(rb'"(?:sha256|version|path)": *"[^"]*"', b"", path.read_bytes().replace(folder.encode(), b"")) if path.exists() else b"no file")
    return hashlib.sha256(b"\0".join(parts)).hexdigest()[:16], done.returncode


def outcomes(tool):
    with tempfile.TemporaryDirectory() as folder:
        return {name: outcome(tool, words, folder, exact) for exact, lines in ((True, BYTES), (False, ANSWERS)) for name, words in lines}


if __name__ == "__main__":
    found = outcomes(sys.argv[1])
    for name, (_, code) in found.items():
        if code not in (0, 1, 5):
            print(f"{name}: exit code {code}", file=sys.stderr)
    if "--update" in sys.argv:
        HASHES.write_text(json.dumps({name: value for name, (value, _) in found.items()}, indent=1) + "\n")
