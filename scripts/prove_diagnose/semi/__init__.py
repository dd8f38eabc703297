# SPDX-License-Identifier: MIT
"""Semi-synthetic logs: the motion of a real robot, the torque of its rigid bodies, a real leftover, and hidden effects of
known size. The truth is known and the leftover is none that a generator made up.
"""
