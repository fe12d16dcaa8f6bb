"""Intervals for counts and for anything else: a rate without one is an anecdote."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")

_Z = 1.959964
_REPLICATES = 1000


def wilson(hits: int, of: int) -> tuple[float, float]:
    """95 % interval of a proportion. Source: Wilson, J. Am. Stat. Assoc. 22 (1927) 209."""
    if of == 0:
        return 0.0, 1.0
    share, extra = hits / of, _Z**2 / of
    middle = (share + extra / 2.0) / (1.0 + extra)
    half = _Z / (1.0 + extra) * np.sqrt(share * (1.0 - share) / of + extra / (4.0 * of))
    return max(0.0, float(middle - half)), min(1.0, float(middle + half))


def rate(marks: Sequence[bool]) -> dict[str, Any]:
    """Hits, trials, their share (None without trials) and its interval."""
    hits, of = sum(marks), len(marks)
    return {"hits": hits, "of": of, "share": hits / of if of else None, "ci95": list(wilson(hits, of))}


def share(marks: Sequence[bool], digits: int = 0) -> str:
    """The share of hits with its interval, for people: `90 % (83 to 94 %)`."""
    low, high = wilson(sum(marks), len(marks))
    percent = 100.0 * sum(marks) / len(marks)
    return f"{percent:.{digits}f} % ({100.0 * low:.{digits}f} to {100.0 * high:.{digits}f} %)"


def bootstrap(items: Sequence[T], statistic: Callable[[Sequence[T]], float], seed: int = 0) -> tuple[float, float]:
    """95 % percentile interval of a statistic of independent items, by resampling them. Source: Efron (1979)."""
    chance = np.random.default_rng(seed)
    values = [statistic([items[k] for k in chance.integers(0, len(items), len(items))]) for _ in range(_REPLICATES)]
    known = np.array([v for v in values if np.isfinite(v)])
    if not known.size:
        return float("nan"), float("nan")
    low, high = np.percentile(known, [2.5, 97.5])
    return float(low), float(high)


def by_trial(trials: Sequence[Sequence[float]], statistic: Callable[[Sequence[float]], float]) -> tuple[float, float]:
    """95 % interval of a statistic of all that trials hold, by resampling trials: what one holds stands together."""

    def pooled(some: Sequence[Sequence[float]]) -> float:
        values = [value for trial in some for value in trial]
        return statistic(values) if values else float("nan")

    return bootstrap(trials, pooled)


def median(values: Sequence[float]) -> dict[str, Any]:
    """Median of values that have nothing to do with each other, with its interval; None without values."""
    return median_by_trial([[value] for value in values])


def median_by_trial(trials: Sequence[Sequence[float]]) -> dict[str, Any]:
    """Median of all that the trials hold, `of` so many values, with the interval of `by_trial`; None without values."""
    values = [value for trial in trials for value in trial]
    if not values:
        return {"median": None, "of": 0, "ci95": None}
    low, high = by_trial(trials, lambda v: float(np.median(v)))
    return {"median": float(np.median(values)), "of": len(values), "ci95": [low, high]}
