"""A form with the numbers of a plainer one, and more, is looked at once more where the plainer one ended.

Mostly it can do all that the plainer one does. Where it leaves less there than where it had ended itself, its starts
were too far off, and it is fitted again from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from itertools import product

import numpy as np

from logs.recording import FloatArray
from twin.fit.channel import Channel
from twin.fit.fitting import Fit, fit
from twin.fit.space import Unknown, cause_starts

#: Of what a form leaves; a plainer one that leaves less than that has found what the form missed.
_LESS = 0.99


def nested(channel: Channel, fits: Sequence[Fit], rounds: int, pool: Executor) -> list[Fit]:
    """The fits; of the single causes those fitted again that leave less where a plainer form of theirs ended."""

    def left(one: Fit, z: FloatArray) -> float:
        residuals = channel.residuals(one.space.plant(z))
        return float(residuals @ residuals) / channel.rows

    def again(one: Fit) -> Fit:
        plain = _plainer(one, fits)
        better = [z for z in (_starts(one, plain) if plain else []) if left(one, z) < one.mse]
        return min(one, fit(channel, one.space, better, rounds=rounds), key=lambda f: f.mse) if better else one

    return list(pool.map(again, fits))


def _plainer(one: Fit, fits: Sequence[Fit]) -> Fit | None:
    """Of the same effect the best form that has some of the numbers of `one` and leaves less; None where none does."""
    own = _numbers(one)
    found = [f for f in fits if f.names == one.names and _numbers(f) < own and f.mse < _LESS * one.mse]
    return min(found, key=lambda f: f.mse, default=None)


def _numbers(one: Fit) -> frozenset[str]:
    """The names of the effect's own numbers; empty for a design number."""
    return frozenset(p.name for c in one.space.causes if c.form is not None for p in c.form.parameters)


def _starts(one: Fit, plain: Fit) -> list[FloatArray]:
    """Where `plain` ended; what only `one` has at its neutral value and at each of its own starts."""
    count = len(one.space.numbers)
    own = np.array(cause_starts(one.space.causes[0], one.space.scales, dense=False))
    ended = {u.label: value for u, value in zip(plain.space.unknowns, plain.values(), strict=True)}
    options = [
        [(ended[u.label] - u.centre) / u.unit] if u.label in ended else _inside(u, own[:, k - count])
        for k, u in enumerate(one.space.unknowns)
    ]
    return [np.array(z) for z in product(*options)]


def _inside(unknown: Unknown, own: FloatArray) -> list[float]:
    """Its neutral value and its starts, as far as it may go."""
    return sorted({float(np.clip(z, unknown.lower, unknown.upper)) for z in (0.0, *own)})
