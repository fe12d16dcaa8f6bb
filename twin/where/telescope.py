"""The exact split of the error over the stages of the signal chain.

With x(c) the full model, x(p) the model driven by the measured (smoothed) pressure and y the reading,

    y - x(c)  =  (y - x(p))  +  (x(p) - x(c))
    error     =  actuator or sensor  +  E/P,

and the share of a stage is the mean product of its term with the error. The shares add to 1 by construction; a
negative one means that the stage hides part of what another does.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from logs.recording import FloatArray
from twin.diagnosis import Share
from twin.where.ratio import ratio_interval

#: Standard error of a floor over the floor, where it was measured at rest or between repeats.
FLOOR_DOUBT = 0.05
# a total below so much of its own scatter, or below the floor's doubt, is nothing: shares of nothing are not given
_STANDARD_ERRORS = 4.0


def stage_shares(
    error: FloatArray,
    terms: Mapping[str, FloatArray],
    noise_sigma: float,
    noisy: str,
    correlation_samples: float = 1.0,
) -> dict[str, Share] | None:
    """Shares of the reducible squared error per stage; None where the error is not above its floor.

    `error` is reading minus full prediction, `terms` its addends per stage, all of shape (n,) in one unit; NaN rows
    are left out. The reading's noise, `noise_sigma`, enters through the term named `noisy` and is taken out of it.
    Raises: ValueError if the terms do not add to the error.
    """
    names = list(terms)
    stack = np.stack([terms[name] for name in names], axis=1)
    known = np.isfinite(error) & np.isfinite(stack).all(axis=1)
    stack, r = stack[known], error[known]
    if r.size == 0:
        return None
    if not np.allclose(stack.sum(axis=1), r, rtol=0.0, atol=1e-9 * max(1.0, float(np.abs(r).max()))):
        raise ValueError("the stage terms do not add to the error")
    products = stack * r[:, None]
    products[:, names.index(noisy)] -= noise_sigma**2
    return shares_of(products, names, least_excess(r.size, noise_sigma, correlation_samples), correlation_samples)


def least_excess(rows: int, noise_sigma: float, correlation_samples: float) -> float:
    """The sum of squares above the floor that `rows` rows need before there is anything to share out."""
    scatter = _STANDARD_ERRORS * float(np.sqrt(2.0 * correlation_samples / max(rows, 1)))
    return rows * noise_sigma**2 * max(scatter, FLOOR_DOUBT)


def two_stage_terms(reading: FloatArray, full: FloatArray, from_pressure: FloatArray) -> dict[str, FloatArray]:
    """The addends of the chain with a measured pressure: `ep` and `actuator_or_sensor`."""
    return {"ep": from_pressure - full, "actuator_or_sensor": reading - from_pressure}


def shares_of(
    contributions: FloatArray,
    names: list[str],
    least: float,
    correlation_samples: float = 1.0,
    signed: bool = True,
    block: int | None = None,
) -> dict[str, Share] | None:
    """Each column's share of the total of `contributions` (n, columns), with its 95 % interval.

    None unless the total is above `least`. Unless `signed`, columns below zero (quieter than the
    floor) count as zero. `block`: see `ratio_interval`.
    """
    totals = contributions.sum(axis=0)
    if contributions.shape[0] == 0 or not totals.sum() > least:
        return None
    whole = contributions.sum(axis=1) if signed else contributions[:, totals > 0.0].sum(axis=1)
    shares = (totals if signed else np.maximum(totals, 0.0)) / whole.sum()
    found = {}
    for k, name in enumerate(names):
        low, high = ratio_interval(contributions[:, k], whole, correlation_samples, block=block)
        ends = (low, high) if signed else (min(max(low, 0.0), shares[k]), max(min(high, 1.0), shares[k]))
        found[name] = Share(float(shares[k]), (float(ends[0]), float(ends[1])))
    return found
