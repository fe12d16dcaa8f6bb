"""Shares of the reducible squared error over frequency, from windowed segments.

Source: Welch, "The use of fast Fourier transform for the estimation of power spectra", IEEE Trans. AU-15, 1967.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import FloatArray
from twin.diagnosis import Bin
from twin.where.telescope import least_excess, shares_of

_SEGMENTS = 16  # half-overlapping segments: fewer would give no interval, more would not resolve low frequencies
_LEAST_ROWS = 64
# decades in steps of about three: an engineer reads 0.01, 0.03, 0.1 Hz
_EDGES_HZ = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)


def frequency_shares(
    pieces: Sequence[tuple[FloatArray, FloatArray]],
    noise_sigma: float,
    noise_ar: tuple[float, ...] = (),
) -> tuple[Bin, ...] | None:
    """Shares per frequency band [Hz], summing to 1; None below eight segments or without reducible error.

    `pieces` are (time_s, error) of each recording. Every error is put on an even grid (gaps count as zero error), cut
    into half-overlapping Hann segments, and its power per band is taken less that of noise with `noise_sigma` and AR
    coefficients `noise_ar`.
    """
    period = float(np.median([float(np.median(np.diff(time))) for time, _ in pieces if time.size > 1] or [1.0]))
    evens = [even for even in (_even(time, error, period) for time, error in pieces) if even.size >= _LEAST_ROWS]
    if not evens:
        return None
    sizes = [even.size for even in evens]
    length = max(_LEAST_ROWS, min(2 * (sum(sizes) // _SEGMENTS), int(np.median(sizes))))
    power = np.concatenate([_power(even, length) for even in evens if even.size >= length])
    if power.shape[0] < 8:
        return None
    frequency = np.fft.rfftfreq(length, period).astype(np.float64)
    power -= _noise_power(frequency * period, noise_sigma, noise_ar, length)
    edges = _edges(float(frequency[1]), float(frequency[-1]))
    band = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, edges.size - 2)
    sums = np.stack([power[:, band == b].sum(axis=1) for b in range(edges.size - 1)], axis=1)
    # a segment's row is a mean square: the total counts as many rows as there are segments
    least = least_excess(sum(sizes), noise_sigma, 1.0) * sums.shape[0] / sum(sizes)
    shares = shares_of(sums, [str(b) for b in range(edges.size - 1)], least, signed=False)
    if shares is None:
        return None
    return tuple(Bin(float(edges[b]), float(edges[b + 1]), shares[str(b)]) for b in range(edges.size - 1))


def _power(even: FloatArray, length: int) -> FloatArray:
    """Power per segment and frequency line, shape (segments, length // 2 + 1); a row sums to the mean square."""
    starts = np.arange(0, even.size - length + 1, max(1, length // 2))
    window = np.hanning(length)
    segments = np.lib.stride_tricks.sliding_window_view(even, length)[starts]
    power = np.square(np.abs(np.fft.rfft(segments * window, axis=1))) / (length * np.sum(window**2))
    power[:, 1 : length - length // 2] *= 2.0  # both signs of every frequency but zero and an even length's last
    return np.asarray(power, dtype=np.float64)


def _even(time_s: FloatArray, error: FloatArray, period_s: float) -> FloatArray:
    """The error on an even grid: nearest row, zero where the nearest is further than a period away or missing."""
    known = np.isfinite(error)
    if known.sum() < 2:
        return np.zeros(0)
    at = np.arange(time_s[0], time_s[-1] + 0.5 * period_s, period_s)
    times, values = time_s[known], error[known]
    right = np.clip(np.searchsorted(times, at), 1, times.size - 1)
    nearest = np.where(at - times[right - 1] <= times[right] - at, right - 1, right)
    return np.where(np.abs(times[nearest] - at) <= period_s, values[nearest], 0.0)


def _noise_power(cycles: FloatArray, sigma: float, ar: tuple[float, ...], length: int) -> FloatArray:
    """Expected power of the noise per frequency line, summing to sigma^2; `cycles` is frequency per sample."""
    lags = np.arange(1, len(ar) + 1)
    transfer = 1.0 - np.exp(-2j * np.pi * np.outer(cycles, lags)) @ np.asarray(ar, dtype=np.float64)
    shape = 1.0 / np.square(np.abs(transfer))
    shape[1 : length - length // 2] *= 2.0
    return np.asarray(sigma**2 * shape / shape.sum(), dtype=np.float64)


def _edges(lowest: float, highest: float) -> FloatArray:
    """Band edges from 0 to the highest frequency; the first band holds at least two lines."""
    inner = [edge for edge in _EDGES_HZ if 2.0 * lowest <= edge < 0.9 * highest]
    return np.array([0.0, *inner, highest])
