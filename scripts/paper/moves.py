# SPDX-License-Identifier: MIT
"""Beyond the figures: every method against the true torque, on the paper's move, on a speed ramp, through a reversal."""

from concurrent.futures import ThreadPoolExecutor

from .tool import columns, csv_text, delay_samples, error, fixed, markdown, rms, torque_of

JOINT = ["--gear-ratio", "100", "--inertia", "0.992kgm2"]
MOVE = ["--motion", "poly6,from=90deg,to=-90deg,duration=2s", "--sample-rate", "1kHz"]
SEEDS = range(1, 6)
PHASES = (90, 0)
GEAR = "gear-ratio=100,orders=1:2"
TABLE = "switching,table=table1.json"
TRANSITIONS = ("parallel", "crossfade", "keep-state-variable")
OSCILLATOR = f"oscillator,{GEAR}"
# In the CSV alone.
VARIANTS = ("hysteresis 1 deg/s", "crossfade", "gain scheduled", "minus-ripple", "no fading", "180 deg/s",
            "13 Hz, 1st order", "its best Q, 1.4, parallel")


def warm(phase):
    return f"{OSCILLATOR},amplitudes=0.8Nm:0.5Nm,phases={phase}deg:{phase}deg"


def simulate_moves(tool, data):
    """The move with ripple and noise: {(phases, seed): (log, the same without position and with a noisy speed)}."""
    made = {}
    for phase in PHASES:
        ripple = ["--ripple", f"1:0.8Nm:{phase}deg", "--ripple", f"2:0.5Nm:{phase}deg"]
        for seed in SEEDS:
            noise = ["--noise", "0.05Nm", "--seed", str(seed)]
            names = f"move_{phase}_{seed}.csv", f"blind_{phase}_{seed}.csv"
            tool.text("simulate", *JOINT, *ripple, *MOVE, *noise, "-o", names[0], "--force")
            tool.text("simulate", *JOINT, *ripple, *MOVE, *noise, "--velocity-noise", "0.15deg/s", "--no-position",
                      "-o", names[1], "--force")
            made[phase, seed] = names
        identify_joint(tool, ripple, phase)
    truth = tool.log("simulate", *JOINT, *MOVE)["torque_nm"]
    return made, truth


def identify_joint(tool, ripple, phase):
    """joint_PHASE.json, from runs at three speeds: gear ratio, amplitudes, and phases tied to the position."""
    runs = []
    for speed in (60, 120, 180):
        runs.append(f"run_{phase}_{speed}.csv")
        tool.text("simulate", *JOINT, *ripple, "--motion", f"constant,speed={speed}deg/s,duration=4s,from=90deg",
                  "--sample-rate", "1kHz", "--noise", "0.05Nm", "--seed", str(speed), "-o", runs[-1], "--force")
    tool.text("identify", *runs, "-o", f"joint_{phase}.json", "--force", "-q")


def filtered(tool, method, log):
    return tool.torque("filter", "--method", method, log, "-q")


def contenders(best_q):
    """Title, method by phase and by whether the log has a position, in the order of the table."""
    def same(method):
        return lambda phase, has_position: method
    start = {True: "", False: ",start=90deg"}
    rows = [("raw", same("none"))]
    rows += [(f"Table 1, {name}", same(f"{TABLE},transition={name}")) for name in TRANSITIONS]
    rows += [(f"Table 1, {name}, hysteresis 1 deg/s", same(f"{TABLE},transition={name},hysteresis=1deg/s"))
             for name in TRANSITIONS]
    rows += [(f"Table 1 with its best Q, {best_q:g}, parallel", same("switching,table=best.json,transition=parallel")),
             (f"Table 1 with Q {best_q:g}, keep-state-variable",
              same("switching,table=best.json,transition=keep-state-variable")),
             ("low-pass, 13 Hz, 1st order", same("lowpass,cutoff=13Hz,order=1")),
             ("low-pass, 13 rad/s, 1st order", same("lowpass,cutoff=13rad/s,order=1")),
             ("tracking", same(f"tracking,{GEAR}")),
             ("tracking, Q 4, no fading", same(f"tracking,{GEAR},q=4,min=0.5Hz,fade=0Hz")),
             ("oscillator, cold", same(OSCILLATOR)),
             ("oscillator, cold, rest=0Nm", same(f"{OSCILLATOR},rest=0Nm")),
             ("oscillator, cold, gain scheduled", same(f"{OSCILLATOR},gain=scheduled")),
             ("oscillator, cold, minus-ripple", same(f"{OSCILLATOR},output=minus-ripple")),
             ("oscillator, warm", lambda phase, has: warm(phase) + start[has]),
             ("oscillator, warm from identify at 60, 120, 180 deg/s",
              lambda phase, has: f"oscillator,joint=joint_{phase}.json{start[has]}"),
             ("oscillator, warm, 5 % and 5 deg off", lambda phase, has:
                 f"{OSCILLATOR},amplitudes=0.84Nm:0.475Nm,phases={phase + 5}deg:{phase - 5}deg{start[has]}"),
             ("oscillator, warm, gain scheduled", lambda phase, has: f"{warm(phase)},gain=scheduled{start[has]}"),
             ("oscillator, warm, minus-ripple", lambda phase, has: f"{warm(phase)},output=minus-ripple{start[has]}")]
    return rows


def best_q(tool, data, logs, truth):
    """Table 1 with one Q after another, on the move: the Q of the least error."""
    numbers = []
    for q in (0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0):
        for name in ("tried.csv", "tried.json"):
            tool.text("design", "--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed",
                      "18:180:18", "--q", f"{q:g}", "-o", name, "--force")
        table = columns((tool.folder / "tried.csv").read_text())
        left = sum(error(filtered(tool, "switching,table=tried.json,transition=parallel", logs[90, seed][0]), truth) for seed in SEEDS) / 5.0
        delays = table["dc_delay_ms"]
        least = min(table["worst_attenuation_1_db"] + table["worst_attenuation_2_db"])
        numbers.append((left, q, delays[-1], delays[0], least))
    winner = min(numbers)[1]
    tool.text("design", "--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "18:180:18", "--q",
              f"{winner:g}", "-o", "best.json", "--force")
    return winner, \
        [[f"{q:g}", fixed(left, 4), *(fixed(value, 1) for value in more)] for left, q, *more in numbers]


def measure(tool, method_of, logs, truth):
    """Mean errors over the seeds: {(phases, has position): Nm}, and the delay in ms on the first."""
    errors, delay, switches = {}, 0.0, None
    for phase in PHASES:
        for place, has_position in ((0, True), (1, False)):
            total = 0.0
            for seed in SEEDS:
                out = filtered(tool, method_of(phase, has_position), logs[phase, seed][place])
                total += error(out, truth)
                if phase == 90 and seed == 1 and has_position:
                    delay = delay_samples(out, truth)
            errors[phase, has_position] = total / len(SEEDS)
    return errors, delay


def move_table(tool, data):
    """The 2 s move: every method's error against the true torque, and figure 11."""
    logs, truth = simulate_moves(tool, data)
    winner, q_numbers = best_q(tool, data, logs, truth)
    rows, numbers = [], []
    methods = contenders(winner)
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda entry: measure(tool, entry[1], logs, truth), methods))
    for (title, method_of), (errors, delay) in zip(methods, results):
        cells = [errors[phase, has] for phase in PHASES for has in (True, False)]
        if not title.endswith(VARIANTS):
            rows.append([title, fixed(cells[0], 3), fixed(cells[2], 3), fixed(delay, 1)])
        numbers.append([title, *(fixed(v, 4) for v in cells), fixed(delay, 2)])
    head = ["method", "phases 90 deg, Nm rms", "phases 0 deg, Nm rms", "delay, ms"]
    files = {"move_errors.csv": csv_text(
        ["method", "error_phases_90_position_nm", "error_phases_90_velocity_nm", "error_phases_0_position_nm",
         "error_phases_0_velocity_nm", "delay_ms"], numbers),
        "move_q.csv": csv_text(["q", "error_nm", "least_delay_ms", "greatest_delay_ms", "least_attenuation_db"], q_numbers)}
    files.update(figure_11(tool, logs, truth))
    return files, {"move": markdown(head, rows)}


def figure_11(tool, logs, truth):
    log = logs[90, 1][0]
    raw = columns((tool.folder / log).read_text())
    outputs = [filtered(tool, method, log) for method in (
        f"{TABLE},transition=parallel", "switching,table=best.json,transition=parallel", f"tracking,{GEAR}", OSCILLATOR,
        warm(90))]
    rows = [[f"{raw['time_s'][k]:.3f}", fixed(raw["velocity_deg_s"][k], 2), fixed(truth[k], 4),
             fixed(raw["torque_nm"][k], 4), *(fixed(out[k], 4) for out in outputs)] for k in range(0, len(truth), 5)]
    return {"figure11.csv": csv_text(["time_s", "velocity_deg_s", "true_nm", "raw_nm", "table1_nm", "best_q_nm",
                                      "tracking_nm", "oscillator_cold_nm", "oscillator_warm_nm"], rows)}


PHASE_PAIRS = [(p1, p2) for p1 in range(0, 360, 90) for p2 in range(0, 360, 90)]


def cold_phases(tool, data):
    """Error of a cold start, by the phases of the ripple at standstill."""
    truth = tool.log("simulate", *JOINT, *MOVE)["torque_nm"]

    def one(pair):
        log = f"cold_{pair[0]}_{pair[1]}.csv"
        tool.text("simulate", *JOINT, "--ripple", f"1:0.8Nm:{pair[0]}deg", "--ripple", f"2:0.5Nm:{pair[1]}deg", *MOVE,
                  "--noise", "0.05Nm", "-o", log, "--force")
        raw = columns((tool.folder / log).read_text())["torque_nm"]
        found = [filtered(tool, method, log) for method in (OSCILLATOR, f"{OSCILLATOR},rest=0Nm")]
        return [raw[0] - truth[0], *(error(out, truth) for out in found),
                error(found[0][400:], truth[400:]), error(found[1][400:], truth[400:])]

    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(one, PHASE_PAIRS))
    numbers = [[str(p1), str(p2), *(fixed(v, 4) for v in values)] for (p1, p2), values in zip(PHASE_PAIRS, results)]
    names = ["phase_1_deg", "phase_2_deg", "at_rest_nm", "cold_nm", "cold_rest_nm", "cold_after_400_ms_nm",
             "cold_rest_after_400_ms_nm"]
    return {"cold_phases.csv": csv_text(names, numbers)}, {}


def reversal(tool, data):
    """Through zero: -40 to 40 deg/s at 8 deg/s2, ripple of 2 and 1 Nm, slow torque of 10 + 5 sin(0.4 pi t)."""
    base = ["--effect", "offset,torque_nm=10", "--effect", "tone,frequency_hz=0.2,amplitude_nm=5,phase_deg=-90"]
    motion = ["--motion", "constant,speed=-40deg/s,duration=5s", "--motion", "ramp,to-speed=40deg/s,duration=10s",
              "--motion", "constant,speed=40deg/s,duration=5s", "--sample-rate", "1kHz"]
    ripple = ["--ripple", "1:2Nm:-72.811deg", "--ripple", "2:1Nm:-26.975deg"]
    tool.text("simulate", "--gear-ratio", "100", *ripple, *base, *motion, "--noise", "0.05Nm", "-o", "reversal.csv",
              "--force")
    truth = tool.log("simulate", "--gear-ratio", "100", *base, *motion)["torque_nm"]
    methods = ["none", f"{TABLE},transition=parallel", "lowpass,cutoff=3Hz,order=2", "lowpass,cutoff=13rad/s,order=1"]
    methods += [f"tracking,{GEAR},q=1,{low}" for low in ("min=1Hz,fade=0Hz,low=park", "min=1Hz,fade=1Hz",
                                                         "min=2Hz,fade=2Hz")]
    methods += [f"tracking,{GEAR}", OSCILLATOR]
    numbers = []
    for method in methods:
        out = filtered(tool, method, "reversal.csv")
        window, steady = error(out[8000:12000], truth[8000:12000]), error(out[16000:], truth[16000:])
        numbers.append([method, fixed(window, 4), fixed(steady, 4)])
    return {"reversal.csv": csv_text(["method", "reversal_nm", "at_40_deg_s_nm"], numbers)}, {}


def transitions(tool, data):
    """Every transition, hysteresis and dwell on one log: speed from 20 to 170 deg/s and back, with a noisy speed."""
    motion = ["--motion", "constant,speed=20deg/s,duration=1s", "--motion", "ramp,to-speed=170deg/s,duration=5s",
              "--motion", "ramp,to-speed=20deg/s,duration=5s", "--sample-rate", "1kHz"]
    ripple = ["--ripple", "1:0.8Nm:0deg", "--ripple", "2:0.5Nm:0deg"]
    tool.text("design", "--gear-ratio", "100", "--orders", "1,2", "--sample-rate", "1kHz", "--speed", "18:180:18",
              "--q", "1", "-o", "q1.json", "--force")
    for name, noise in (("clean.csv", "0deg/s"), ("noisy.csv", "0.5deg/s")):
        tool.text("simulate", "--gear-ratio", "100", *ripple, "--effect", "offset,torque_nm=10", *motion,
                  "--velocity-noise", noise, "-o", name, "--force")
    numbers = []
    guards = ["", ",hysteresis=1deg/s", ",hysteresis=2deg/s", ",dwell=0.1s"]
    for transition in TRANSITIONS:
        for log, guard in [("clean.csv", "")] + [("noisy.csv", g) for g in guards]:
            method = f"switching,table=q1.json,transition={transition}{guard}"
            metrics = tool.json("filter", "--method", method, log, "-o", "switched.npy", "--force", "-q")
            metrics = metrics["logs"][0] if "logs" in metrics else metrics
            out = torque_of((tool.folder / "switched.npy").read_bytes())
            left = [v - 10.0 for v in out[1000:]]
            jump = max((abs(s["jump_nm"]) for s in metrics["switches"]), default=0.0)
            step = max(abs(b - a) for a, b in zip(out[1000:], out[1001:]))
            cells = [str(metrics["switch_count"]), fixed(jump, 3), fixed(rms(left), 3), fixed(max(map(abs, left)), 3),
                     fixed(step, 3)]
            noise = "none" if log == "clean.csv" else "0.5 deg/s"
            numbers.append([transition, noise, guard[1:], *cells])
    rows = []
    for transition in TRANSITIONS:
        own = [row for row in numbers if row[0] == transition]
        rows.append([f"`{transition}`", *(fixed(max(float(row[k]) for row in own), 3) for k in (4, 5, 7))])
    head = ["transition", "largest jump, Nm", "remaining ripple, Nm rms", "largest step, Nm"]
    names = ["transition", "speed_noise", "guard", "switches", "largest_jump_nm", "left_nm", "largest_nm",
             "largest_step_nm"]
    return {"transitions.csv": csv_text(names, numbers)}, {"transitions": markdown(head, rows)}


PARTS = [move_table, cold_phases, reversal, transitions]
