# SPDX-License-Identifier: MIT
"""Rigid bodies of a serial arm: how much torque each inertial value of each link brings at each joint.

Ten values a link, about the origin of its frame: mass, first moments x y z, inertia xx xy xz yy yz zz. Torque is linear in
them (Khalil and Dombre, 2002, chapter 9). Written from the equations of Newton and Euler, apart from the tool's.
"""

import numpy as np

VALUES = 10  # of a link


class Chain:
    """Joints that turn about the z axis of their frame, each at a fixed place on the link before it."""

    def __init__(self, turned, placed):
        self.turned, self.placed = turned, placed

    def __len__(self):
        return len(self.turned)


def about_x(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def about_z(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def of_table(kind, rows):
    """kind: "mdh" (Craig) or "dh"; rows of a (m), alpha (deg), d (m), theta (deg)."""
    turned, placed, after = [], [], (np.eye(3), np.zeros(3))
    for a, alpha, d, theta in rows:
        tilt, turn = about_x(np.radians(alpha)), about_z(np.radians(theta))
        if kind == "mdh":
            turned.append(tilt @ turn)
            placed.append(np.array([a, 0, 0]) + tilt @ [0, 0, d])
        else:
            turned.append(after[0] @ turn)
            placed.append(after[1])
            after = tilt, np.array([a, 0.0, d])
    return Chain(turned, placed)


def cross_matrix(v):
    """Matrices that do what the cross product with v does; v: rows of 3."""
    x, y, z = v.T
    o = np.zeros_like(x)
    return np.stack([np.stack([o, -z, y], -1), np.stack([z, o, -x], -1), np.stack([-y, x, o], -1)], -2)


def times_inertia(w):
    """Matrices that give inertia times w from xx xy xz yy yz zz."""
    x, y, z = w.T
    o = np.zeros_like(x)
    return np.stack([np.stack([x, y, z, o, o, o], -1), np.stack([o, x, o, y, z, o], -1), np.stack([o, o, x, o, y, z], -1)], -2)


def link_wrenches(chain, q, dq, ddq, gravity):
    """(rotations to the link before, wrenches): of each link moment and force for each of its values, rows by 6 by 10."""
    rows = len(q)
    w, dw, a = np.zeros((rows, 3)), np.zeros((rows, 3)), np.tile(-np.asarray(gravity, float), (rows, 1))
    z, rotations, wrenches = np.array([0.0, 0.0, 1.0]), [], []
    for i in range(len(chain)):
        c, s, o, one = np.cos(q[:, i]), np.sin(q[:, i]), np.zeros(rows), np.ones(rows)
        turn = np.stack([np.stack([c, -s, o], -1), np.stack([s, c, o], -1), np.stack([o, o, one], -1)], -2)
        rotation = chain.turned[i] @ turn
        at = a + np.cross(dw, chain.placed[i]) + np.cross(w, np.cross(w, chain.placed[i]))
        w, dw, a = (np.einsum("nji,nj->ni", rotation, v) for v in (w, dw, at))
        dw = dw + ddq[:, i : i + 1] * z + np.cross(w, dq[:, i : i + 1] * z)
        w = w + dq[:, i : i + 1] * z
        spin = cross_matrix(w)
        wrench = np.zeros((rows, 6, VALUES))
        wrench[:, 3:, 0] = a
        wrench[:, 3:, 1:4] = cross_matrix(dw) + spin @ spin
        wrench[:, :3, 1:4] = -cross_matrix(a)
        wrench[:, :3, 4:] = times_inertia(dw) + spin @ times_inertia(w)
        rotations.append(rotation)
        wrenches.append(wrench)
    return rotations, wrenches


def regressor(chain, q, dq, ddq, gravity=(0, 0, -9.81)):
    """Rows by joints by values of all links: torque of a joint = its slice times the values. Radians."""
    rotations, wrenches = link_wrenches(chain, q, dq, ddq, gravity)
    torque = np.zeros((len(q), len(chain), VALUES * len(chain)))
    for link, wrench in enumerate(wrenches):
        for joint in range(link, -1, -1):
            torque[:, joint, VALUES * link : VALUES * (link + 1)] = wrench[:, 2]
            moment, force = rotations[joint] @ wrench[:, :3], rotations[joint] @ wrench[:, 3:]
            arm = np.tile(chain.placed[joint], (len(q), 1))
            wrench = np.concatenate([moment + cross_matrix(arm) @ force, force], 1)
    return torque
