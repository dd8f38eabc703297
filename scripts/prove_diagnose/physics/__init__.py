# SPDX-License-Identifier: MIT
"""Joints simulated from their equations of motion, in which effects are hidden; see study.py."""
