"""The fastest part of a signal, by second differences: noise wherever the signal is, moving or not.

Motion smooth over three readings cancels, slow noise does too. Where readings are missing, the three nearest that there
are stand for three rows: a reading is compared with the straight line between its neighbours.
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.noise.robust import robust_sigma

_BLOCK, _QUARTILE = 6, 0.67  # the lower quartile of the RMS of six second differences of white noise of sigma 1
_MOST = 200_000  # rows for the memory of the fast part
_SHARED = 0.5  # of the readings that a way to take every n-th row has on average: with fewer it says nothing


def fast_sigma(signal: FloatArray) -> float:
    """Sigma of white noise from second differences; NaN are missing readings, with fewer than three of them it is 0.

    Where motion fills most of the record, its quieter stretches speak for it.
    """
    return _of_differences(_second_differences(signal)[0])


def fast_memory(signal: FloatArray) -> tuple[float, float]:
    """Sigma and correlation from row to row of noise with a short memory, from second differences over growing spans.

    Their variance levels off for noise and grows with the fourth power of the span for motion: the last span before
    that growth holds the noise. Correlation 0 where the first span grows already.
    """
    signal = signal[:_MOST]
    second, apart = _second_differences(signal)
    first = level = _of_differences(second)
    for span in (2, 4, 8, 16):
        wider = fast_sigma_at(signal, span)
        if not 0.0 < wider < 1.5 * level:  # noise grows by 1.41 at most, motion four times
            break
        level = max(level, wider)
    ratio = min(1.0, (first / level) ** 2) if level > 0 else 1.0
    # for a first-order memory phi: (first / level)^2 = 1 - (4 phi - phi^2) / 3
    phi = 2.0 - float(np.sqrt(4.0 - 3.0 * (1.0 - ratio)))
    return level, phi ** (1.0 / apart)


def fast_sigma_at(signal: FloatArray, span: int) -> float:
    """`fast_sigma` of every `span`-th sample, the median over the ways to take them that meet readings."""
    ways = [signal[k::span] for k in range(span)]
    usual = np.count_nonzero(np.isfinite(signal)) / span
    met = [fast_sigma(way) for way in ways if np.count_nonzero(np.isfinite(way)) >= max(_SHARED * usual, 1.0)]
    return float(np.median(met)) if met else 0.0


def _of_differences(second: FloatArray) -> float:
    """Sigma of the white noise that has these second differences; 0 for none."""
    count = second.size // _BLOCK
    whole = robust_sigma(second) / np.sqrt(6.0)
    if count < 10:
        return float(whole)
    blocks = np.sqrt(np.mean(np.square(second[: count * _BLOCK]).reshape(count, _BLOCK), axis=1) / 6.0)
    return float(min(whole, np.quantile(blocks, 0.25) / _QUARTILE) or whole)


def _second_differences(signal: FloatArray) -> tuple[FloatArray, float]:
    """Second differences of the readings that there are, and how many rows these are apart.

    Each is scaled to the variance that white noise gives one of three neighbouring rows. Of triples of several widths
    the narrower ones: across a hole the signal has moved.
    """
    rows = np.flatnonzero(np.isfinite(signal))
    if rows.size == signal.size or rows.size < 3:
        return (np.diff(signal, 2) if rows.size >= 3 else np.zeros(0)), 1.0
    steps = np.diff(rows)
    before, after, y = steps[:-1], steps[1:], signal[rows]
    width = before + after
    off_line = (after * y[:-2] + before * y[2:]) / width - y[1:-1]
    scaled = off_line * np.sqrt(6.0 / (1.0 + (before**2 + after**2) / width**2))
    near = width <= np.median(width)
    return scaled[near], float(np.mean(width[near])) / 2.0
