# SPDX-License-Identifier: MIT
"""Breaks ripplenotch on purpose. Each module is a part: prove(options) does the work and returns outcome.Rows."""
