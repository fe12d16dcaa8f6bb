"""The step of a quantized signal: the spacing of the lattice on which its values lie."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray

_LEAST_LEVELS = 8
_FIT = 0.12  # rms distance from the lattice in steps: values without a lattice have 0.29
_MOST = 200_000


def lattice_step(values: FloatArray) -> float | None:
    """The coarsest step whose lattice holds the values, in their unit; None where there is no lattice.

    Tolerates values rounded once more on the way into a file, and a few values off the lattice (false readings).
    """
    levels = np.unique(values[np.isfinite(values)][:_MOST])
    if levels.size < _LEAST_LEVELS:
        return None
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * max(float(np.abs(levels).max()), 1e-300)]
    if gaps.size < _LEAST_LEVELS - 1:
        return None
    candidates = sorted((float(np.quantile(gaps, q, method="nearest")) for q in (0.0, 0.02, 0.1, 0.5)), reverse=True)
    for candidate in candidates:
        step = _fitted(gaps, candidate)
        if step is not None:
            return step
    return None


def _fitted(gaps: FloatArray, candidate: float) -> float | None:
    """The step near the candidate that best explains the gaps as whole multiples; None if it does not."""
    near = gaps[np.abs(gaps / candidate - 1.0) < 0.4]
    step = float(np.mean(near))
    multiples = np.round(gaps / step)
    if np.mean(multiples < 1) > 0.01:
        return None
    # gaps between neighbours add up to a walk that leaves the lattice at once if it is none
    short = multiples <= 100
    index, place = np.cumsum(multiples[short]), np.cumsum(gaps[short])
    slope = float(np.sum(index * place) / np.sum(index * index))
    apart = place - slope * index
    apart -= np.median(apart)
    return slope if float(np.median(np.abs(apart))) < _FIT * slope else None
