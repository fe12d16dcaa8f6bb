"""Of a free curve, what the record never felt goes back to nothing.

Where a valve has not been, a curve through a dozen points may do what it likes, and the search leaves it where it came
by. The updated model would believe that, and predict worse than the design there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from logs.recording import FloatArray
from twin.fit.channel import Channel
from twin.fit.fitting import Fit

#: Numbers of a form that is a free curve, at least.
_FREE = 6
#: What a number takes off the cost at least if it is felt, noise = 1. Chance alone does that 1 time in 2000; a start of
#: a record that is not quite understood does most of it, by friction at places that the stem passed once.
_FELT = 12.0


def without_unfelt(channel: Channel, one: Fit, phi: float) -> Fit:
    """`one` with those sizes of its free curves at nothing that make no difference; itself where all do.

    `phi`: residual samples worth one independent one.
    """
    sizes = _free_sizes(one)
    if not sizes:
        return one
    z, residuals = one.z.copy(), channel.residuals(one.plant)
    for k in sorted(sizes, key=lambda k: _felt(channel, one, z, residuals, k)[0]):
        felt, without = _felt(channel, one, z, residuals, k)
        if felt < _FELT * phi:
            z[k], residuals = 0.0, without
    if np.array_equal(z, one.z):
        return one
    prior = float(np.sum((z / one.space.spreads) ** 2))
    return replace(one, z=z, residuals=residuals, mse=float(residuals @ residuals) / max(channel.rows, 1), prior=prior)


def _free_sizes(one: Fit) -> list[int]:
    """The unknowns that are sizes of a form with many."""
    found, at = [], len(one.space.numbers)
    for cause in one.space.causes:
        parameters = cause.form.parameters if cause.form is not None else ()
        if len(parameters) >= _FREE:
            found += [at + k for k, p in enumerate(parameters) if p.size]
        at += len(parameters)
    return [k for k in found if one.z[k] != 0.0]


def _felt(channel: Channel, one: Fit, z: FloatArray, residuals: FloatArray, k: int) -> tuple[float, FloatArray]:
    """By how much the cost rises without an unknown, and the residuals then."""
    without = z.copy()
    without[k] = 0.0
    then = channel.residuals(one.space.plant(without))
    prior = (z[k] / one.space.spreads[k]) ** 2
    return float(then @ then - residuals @ residuals - prior), then
