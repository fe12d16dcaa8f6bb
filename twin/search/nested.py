"""A form with the numbers of a plainer one, and more, is looked at once more where the plainer one ended.

Mostly it can do all that the plainer one does. Where it leaves less there than where it had ended itself, its starts
were too far off, and it is fitted again from there. The plainest form of an effect is none, beside re-tuned numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from itertools import product

import numpy as np

from logs.recording import FloatArray
from twin.fit.channel import Channel
from twin.fit.fitting import Fit, copy_numbers, fit, starts_of
from twin.fit.space import Unknown, cause_starts, make_space

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


def beyond_retuning(channel: Channel, fits: Sequence[Fit], retuned: Fit, rounds: int, pool: Executor) -> list[Fit]:
    """The fits; those of an effect fitted again that cost more than the re-tuned numbers do without any effect.

    Every effect has the numbers beside it, so that none need cost more: it got stuck, with numbers moved far at once to
    do what the effect should have done. It is fitted again from the re-tuned numbers, and from where its own unknowns
    end alone while the numbers stay as designed.
    """

    def again(one: Fit) -> Fit:
        numbers = np.zeros_like(one.z)  # the re-tuned ones, beside an effect without a size
        copy_numbers(numbers, one.space, retuned)
        rides = bool(_numbers(one)) and bool(one.space.numbers)  # numbers that ride along with an effect
        if not rides or retuned.mse > _LESS * one.mse or cost(channel, one, numbers) > cost(channel, one):
            return one
        alone = make_space(one.space.base, one.space.causes, (), one.space.scales)
        own = fit(channel, alone, starts_of(alone, (), channel.recordings), rounds=rounds).z
        designed = np.concatenate([np.zeros(len(one.space.numbers)), own])
        tried = [one, *(fit(channel, one.space, [z], rounds=2 * rounds) for z in (numbers, designed))]
        return min(tried, key=lambda f: cost(channel, f))

    return list(pool.map(again, fits))


def cost(channel: Channel, one: Fit, z: FloatArray | None = None) -> float:
    """What a fit minimises: squared residuals over the noise and what its prior asks, where it ended or at `z`."""
    if z is None:
        return one.mse * channel.rows + one.prior
    residuals = channel.residuals(one.space.plant(z))
    return float(residuals @ residuals + np.sum((z / one.space.spreads) ** 2))


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
