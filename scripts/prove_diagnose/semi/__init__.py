# SPDX-License-Identifier: MIT
"""Semi-synthetic logs: the motion of a real robot, the torque of its rigid bodies, a real residual, and hidden effects of
known size. The truth is known and the residual is none that a generator made up.
"""
