# SPDX-License-Identifier: MIT
"""The nine candidates of the table that scripts/bench-peers designs, as SciPy users write them."""
import numpy as np
import scipy.signal

RATE, RATIO, ORDERS, Q = 2000.0, 40.0, (1, 2), 5.0
EDGES = np.arange(20.0, 201.0, 20.0)  # deg/s; below the first and above the last the torque passes


def sections(band):
    middle = 0.5 * (EDGES[band] + EDGES[band + 1])
    return np.array([np.concatenate(scipy.signal.iirnotch(order * RATIO * middle / 360.0, Q, fs=RATE)) for order in ORDERS])


def all_warm(speed, torque):
    """Every candidate over the whole record, the output by band: what `switching` does by default."""
    speed, out = np.abs(speed), torque.copy()
    for band in range(len(EDGES) - 1):
        sos = sections(band)
        inside = (speed > EDGES[band]) & (speed <= EDGES[band + 1])
        out[inside] = scipy.signal.sosfilt(sos, torque, zi=scipy.signal.sosfilt_zi(sos) * torque[0])[0][inside]
    return out


def segments(speed):
    """(first, end, band) from one sample to the next that is in another band."""
    band = np.searchsorted(EDGES, np.abs(speed), side="left") - 1
    cuts = np.concatenate(([0], np.flatnonzero(np.diff(band)) + 1, [len(band)]))
    return [(first, end, band[first]) for first, end in zip(cuts[:-1], cuts[1:])]


def held_segments(speed, hysteresis):
    """The same, but a band is left only where |v| is further outside it than `hysteresis`. The next such sample is looked for
    in pieces that grow, so that neither a long stay nor a short one costs much."""
    speed, edges = np.abs(speed), np.concatenate(([-np.inf], EDGES, [np.inf]))
    found, first = [], 0
    while first < len(speed):
        band = int(np.searchsorted(EDGES, speed[first], side="left"))
        low, high = edges[band] - hysteresis, edges[band + 1] + hysteresis
        end, step = first, 2048
        while end < len(speed):
            piece = speed[end:end + step]
            left = (piece <= low) | (piece > high)
            at = int(left.argmax())
            if left[at]:
                end += at
                break
            end, step = end + len(piece), min(2 * step, 65536)
        found.append((first, end, band - 1))
        first = end
    return found


def by_segments(speed, torque, hysteresis=None):
    """One cascade whose memory stays while its coefficients change, a call of sosfilt from switch to switch."""
    bank = [sections(k) for k in range(len(EDGES) - 1)]
    out, memory = torque.copy(), np.zeros((len(ORDERS), 2))
    for first, end, band in segments(speed) if hysteresis is None else held_segments(speed, hysteresis):
        if 0 <= band < len(bank):
            out[first:end], memory = scipy.signal.sosfilt(bank[band], torque[first:end], zi=memory)
    return out
