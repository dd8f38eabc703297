#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the reference of tests/cli/test_response.py with SciPy: a log of two signals, and their H1, H2 and coherence.

usage: scripts/make_response_reference.py [FOLDER]      needs python3-scipy; the files in the repository came from 1.10.1

The Hann window is the tool's: over the length of a segment, symmetric about its middle.
"""

import pathlib
import sys

import numpy as np
from scipy import signal

FOLDER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent / "tests/cli/data")
RATE, ROWS, SEGMENT = 500.0, 1000, 100


def main():
    random = np.random.default_rng(20)
    in_ = np.round(random.normal(size=ROWS) + np.sin(np.arange(ROWS) / 5), 4)
    b, a = signal.butter(2, 40, fs=RATE)
    out = np.round(2 * signal.lfilter(b, a, in_) + 0.2 * random.normal(size=ROWS), 4)
    FOLDER.mkdir(exist_ok=True)
    rows = (f"{k / RATE:.3f},90,{x:.4f},{y:.4f}\n" for k, (x, y) in enumerate(zip(in_, out)))
    (FOLDER / "response_log.csv").write_text("time_s,velocity_deg_s,torque_nm,other\n" + "".join(rows))

    window = 0.5 + 0.5 * np.cos(2 * np.pi * (np.arange(SEGMENT) - (SEGMENT - 1) / 2) / SEGMENT)
    how = {"fs": RATE, "window": window, "nperseg": SEGMENT, "noverlap": SEGMENT // 2, "detrend": "linear"}
    hz, power_in = signal.welch(in_, **how)
    power_out = signal.welch(out, **how)[1]
    cross = signal.csd(in_, out, **how)[1]
    coherence = signal.coherence(in_, out, **how)[1]
    with open(FOLDER / "response_scipy.csv", "w") as file:
        file.write("frequency_hz,h1_db,h2_db,phase_deg,coherence\n")
        for f, h1, h2, c in zip(hz, cross / power_in, power_out / np.conj(cross), coherence):
            file.write(f"{f:.9g},{20 * np.log10(abs(h1)):.9g},{20 * np.log10(abs(h2)):.9g},"
                       f"{np.degrees(np.angle(h1)):.9g},{c:.9g}\n")


if __name__ == "__main__":
    main()
