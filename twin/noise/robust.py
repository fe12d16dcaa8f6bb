"""Scale, correlation and whitening of a noise sample, steady against outliers, quantization and missing values.

Arrays are float64 of shape (n,); a noise sample is a list of such pieces, each without gaps inside.
Source: Huber, "Robust Statistics", 1981 (scale); Sokal, "Monte Carlo methods in statistical mechanics", 1989, section 3
(window of the correlation time); Brockwell & Davis, "Time Series", 1991, section 5.2 (Durbin-Levinson).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from logs.recording import FloatArray

CLIP = 5.0  # a Gaussian value passes this many sigma once in two million: what is beyond is no noise
MAX_LAG = 200
_MAX_ORDER = 25
_MET = 0.02  # of the pairs of readings that a lag would have, were none missing: fewer say nothing of it
_NONE = 1e-12  # a correlation that is none, to take a logarithm of


def robust_sigma(values: FloatArray) -> float:
    """The standard deviation of the bulk: root mean square of what lies within 5 sigma of the median.

    Not the median deviation itself, which jumps on a quantized signal and misses the wings of a wide one. NaN is
    left out; an empty or constant sample has sigma 0.
    """
    sample = values[np.isfinite(values)]
    if sample.size == 0:
        return 0.0
    deviation = np.abs(sample - np.median(sample))
    # with more than half of the values on one step the median deviation is 0: the mean one still is not
    sigma = 1.4826 * float(np.median(deviation)) or 1.2533 * float(np.mean(deviation))
    most = 1.5 * sigma  # motion is an outlier of every size: the bound must not climb up along it
    for _ in range(8):
        inside = deviation[deviation <= CLIP * min(sigma, most)]
        updated = float(np.sqrt(np.mean(np.square(inside)))) if inside.size else sigma
        if abs(updated - sigma) <= 1e-9 * sigma:
            break
        sigma = updated
    return sigma


def clipped(values: FloatArray, sigma: float) -> FloatArray:
    """The values about their median, held inside 5 sigma; NaN stays NaN."""
    centred = values - np.nanmedian(values) if np.isfinite(values).any() else values
    return np.clip(centred, -CLIP * sigma, CLIP * sigma) if sigma > 0 else centred


def autocorrelation(pieces: Sequence[FloatArray], max_lag: int = MAX_LAG) -> FloatArray:
    """Autocorrelation pooled over the pieces, lags 0..m with m <= `max_lag` and m < a third of the longest piece.

    Lags at which hardly any two readings lie, as of every other row, are filled in from those beside them.
    """
    longest = max((piece.size for piece in pieces), default=0)
    lags = min(max_lag, longest // 3)
    total = np.zeros(lags + 1)
    pairs, possible = np.zeros(lags + 1), np.zeros(lags + 1)
    for piece in pieces:
        known = np.isfinite(piece)
        filled = np.where(known, piece, 0.0)
        weight = known.astype(np.float64)
        for lag in range(min(lags, piece.size - 1) + 1):
            stop = piece.size - lag
            # einsum stays on this thread: for short pieces a pool costs more than it saves
            total[lag] += float(np.einsum("i,i->", filled[:stop], filled[lag:]))
            pairs[lag] += float(np.einsum("i,i->", weight[:stop], weight[lag:]))
            possible[lag] += stop
    if lags < 0 or total[0] <= 0:
        return np.ones(1)
    covariance = total / np.maximum(pairs, 1.0)
    rho = np.asarray(covariance / covariance[0])
    return rho if np.all(pairs > _MET * possible) else _filled_in(rho, pairs, pairs > _MET * possible)


def _filled_in(rho: FloatArray, pairs: FloatArray, met: npt.NDArray[np.bool_]) -> FloatArray:
    """The correlation with the lags that are not met as of a first-order memory between those that are: it goes along
    a power of the lag's length, and from what is no more than chance there is no way."""
    certain = np.where(rho > 2.0 / np.sqrt(np.maximum(pairs, 1.0)), rho, _NONE)
    lags = np.arange(rho.size)
    return np.where(met, rho, np.exp(np.interp(lags, lags[met], np.log(certain[met]))))


def correlation_samples(rho: FloatArray) -> float:
    """Integrated correlation time 1 + 2 sum rho [samples], at least 1: n values carry n / this many independent ones.

    The sum stops where the window reaches five times the result, or where rho falls into its own noise.
    """
    total = 1.0
    for lag in range(1, rho.size):
        if rho[lag] <= 0.0 or lag > 5.0 * total:
            break
        total += 2.0 * float(rho[lag])
    return max(total, 1.0)


def autoregression(rho: FloatArray, samples: float) -> tuple[tuple[float, ...], float]:
    """AR coefficients a (x[i] = sum a[j] x[i-1-j] + e) and the variance of e relative to that of x.

    The order, at most 25, is the one of least Bayesian information criterion for `samples` values.
    """
    order_max = min(_MAX_ORDER, rho.size - 1)
    coefficients = np.zeros(0)
    variance, best, best_score = 1.0, (coefficients, 1.0), 0.0
    for order in range(1, order_max + 1):
        reflection = (rho[order] - coefficients @ rho[order - 1 : 0 : -1]) / variance
        if not abs(reflection) < 0.9999:
            break
        coefficients = np.append(coefficients - reflection * coefficients[::-1], reflection)
        variance *= 1.0 - reflection**2
        score = samples * np.log(variance) + order * np.log(max(samples, 2.0))
        if score < best_score:
            best, best_score = (coefficients, variance), score
    return tuple(float(value) for value in best[0]), float(best[1])


def remembered(ar: Sequence[float], lags: int) -> FloatArray:
    """Correlation of noise with these AR coefficients at lags 0, 1, ... `lags` - 1, shape (lags,).

    Of its answer to one blow, over a time in which it has forgotten it.
    """
    blow = np.zeros(2 * lags)
    blow[0] = 1.0
    answer = lfilter([1.0], np.concatenate([[1.0], -np.asarray(ar, dtype=np.float64)]), blow)
    covariance = np.array([np.dot(answer[: answer.size - lag], answer[lag:]) for lag in range(lags)])
    return np.asarray(covariance / covariance[0])


def whiten(residual: FloatArray, ar: Sequence[float], sigma: float, innovation_sigma: float) -> FloatArray:
    """The residual in units of its independent part: unit variance and no memory if it is this noise.

    The first rows, and rows whose past is missing, cannot be predicted from it and are divided by `sigma` instead.
    NaN stays NaN.
    """
    known = np.isfinite(residual)
    filled = np.where(known, residual, 0.0)
    taps = np.concatenate([[1.0], -np.asarray(ar, dtype=np.float64)])
    whole = np.convolve(known.astype(np.float64), np.ones(taps.size))[: residual.size] >= taps.size - 0.5
    white = np.convolve(filled, taps)[: residual.size] / innovation_sigma
    return np.where(known, np.where(whole, white, filled / sigma), np.nan)
