"""Are the probabilities honest? Of the causes named with 0.9, nine in ten should be right."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from app.interval import bootstrap, wilson
from logs.recording import FloatArray

Claim = tuple[float, bool]  # probability said, and whether the cause was true

_DRAWS = 1000
_SAME = 1e-12  # errors that differ by rounding only are the same
EDGES = (0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0)


def calibration(trials: Sequence[Sequence[Claim]]) -> dict[str, Any]:
    """Curve, expected calibration error with its bootstrap interval, Brier score; `trials` holds each trial's claims.

    Trials are resampled and not claims, because the claims of one trial stand and fall together.
    """
    claims = [claim for trial in trials for claim in trial]
    if not claims:
        return {"claims": 0, "ece": None, "ci95": None, "honest": None, "brier": None, "curve": []}
    low, high = bootstrap(trials, lambda some: error([c for trial in some for c in trial]))
    return {
        "claims": len(claims),
        "ece": error(claims),
        "ci95": [low, high],
        "honest": honest(claims),
        "brier": float(np.mean([(p - right) ** 2 for p, right in claims])),
        "curve": curve(claims),
    }


def honest(claims: Sequence[Claim], seed: int = 0) -> dict[str, Any]:
    """What the error would be by chance alone if every probability that was said were true.

    The error is a mean of distances, so it is never 0 with few claims, however honest they are. `mean` and `range95` of
    it, and `above`: how often it would be at least as large as it was found. Claims are drawn one by one, so what
    claims of one trial have in common is not in it, and the true range is a little wider.
    Source: Broecker, Smith, Weather and Forecasting 22 (2007) 651 (consistency resampling).
    """
    chance = np.random.default_rng(seed)
    said = np.array([p for p, _ in claims])
    drawn = chance.random((_DRAWS, said.size)) < said
    errors = np.abs((said - drawn) @ _membership(said)).sum(axis=1) / said.size
    low, high = np.percentile(errors, [2.5, 97.5])
    above = float(np.mean(errors >= error(claims) - _SAME))
    return {"mean": float(errors.mean()), "range95": [float(low), float(high)], "above": above}


def error(claims: Sequence[Claim]) -> float:
    """Mean distance of what was said from what was true, weighted by the number of claims in each bin.

    NaN without claims. Source: Naeini, Cooper, Hauskrecht, AAAI 2015.
    """
    if not claims:
        return float("nan")
    said, right = np.array(claims, dtype=np.float64).T
    return float(np.abs((said - right) @ _membership(said)).sum() / said.size)


def _membership(said: FloatArray) -> FloatArray:
    """1 where a claim is in a bin, shape (claims, bins): what is summed over it is compared bin by bin."""
    return np.eye(len(EDGES) - 1)[_bins(said)]


def _bins(said: FloatArray) -> npt.NDArray[np.int64]:
    """The bin of each probability; 1.0 is in the last."""
    return np.clip(np.searchsorted(EDGES, said, side="right") - 1, 0, len(EDGES) - 2)


def curve(claims: Sequence[Claim]) -> list[dict[str, Any]]:
    """Per bin that holds claims: the mean probability said, the share that was right, and its interval."""
    bins = []
    which = _bins(np.array([p for p, _ in claims], dtype=np.float64))
    for number in range(len(EDGES) - 1):
        inside = [claim for claim, k in zip(claims, which, strict=True) if k == number]
        if inside:
            hits = sum(right for _, right in inside)
            bins.append(
                {
                    "from": EDGES[number],
                    "to": EDGES[number + 1],
                    "claims": len(inside),
                    "said": float(np.mean([p for p, _ in inside])),
                    "right": hits / len(inside),
                    "ci95": list(wilson(hits, len(inside))),
                }
            )
    return bins
