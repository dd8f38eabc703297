# SPDX-License-Identifier: MIT
"""IN.csv OUT.csv 6|shortest: read_csv, the candidates, to_csv."""
import sys

import pandas
from candidates import all_warm

log = pandas.read_csv(sys.argv[1])
log["torque_nm"] = all_warm(log["velocity_deg_s"].to_numpy(), log["torque_nm"].to_numpy())
log.to_csv(sys.argv[2], index=False, float_format=None if sys.argv[3] == "shortest" else f"%.{sys.argv[3]}f")
