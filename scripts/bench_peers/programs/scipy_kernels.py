# SPDX-License-Identifier: MIT
"""LOG.npy ROUNDS: processor seconds of sosfilt, of switching by three ways and of Welch; JSON on standard output."""
import json
import sys
import time

import numpy
import scipy.signal
from candidates import all_warm, by_segments, sections

log = numpy.load(sys.argv[1])
speed, torque = numpy.ascontiguousarray(log[:, 1]), numpy.ascontiguousarray(log[:, 2])
some = slice(0, 1_000_000)
TASKS = {
    "fixed": (torque[some], lambda: scipy.signal.sosfilt(sections(4), torque[some])),
    "all nine": (torque[some], lambda: all_warm(speed[some], torque[some])),
    "switching": (torque[some], lambda: by_segments(speed[some], torque[some])),
    "hysteresis": (torque[some], lambda: by_segments(speed[some], torque[some], hysteresis=1.0)),
    "welch": (torque, lambda: scipy.signal.welch(torque, 2000.0, nperseg=4096)),
}
taken = {name: [] for name in TASKS}
for turn in range(int(sys.argv[2]) + 1):
    for name, (_, task) in TASKS.items():
        began = time.process_time()
        task()
        if turn > 0:  # the first is not counted: imports, plans
            taken[name].append(time.process_time() - began)
print(json.dumps({name: {"work": len(TASKS[name][0]), "cpu_s": seconds} for name, seconds in taken.items()}))
