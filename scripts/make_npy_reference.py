#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the NumPy files in tests/log/data with NumPy itself, so that the reader is tested against the real writer.

usage: scripts/make_npy_reference.py [FOLDER]      needs python3-numpy; the files in the repository came from 1.24.2

All hold the same five rows: time 0, 0.01 ... s; velocity 10 ... 14 deg/s; torque 2.5, -0.25, 100, 0.125, -3 Nm;
position 0, 0.1 ... deg.
"""

import pathlib
import sys
import warnings

import numpy
from numpy.lib import format as npy

FOLDER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent / "tests/log/data")
TIME = numpy.arange(5) / 100
VELOCITY = 10.0 + numpy.arange(5)
TORQUE = numpy.array([2.5, -0.25, 100, 0.125, -3])
POSITION = numpy.arange(5) / 10


def structured(fields, **columns):
    array = numpy.zeros(5, dtype=fields)
    for name, values in columns.items():
        array[name] = values
    return array


def write(name, array, version=None):
    with open(FOLDER / name, "wb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        npy.write_array(file, array, version=version, allow_pickle=True)


columns = {"time_s": TIME, "velocity_deg_s": VELOCITY, "torque_Nm": TORQUE, "position_deg": POSITION}
write("structured_f8.npy", structured([(n, "<f8") for n in columns], **columns))
write("structured_f8_v2.npy", structured([(n, "<f8") for n in columns], **columns), (2, 0))
write("structured_f8_v3.npy", structured([(n, "<f8") for n in columns], **columns), (3, 0))
write("structured_big_endian_f4.npy", structured([(n, ">f4") for n in columns], **columns))
write("structured_mixed.npy", structured(
    [("count", "<u4"), ("time [ms]", "<i8"), ("tau [mNm]", ">i4"), ("flag", "?"), ("dq [deg/s]", "<u2"), ("note", "S3"), ("q [deg]", "<f4")],
    **{"count": numpy.arange(5), "time [ms]": 10 * numpy.arange(5), "tau [mNm]": 1000 * TORQUE, "dq [deg/s]": VELOCITY,
       "note": b"abc", "q [deg]": POSITION}))
robot = numpy.zeros(5, dtype=[("time_s", "<f8"), ("q", "<f8", (2,)), ("dq", "<f8", (2,)), ("tau", "<f8", (2,))])
robot["time_s"], robot["q"][:, 1], robot["dq"][:, 1], robot["tau"][:, 1] = TIME, POSITION, VELOCITY, TORQUE
robot["q"][:, 0], robot["dq"][:, 0], robot["tau"][:, 0] = -POSITION, -VELOCITY, -TORQUE
write("structured_two_joints.npy", robot)
write("structured_aligned.npy", structured(numpy.dtype([("valid", "i1"), ("time_s", "<f8"), ("velocity_deg_s", "<f4"), ("torque_Nm", "<f8")], align=True),
                                           **{k: v for k, v in columns.items() if k != "position_deg"}))
plain = numpy.column_stack([TIME, VELOCITY, TORQUE, POSITION])
write("plain_f8.npy", plain)
write("plain_f4_three.npy", plain[:, :3].astype("<f4"))
write("plain_fortran.npy", numpy.asfortranarray(plain))
write("refused_objects.npy", numpy.array([["a", 1], ["b", 2]], dtype=object))
write("refused_three_dimensions.npy", numpy.zeros((2, 2, 3)))
write("refused_text.npy", numpy.array(["abc", "def"]))
write("refused_empty.npy", numpy.zeros((0, 3)))
