# SPDX-License-Identifier: MIT
"""IN.npy OUT.npy: load, the candidates, save."""
import sys

import numpy
from candidates import all_warm

log = numpy.load(sys.argv[1])
log[:, 2] = all_warm(log[:, 1], numpy.ascontiguousarray(log[:, 2]))
numpy.save(sys.argv[2], log)
