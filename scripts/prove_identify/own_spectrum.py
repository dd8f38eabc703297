# SPDX-License-Identifier: MIT
"""Lines over a coordinate (the measured angle, or time) by sums of this script's own: where nothing is, how large the noise is
at an order, and a torque without its lines. Angles in turns."""

import math

import numpy as np

AVERAGED = 8  # independent cells in the medians that a cell is compared with
CYCLES = 4  # of a line in a sweep, below which it is not told from what changes slowly


def runs(time, turns, least=0.03):
    """Index ranges in which the joint turns one way by a thirtieth of a turn or more."""
    width = max(1, int(round(0.03 / np.median(np.diff(time)))))
    ends = np.pad(turns, width, mode="reflect", reflect_type="odd")
    smooth = np.convolve(ends, np.full(2 * width + 1, 1.0 / (2 * width + 1)), mode="valid")
    speed = np.gradient(smooth)
    way = np.where(np.abs(speed) < 0.03 * np.quantile(np.abs(speed), 0.95), 0, np.sign(speed))
    borders = np.flatnonzero(np.concatenate([[True], np.diff(way) != 0, [True]]))
    return [(a, b) for a, b in zip(borders[:-1], borders[1:]) if way[a] and abs(turns[b - 1] - turns[a]) >= least and b - a > 40]


def fitted(basis, values, weight):
    root = np.sqrt(weight)
    return np.linalg.lstsq(basis * root[:, None], values * root, rcond=None)[0]


class Spectrum:
    """Of each sweep with a Hann window over the coordinate, all on one grid of orders."""

    def __init__(self, torque, along, rows, lowest=12.0, share=0.4, fast=0.9):
        """To `share` cycles a sample at the `fast` quantile of the speed of each sweep."""
        self.torque, self.along, self.first = torque.astype(float), along, {}
        self.rows = [(a, b) for a, b in rows if np.ptp(along[a:b]) > 0]
        self.spans = [float(np.ptp(along[a:b])) for a, b in self.rows]
        self.step_of = np.abs(np.gradient(along))
        self.tops = [share / max(1e-12, float(np.quantile(self.step_of[a:b], fast))) for a, b in self.rows]
        self.span = max(self.spans, default=1.0)
        self.lowest, self.highest = max(lowest, (CYCLES + 1) / self.span), min(4000.0, max(self.tops, default=0.0))
        self.bins = 2 ** math.ceil(math.log2(6 * self.highest + 1))
        self.count = 2 ** math.ceil(math.log2(self.bins * self.span / 0.3))
        self.step = self.bins / self.count
        self.orders = self.step * np.arange(int(self.highest / self.step) + 1)
        self.searched = self.orders > self.lowest

    def usable(self):
        return bool(self.rows) and np.count_nonzero(self.searched) > 100

    def slow(self, a, b):
        """What changes slower than the lowest order, as cosines over the sweep. Not the speed: it has the ripple in it."""
        share = (self.along[a:b] - self.along[a]) / (self.along[b - 1] - self.along[a])
        waves = np.cos(math.pi * share[:, None] * np.arange(int(self.lowest * np.ptp(self.along[a:b])) + 3))
        return np.column_stack([waves, share])

    def weight(self, a, b):
        """A Hann window over the coordinate, whatever the time that each part of it takes."""
        along = self.along[a:b]
        return np.sin(math.pi * (along - along.min()) / np.ptp(along)) ** 2 * self.step_of[a:b]

    def amplitudes(self):
        """For each sweep: complex sum over orders, sum of weights, local power of the noise (infinite where it says nothing)."""
        for k, ((a, b), span, top) in enumerate(zip(self.rows, self.spans, self.tops)):
            along, weight, slow = self.along[a:b], self.weight(a, b), self.slow(a, b)
            rest = self.torque[a:b] - slow @ fitted(slow, self.torque[a:b], weight)
            place = ((along - along.min()) * self.bins).astype(int)
            sums = np.fft.rfft(np.bincount(place, weight * rest, self.count))[: len(self.orders)]
            told = (self.orders < top) & (self.orders * span >= CYCLES)
            noise = self.local(np.abs(sums) ** 2, span)
            # Each line that is subtracted takes noise with it: where many were, nothing but holes would be compared with.
            noise = np.maximum(noise, 0.5 * self.first.setdefault(k, noise))
            yield sums, weight.sum(), np.where(told, noise, np.inf)

    def local(self, power, span):
        """Mean power of the noise at each order, from the medians of 12 cells on either side, two cells away; what changes slowly was
        taken off below, and takes noise with it."""
        first = min(int(CYCLES / span / self.step), len(power) - 1)
        apart = max(1, int(round(0.5 / span / self.step)))
        coarse = power[first::apart]
        if len(coarse) < 32:
            return np.full(len(power), np.median(coarse) / math.log(2) + 1e-300)
        middle = np.median(np.lib.stride_tricks.sliding_window_view(np.pad(coarse, 27, mode="reflect"), 24), axis=1)
        both = np.sqrt(middle[: len(coarse)] * middle[31 : 31 + len(coarse)]) / math.log(2)
        return np.interp(np.arange(len(power)), first + apart * np.arange(len(coarse)), both) + 1e-300

    def looked_at(self):
        """(-ln p of each order under noise alone with any phase in each sweep, standard error of an amplitude there)."""
        total, sweeps, told = (np.zeros(len(self.orders)) for _ in range(3))
        for sums, weight, noise in self.amplitudes():
            ratio = np.abs(sums) ** 2 / noise
            total += AVERAGED * np.log1p(ratio / AVERAGED)
            sweeps += np.isfinite(noise)
            told += weight**2 / (2 * noise)
        terms = [np.where(k < sweeps, k * np.log(np.maximum(total, 1e-12)) - math.lgamma(k + 1), -np.inf) for k in range(len(self.rows))]
        evidence = np.where(sweeps > 0, total - np.logaddexp.reduce(terms, axis=0), 0.0)
        return np.where(self.searched, evidence, 0.0), 1.0 / np.sqrt(np.maximum(told, 1e-300))

    def cells(self):
        """Independent orders that were looked at: 1.5 a cell, with a Hann window."""
        return 1.5 * self.span * (self.highest - self.lowest)

    def remove(self, order):
        """Takes a line with a slow course of amplitude and phase out of the torque of each sweep."""
        for (a, b), span in zip(self.rows, self.spans):
            if order * span < CYCLES:
                continue
            along, slow = self.along[a:b], self.slow(a, b)
            course = ((along - along.mean()) / span)[:, None] ** np.arange(3 if order * span > 15 else 1)
            waves = [wave(2 * math.pi * order * along)[:, None] * course for wave in (np.cos, np.sin)]
            basis = np.column_stack([*waves, slow])
            found = fitted(basis, self.torque[a:b], self.weight(a, b))
            found[2 * course.shape[1] :] = 0.0
            self.torque[a:b] -= basis @ found


def without_lines(time, torque, turns):
    """The torque without what stands out over the angle, or over time, so far that every other log of noise would not show it; None
    where it stays, as the motion's own does."""
    rows = runs(time, turns)
    for along, lowest in ((turns, 12.0), (time - time[0], 1.0), (turns, 12.0)):
        spectrum = Spectrum(torque, along, rows, lowest, 0.5, 0.5)
        removed = []
        while spectrum.usable():
            evidence, _ = spectrum.looked_at()
            if evidence.max() < math.log(2 * spectrum.cells()):
                break
            removed.append(spectrum.orders[int(evidence.argmax())])
            if removed.count(removed[-1]) > 2 or len(removed) > 150:
                return None
            spectrum.remove(removed[-1])
        torque = spectrum.torque
    return torque
