# SPDX-License-Identifier: MIT
"""Readers fed with what nobody would write."""

def prove(options):
    return []
