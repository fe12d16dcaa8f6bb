"""The best hypotheses of a size once more, with more rounds, and from what the best of them found for a cause."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor

from twin.fit.channel import Channel
from twin.fit.fitting import Fit, fit, starts_of

_ROUNDS, _TOLD_ROUNDS = 12, 8


def polished(channel: Channel, fits: Sequence[Fit], most: int, pool: Executor) -> list[Fit]:
    """The fits, the best `most` of them fitted on, by what they leave."""
    ranked = sorted(fits, key=lambda f: f.mse)
    better = list(pool.map(lambda f: fit(channel, f.space, [f.z], rounds=_ROUNDS), ranked[:most]))
    best = min(better, key=lambda f: f.mse)
    # What the best found for a cause may be what the others missed: rough valleys are found by chance.
    told = list(pool.map(lambda f: _told(channel, f, best), better))
    return sorted([*told, *ranked[most:]], key=lambda f: f.mse)


def _told(channel: Channel, one: Fit, best: Fit) -> Fit:
    """`one` fitted again from what `best` found for the causes that they share, where the response jumps."""
    rough = {c.name for c in one.space.causes if c.form is not None and not all(p.smooth for p in c.form.parameters)}
    if one is best or not rough & set(best.names):
        return one
    start = starts_of(one.space, [best, one])[0]
    count = len(one.space.numbers)
    start[:count] = one.z[:count]
    again = fit(channel, one.space, [start], rounds=_TOLD_ROUNDS)
    return min(one, again, key=lambda f: f.mse)
