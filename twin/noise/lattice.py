"""The step of a quantized signal: the spacing of the lattice on which its values lie."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray

_LEAST_LEVELS = 8
#: A reading of fewer levels: each read so often on average, and none farther from the lattice than this [steps].
_FEWEST, _FEW_OFTEN, _FEW_FIT = 5, 20, 0.1
_FIT = 0.12  # rms distance from the lattice in steps: values without a lattice have 0.29
_MOST = 200_000
#: A level that is no chance occurs so often. Readings at others are false: so few of all, and of them so few beside
#: another one, as no stem that moves from one dwell to the next would have.
_USUAL, _RARE, _RUNNING = 3, 0.05, 0.1
#: How far off a lattice a level is a stranger to it [steps], and how many of all levels may be; one always.
_STRANGE, _STRANGERS = 0.1, 0.02
#: Readings of each of the codes around one that never occurs, from which that is no chance (0.1 % by Poisson).
_OFTEN = 7.0


def lattice_step(values: FloatArray) -> float | None:
    """The coarsest step whose lattice holds the values, in their unit; None where there is no lattice.

    Tolerates values rounded once more on the way into a file, and a few values off the lattice (false readings).
    """
    known = values[np.isfinite(values)][:_MOST]
    levels, code, counts = np.unique(known, return_inverse=True, return_counts=True)
    step, usual = _step_of(levels, known.size), counts >= _USUAL
    if not _false_alone(usual[code]):
        return step
    coarse = _step_of(levels[usual], known.size)  # false readings may be more levels than a coarse display has
    return coarse if step is None or (coarse is not None and coarse > step) else step


def _false_alone(usual: npt.NDArray[np.bool_]) -> bool:
    """Whether hardly any reading, and hardly ever two running, is at a level where no other reading is."""
    rare = ~usual
    running = np.count_nonzero(rare[1:] & rare[:-1])
    return bool(0 < np.count_nonzero(rare) <= _RARE * rare.size and running <= _RUNNING * np.count_nonzero(rare))


def _step_of(levels: FloatArray, readings: int) -> float | None:
    """The step of the lattice on which sorted levels lie, that so many readings have; None where there is none."""
    if levels.size < _FEWEST:
        return None
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * max(float(np.abs(levels).max()), 1e-300)]
    if gaps.size < _LEAST_LEVELS - 1:
        return _of_few(gaps) if gaps.size >= _FEWEST - 1 and readings >= _FEW_OFTEN * levels.size else None
    candidates = sorted((float(np.quantile(gaps, q, method="nearest")) for q in (0.0, 0.02, 0.1, 0.5)), reverse=True)
    for candidate in candidates:
        step = _fitted(gaps, candidate)
        if step is not None:
            return step
    return None


def _of_few(gaps: FloatArray) -> float | None:
    """The step of a reading that is so coarse that it takes a few levels only; None if they lie on no lattice."""
    candidate = float(gaps.min())
    multiples = np.round(gaps / candidate)
    step = float(np.sum(gaps) / np.sum(multiples))
    place = np.cumsum(gaps) - step * np.cumsum(multiples)
    return step if float(np.max(np.abs(place))) < _FEW_FIT * step and np.all(multiples <= _FEWEST) else None


def _fitted(gaps: FloatArray, candidate: float) -> float | None:
    """The step near the candidate that best explains the gaps as whole multiples; None if it does not."""
    gaps = _without_strangers(gaps, candidate)
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


def _without_strangers(gaps: FloatArray, step: float) -> FloatArray:
    """The gaps between the levels that lie on the lattice, where hardly any does not.

    A display that moves on by whole steps only may still show, at first, what it was switched on with.
    """
    close = np.flatnonzero(gaps < _STRANGE * step)  # beside a level of the lattice
    if 0 < close.size <= max(1, _STRANGERS * gaps.size):
        gaps = np.delete(gaps, close)
    off = np.abs(gaps / step - np.round(gaps / step)) > _STRANGE
    over = gaps[:-1] + gaps[1:]
    between = off[:-1] & off[1:] & (np.abs(over / step - np.round(over / step)) < _STRANGE)
    strangers = np.flatnonzero(between)
    if strangers.size == 0 or strangers.size > max(1, _STRANGERS * gaps.size) or np.any(np.diff(strangers) < 2):
        return gaps
    kept = gaps.copy()
    kept[strangers] += gaps[strangers + 1]
    return np.delete(kept, strangers + 1)


def step_doubt(values: FloatArray, step: float) -> float:
    """By how much the step may be off, in its unit: readings are rounded once more, into registers or a file.

    Levels that lie off the lattice by so much, for 19 of 20 readings, tilt it by twice that over all of it.
    """
    seen = values[np.isfinite(values)]
    codes = np.round((seen - np.median(seen)) / step)
    off = seen - step * codes
    span = float(np.ptp(np.quantile(codes, [0.025, 0.975], method="nearest")))
    return 2.0 * float(np.quantile(np.abs(off - np.median(off)), 0.95)) / max(span, 1.0)


def missing_codes(values: FloatArray, step: float) -> tuple[int, int]:
    """(codes that never occur although those on both sides often do, codes between the lowest and the highest)."""
    counts = _counts(values, step)
    return int(np.count_nonzero(_missing(counts))), counts.size


def rounding_error(values: FloatArray, step: float) -> float:
    """Mean squared error of rounding to the codes that occur, in squares of the step: 1/12 where none is missing.

    What belongs to a missing code is read as the one below or above it, all of it off by a step or more.
    """
    widths = _widths(values, step)
    return float(np.sum(widths * (widths**2 / 12.0 + (widths - 1.0) ** 2 / 4.0)) / np.sum(widths))


def rounding_bias(values: FloatArray, step: float) -> float:
    """Mean by which readings are too low, in steps, where what belongs to a missing code is read as the one below."""
    widths = _widths(values, step)
    return float(np.sum(widths * (widths - 1.0) / 2.0) / np.sum(widths))


def _widths(values: FloatArray, step: float) -> FloatArray:
    """Distances in steps from each code that is not missing to the next; a lattice of one code has one step."""
    present = np.flatnonzero(~_missing(_counts(values, step)))
    return np.diff(present).astype(np.float64) if present.size > 1 else np.ones(1)


def _counts(values: FloatArray, step: float) -> npt.NDArray[np.int64]:
    """How often each code occurs, from the lowest to the highest."""
    seen = values[np.isfinite(values)]
    if not seen.size:
        return np.zeros(0, dtype=np.int64)
    codes = np.round((seen - np.quantile(seen, 0.001, method="nearest")) / step)  # a false reading may be anywhere
    codes = codes[np.abs(codes) < _MOST].astype(np.int64)
    return np.bincount(codes - codes.min())


def _missing(counts: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """Codes that do not occur where the two on either side do, often."""
    missing: npt.NDArray[np.bool_] = np.zeros(counts.size, dtype=np.bool_)
    if counts.size < 5:
        return missing
    below, above = counts[:-4] + counts[1:-3], counts[3:-1] + counts[4:]
    often = (below + above >= 4.0 * _OFTEN) & (np.minimum(below, above) >= _OFTEN)
    missing[2:-2] = (counts[2:-2] == 0) & often
    return missing
