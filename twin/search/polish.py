"""The best hypotheses of a size once more, with more rounds, and from what the best of them found for a cause."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from functools import partial

import numpy as np
from scipy.optimize import differential_evolution

from logs.recording import FloatArray
from twin.fit.channel import Channel
from twin.fit.fitting import Fit, evaluated, fit, starts_of
from twin.fit.space import Cause

_ROUNDS, _TOLD_ROUNDS = 12, 8
#: How far off the best found so far (standard deviation of their logarithm) a population first looks again at numbers
#: of a form to which the response jumps; by what factor at most, as a logarithm; and over how many generations. So each
#: of 14 starts within a third of the truth led to it, where a descent alone found it from two (`test_polish.py`).
_SPREADS, _FARTHEST, _GENERATIONS = np.geomspace(0.5, 0.02, 24), 1.0, 20
#: Error, noise = 1, below which there is nothing left to look for.
_NOTHING = 1.02
#: A place or a period that is looked for at so many starts has valleys between them.
_PLACES = 3


def polished(channel: Channel, fits: Sequence[Fit], most: int, pool: Executor) -> list[Fit]:
    """The fits, the best `most` of them fitted on, by what they leave."""
    ranked = sorted(fits, key=lambda f: f.mse)
    better = list(pool.map(lambda f: fit(channel, f.space, [f.z], rounds=_ROUNDS), ranked[:most]))
    first = min(range(len(better)), key=lambda k: better[k].mse)
    best = better[first] = _about(channel, better[first], pool)
    # What the best found for a cause may be what the others missed: rough valleys are found by chance.
    told = list(pool.map(lambda f: _told(channel, f, best), better))
    return sorted([*told, *ranked[most:]], key=lambda f: f.mse)


def _told(channel: Channel, one: Fit, best: Fit) -> Fit:
    """`one` fitted again from what `best` found for the causes that they share, where valleys are narrow."""
    shared = {c.name for c in one.space.causes if _has_valleys(c)} & set(best.names)
    if one is best or not shared:
        return one
    start = starts_of(one.space, [best, one])[0]
    count = len(one.space.numbers)
    start[:count] = one.z[:count]
    again = fit(channel, one.space, [start], rounds=_TOLD_ROUNDS)
    return min(one, again, key=lambda f: f.mse)


def _about(channel: Channel, one: Fit, pool: Executor) -> Fit:
    """`one`, or the fit from somewhere about it in the forms whose valleys are narrow, if that leaves less.

    By differential evolution: narrow valleys side by side have no slope that leads from one to the next.
    Source: Storn, Price, Journal of Global Optimization 11 (1997) 341.
    """
    places = _narrow_places(one)
    if not places or one.mse < _NOTHING:
        return one
    first = _SPREADS[:, None] * np.random.default_rng(0).standard_normal((_SPREADS.size, len(places)))
    first[0] = 0.0
    found = differential_evolution(
        partial(_left, channel, one, places),
        [(-_FARTHEST, _FARTHEST)] * len(places),
        init=np.clip(first, -_FARTHEST, _FARTHEST),
        maxiter=_GENERATIONS,
        tol=0.0,
        polish=False,
        rng=0,
        updating="deferred",
        workers=pool.map,
    )
    return min(one, fit(channel, one.space, [_moved(one, places, found.x)], rounds=_TOLD_ROUNDS), key=lambda f: f.mse)


def _has_valleys(cause: Cause) -> bool:
    """Whether the form is one whose response jumps, or that is looked for at several places."""
    parameters = cause.form.parameters if cause.form is not None else ()
    return any(not p.smooth or (not p.size and len(p.starts) >= _PLACES) for p in parameters)


def _narrow_places(one: Fit) -> list[int]:
    """Where in z the parameters stand of the forms whose valleys are narrow."""
    at, places = len(one.space.numbers), list[int]()
    for cause in one.space.causes:
        count = len(cause.form.parameters) if cause.form is not None else 0
        if _has_valleys(cause):
            places += range(at, at + count)
        at += count
    return places


def _moved(one: Fit, places: Sequence[int], by: FloatArray) -> FloatArray:
    """Where `one` is in z, with the values at the places changed by the factors exp(by)."""
    z, values = one.z.copy(), one.values()
    for k, factor in zip(places, np.exp(by), strict=True):
        unknown = one.space.unknowns[k]
        z[k] = (factor * values[k] - unknown.centre) / unknown.unit
    return np.clip(z, one.space.lower, one.space.upper)


def _left(channel: Channel, one: Fit, places: Sequence[int], by: FloatArray) -> float:
    return evaluated(channel, one.space, _moved(one, places, by)).mse
