# SPDX-License-Identifier: MIT
"""Joint logs with a known truth, and what `ripplenotch identify` makes of them. Shares no code with the program."""
