"""Several design numbers wrong at once, as in a model of another valve: no search by ones and twos comes upon them.

A design that is off in everything is explained by re-tuning it. Without this hypothesis some effect would be named, of
hardly any size, that brings all numbers along as its nuisances.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from twin.fit.fitting import Fit
from twin.fit.space import Cause

#: Pairs are fitted anyway.
_FEWEST = 3
#: Mean squared error of the design (noise = 1) below which there is no gap to explain.
_QUIET = 2.0

Refit = Callable[[tuple[Cause, ...], Fit], Fit]


def several_slips(slips: Sequence[Cause], none: Fit, retuned: Fit, refit: Refit, rest: float) -> list[Fit]:
    """All of `slips` together, and the best with one fewer each time, down to three; what matters is chosen later.

    Empty where there is no gap, or where re-tuning leaves more than the share `rest` of it. `refit` fits causes from
    where another hypothesis ended.
    """
    if none.mse < _QUIET or retuned.mse - 1.0 > rest * (none.mse - 1.0) or len(slips) < _FEWEST:
        return []
    found = [refit(tuple(slips), retuned)]
    while len(causes := found[-1].space.causes) > _FEWEST:
        fewer = [refit(causes[:k] + causes[k + 1 :], found[-1]) for k in range(len(causes))]
        found.append(min(fewer, key=lambda f: f.mse))
    return found
