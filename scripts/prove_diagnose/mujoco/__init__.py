# SPDX-License-Identifier: MIT
"""Logs of an arm of three joints whose torque MuJoCo computed: rigid bodies, Coulomb friction, damping and ripple by other
authors' formulas. Effects are hidden at one joint; ripple of orders 1 and 2 is at all.
"""
