# SPDX-License-Identifier: MIT
"""Logs with known hidden effects, and the measures of what `ripplenotch diagnose` says about them.

Nothing here calls ripplenotch's code to make a log: motion, effects and sensor are written anew from the formulas of
the catalogue and from textbooks, so that an error in the tool's catalogue is not repeated in its proof.
"""
