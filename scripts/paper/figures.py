# SPDX-License-Identifier: MIT
"""The paper's figures and Table 1, from the tool. Each function returns ({file: text}, {table: text}) ."""

from .tool import columns, csv_text, fixed, markdown, peak_to_peak

GEAR = ["--gear-ratio", "100", "--orders", "1,2"]
NOTCH = "fixed,centers=25Hz:50Hz,q=0.25"
LOWPASS = "lowpass,cutoff=13rad/s,order=1"
PRINTED_LOWPASS = "lowpass,cutoff=13Hz,order=1"
RUNS = {0: "paper_rest.csv", 60: "paper_60deg_s.csv", 120: "paper_120deg_s.csv", 180: "paper_180deg_s.csv"}


def table1(tool, data):
    """Table 1: the candidates with their delay, settling time and attenuation."""
    words = ["design", *GEAR, "--sample-rate", "1kHz", "--speed", "18:180:18", "--q", "0.25"]
    tool.text(*words, "-o", "table1.json", "--force")
    tool.text(*words, "-o", "table1.csv", "--force")
    return {"table1.csv": (tool.folder / "table1.csv").read_text()}, {}


def lines_of(tool, log, count=2):
    """Frequency and amplitude of the `count` strongest lines of a log, lowest first."""
    peaks = tool.json("spectrum", log)["spectra"][0]["peaks"]
    strongest = sorted(peaks, key=lambda p: -p["amplitude_nm"])[:count]
    return sorted((p["hz"], p["amplitude_nm"]) for p in strongest)


def figures_1_and_2(tool, data):
    """Spectra at four speeds, and the lines in them against eq. 1 and 3."""
    spectra = {speed: columns(tool.text("spectrum", data / log, "--bins")) for speed, log in RUNS.items()}
    hz = [f for f in spectra[0]["frequency_hz"] if f <= 120.0]
    names = ["frequency_hz"] + [f"amplitude_{speed}_deg_s_nm" for speed in RUNS]
    rows = [[f"{f:g}", *(fixed(spectra[speed]["amplitude_nm"][i], 5) for speed in RUNS)] for i, f in enumerate(hz)]
    files = {"figure1.csv": csv_text(names, rows)}

    points = []
    for speed, log in RUNS.items():
        found = lines_of(tool, data / log)
        for order in (1, 2):
            predicted = order * 100.0 * speed / 360.0
            hz_nm = found[order - 1] if len(found) == 2 else (None, None)
            points.append([str(speed), str(order), fixed(predicted, 4),
                           *(None if v is None else fixed(v, d) for v, d in zip(hz_nm, (4, 4)))])
    files["figure2.csv"] = csv_text(["speed_deg_s", "order", "predicted_hz", "measured_hz", "amplitude_nm"], points)
    return files, {}


def figure_4(tool, data):
    """The supervisor: which candidate is active as the speed rises to 190 deg/s and falls again."""
    tool.text("simulate", "--model", data / "paper_model.json", "--motion", "ramp,to-speed=191deg/s,duration=3.8s",
              "--motion", "ramp,to-speed=0deg/s,duration=3.8s", "--sample-rate", "1kHz", "-o", "ramp.csv", "--force")
    metrics = tool.json("filter", "--method", "switching,table=table1.json,transition=parallel", "ramp.csv", "-o", "ramped.csv", "--force")
    switches = metrics["logs"][0]["switches"] if "logs" in metrics else metrics["switches"]
    rows = [[f"{s['time_s']:.3f}", str(s["from_band"]), str(s["to_band"]), fixed(s["speed_deg_s"], 3),
             fixed(s["jump_nm"], 4)] for s in switches]
    names = ["time_s", "from_band", "to_band", "speed_deg_s", "jump_nm"]
    return {"figure4.csv": csv_text(names, rows)}, {}


def figures_7_and_8(tool, data):
    """90 deg/s: the notch at 25 and 50 Hz against the low-pass, in time and against frequency."""
    log = data / "paper_90deg_s.csv"
    raw = columns(log.read_text())
    signals = {"raw": raw["torque_nm"]}
    for name, method in (("notch", NOTCH), ("lowpass", LOWPASS)):
        tool.text("filter", "--method", method, log, "-o", f"{name}.csv", "--force", "-q")
        signals[name] = columns((tool.folder / f"{name}.csv").read_text())["torque_nm"]
    window = range(3000, 3400)
    files = {"figure7.csv": csv_text(
        ["time_s", "raw_nm", "notch_nm", "lowpass_13rad_s_nm"],
        [[f"{raw['time_s'][k]:.3f}", *(fixed(signals[n][k], 4) for n in signals)] for k in window])}
    spectra = {"raw": columns(tool.text("spectrum", log, "--bins"))}
    for name in ("notch", "lowpass"):
        spectra[name] = columns(tool.text("spectrum", f"{name}.csv", "--bins"))
    files["figure8.csv"] = csv_text(
        ["frequency_hz", "raw_nm", "notch_nm", "lowpass_13rad_s_nm"],
        [[f"{f:g}", *(fixed(spectra[n]["amplitude_nm"][i], 5) for n in spectra)]
         for i, f in enumerate(spectra["raw"]["frequency_hz"]) if f <= 120.0])

    rows = []
    at = {hz: spectra["raw"]["frequency_hz"].index(hz) for hz in (25.0, 50.0)}
    papers = {"raw": ["about 2", "yes"], "notch": ["below 0.3", "gone"], "lowpass": ["below 0.3", "still visible"]}
    for name, title in (("raw", "raw"), ("notch", NOTCH), ("lowpass", LOWPASS)):
        lines = [spectra[name]["amplitude_nm"][i] for i in at.values()]
        rows.append([f"`{title}`" if name != "raw" else title, papers[name][0],
                     fixed(peak_to_peak(signals[name][3000:]), 2), papers[name][1],
                     *(fixed(v, 4) for v in lines)])
    head = ["filter", "remaining ripple in the paper, Nm", "peak to peak, Nm", "lines in the paper",
            "line at 25 Hz, Nm", "line at 50 Hz, Nm"]
    return files, {"figure-7-8": markdown(head, rows)}


def signal_log(torque_of, duration_s):
    """A log at 90 deg/s whose torque is a function of time."""
    rows = [[f"{k / 1000:g}", "90", repr(torque_of(k / 1000))] for k in range(round(duration_s * 1000))]
    return csv_text(["time_s", "velocity_deg_s", "torque_nm"], rows)


def figures_9_and_10(tool, data):
    """The 10 Nm step and the 20 Nm/s ramp, and the figures read off them."""
    files, outputs = {}, {}
    tool.write("step.csv", signal_log(lambda t: 10.0 if t >= 0.1 else 0.0, 0.8))
    tool.write("slope.csv", signal_log(lambda t: max(0.0, 20.0 * (t - 0.1)), 0.8))
    for log, figure in (("step.csv", "figure9.csv"), ("slope.csv", "figure10.csv")):
        raw = columns((tool.folder / log).read_text())
        outputs = {name: tool.log("filter", "--method", method, log, "-q")["torque_nm"]
                   for name, method in (("notch", NOTCH), ("lowpass", LOWPASS), ("printed", PRINTED_LOWPASS))}
        files[figure] = csv_text(
            ["time_s", "raw_nm", "notch_nm", "lowpass_13rad_s_nm", "lowpass_13hz_nm"],
            [[f"{raw['time_s'][k]:.3f}", fixed(raw["torque_nm"][k], 3),
              *(fixed(outputs[n][k], 4) for n in outputs)] for k in range(0, 800, 2)])
    found = tool.json("compare", "--step", "10Nm", "--ramp", "20Nm/s", "--speed", "90deg/s", "--sample-rate", "1kHz",
                      *GEAR, "--method", NOTCH, "--method", LOWPASS, "--method", PRINTED_LOWPASS)["methods"]
    by_name = {m["method"]: m for m in found}
    papers = {NOTCH: ("150", "40"), LOWPASS: ("about 400", "78"), PRINTED_LOWPASS: ("about 400", "78")}
    rows = []
    for method, (settle, lag) in papers.items():
        m = by_name[method]
        rows.append([f"`{method}`", settle, *(fixed(m["settle_ms"][b], 0) for b in ("0.5", "1", "2")), lag,
                     fixed(m["ramp_delay_ms"], 1)])
    head = ["filter", "steady in the paper, ms", "settles to 0.5 %, ms", "to 1 %, ms", "to 2 %, ms",
            "ramp delay in the paper, ms", "ramp delay, ms"]
    return files, {"figure-9-10": markdown(head, rows)}


def low_pass_hypotheses(tool, data):
    """Which low-pass the paper's figures were made with."""
    hypotheses = [("1st order, 13 Hz", "lowpass,cutoff=13Hz,order=1"),
                  ("2nd order, 13 Hz", "lowpass,cutoff=13Hz,order=2"),
                  ("4th order, 13 Hz", "lowpass,cutoff=13Hz,order=4"),
                  ("10th order, 13 Hz", "lowpass,cutoff=13Hz,order=10"),
                  ("1st order, 13 rad/s", LOWPASS)]
    words = [w for _, method in hypotheses for w in ("--method", method)]
    found = tool.json("compare", "--step", "10Nm", "--ramp", "20Nm/s", "--speed", "90deg/s", "--sample-rate", "1kHz",
                      *GEAR, *words)["methods"]
    by_name = {m["method"]: m for m in found}
    log = data / "paper_90deg_s.csv"
    rows, numbers = [], []
    for title, method in hypotheses:
        m = by_name[method]
        out = tool.log("filter", "--method", method, log, "-q")["torque_nm"]
        left = peak_to_peak(out[3000:])
        gain = 10.0 ** (-m["attenuation_db"][0]["db"] / 20.0)
        line = 0.8 * gain
        settle, lag = m["settle_ms"]["0.5"], m["ramp_delay_ms"]
        # The paper's plots show a line from about a hundredth of a newton-metre up.
        verdict = [abs(lag - 78.0) <= 2.0, abs(settle - 400.0) <= 20.0, left < 0.3, line > 0.01]
        rows.append([title, fixed(lag, 1), fixed(settle, 0), fixed(left, 2), fixed(line, 4),
                     "**all four**" if all(verdict) else f"{sum(verdict)} of 4"])
        numbers.append([method, fixed(lag, 3), fixed(settle, 1), fixed(gain, 5), fixed(left, 3)])
    rows.append(["the paper", "78", "about 400", "below 0.3", "visible", ""])
    head = ["low-pass", "ramp delay, ms", "settles, ms", "remaining, Nm", "line at 25 Hz, Nm", "fits"]
    files = {"low_passes.csv": csv_text(["method", "ramp_delay_ms", "settle_ms", "gain_25_hz", "left_pp_nm"], numbers)}
    return files, {"low-passes": markdown(head, rows)}


def polynomial(tool, data):
    """No polynomial of the sixth degree has both of the paper's peaks."""
    numbers = []
    for asymmetry in ("0", "0.1", "0.2", "0.3304", "1"):
        log = tool.log("simulate", "--gear-ratio", "100", "--inertia", "1kgm2", "--motion",
                       f"poly6,from=90deg,to=-90deg,duration=2s,asymmetry={asymmetry}", "--sample-rate", "1kHz")
        speed = max(map(abs, log["velocity_deg_s"]))
        acceleration = max(map(abs, log["torque_nm"])) * 57.29577951308232
        numbers.append([asymmetry, fixed(speed, 3), fixed(acceleration, 3)])
    files = {"polynomial.csv": csv_text(["asymmetry", "greatest_speed_deg_s", "greatest_acceleration_deg_s2"], numbers)}
    return files, {}


PARTS = [table1, figures_1_and_2, figure_4, figures_7_and_8, figures_9_and_10, low_pass_hypotheses, polynomial]
