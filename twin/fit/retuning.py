"""The design with nothing but its own numbers fitted to a channel."""

from __future__ import annotations

from collections.abc import Sequence

from twin.fit.channel import Channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import ACCUSED_SPREAD, Cause, make_space
from twin.model.effect import Scales
from twin.model.plant import Plant

_ROUNDS = 20
#: Mean squared residual, noise = 1, beyond which something is left that other numbers might explain.
_LEFT = 1.5


def retuned(channel: Channel, base: Plant, scales: Scales) -> Fit:
    """All design numbers of the channel together.

    They may get stuck on their way: of a design without a deadband, with a lag that stands for it. Where they leave
    something, they set out once more from the best of them alone, and from the best with one more.
    """
    space = make_space(base, (), channel.numbers, scales, ACCUSED_SPREAD)
    best = fit(channel, space, starts_of(space, (), channel.recordings), rounds=_ROUNDS)
    names: tuple[str, ...] = ()
    for _ in range(2):
        if best.mse < _LEFT or len(names) == len(channel.numbers):
            break
        more = [(*names, name) for name in channel.numbers if name not in names]
        few = min((_only(channel, base, scales, some) for some in more), key=lambda f: f.mse)
        names = few.space.numbers
        again = fit(channel, space, starts_of(space, [few], channel.recordings)[:1], rounds=_ROUNDS)
        best = min(best, again, key=lambda f: f.mse)
    return best


def _only(channel: Channel, base: Plant, scales: Scales, names: Sequence[str]) -> Fit:
    """These numbers only, the others as designed."""
    space = make_space(base, [Cause(f"parameter:{name}") for name in names], names, scales)
    return fit(channel, space, starts_of(space, (), channel.recordings))
