"""How hypotheses are compared: a tempered log-likelihood that does not believe in independent errors.

Residuals of a nearly right model are not white, so n samples are worth n / phi, with phi the integrated
autocorrelation of the residual of the *best* hypothesis, shared by all of them. The error variance is profiled out,
which shares the model inadequacy too: when the best model leaves ten times the noise, differences count a tenth.
Source: Geyer, Stat. Sci. 7 (1992) 473 (integrated autocorrelation); Schwarz, Ann. Stat. 6 (1978) 461 (dimension).
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.fit.fitting import Fit


def inflation(residuals: FloatArray, use: np.ndarray) -> float:
    """Integrated autocorrelation of the residual, >= 1: how many samples are worth one independent one."""
    r = residuals[use]
    n = r.size
    if n < 64:
        return 1.0
    r = r - r.mean()
    power = np.abs(np.fft.rfft(r, 2 * n)) ** 2
    acf = np.fft.irfft(power)[: n // 8]
    if acf[0] <= 0.0:
        return 1.0
    acf = acf / acf[0]
    pairs = acf[1::2][: acf.size // 2 - 1] + acf[2::2][: acf.size // 2 - 1]
    negative = np.flatnonzero(pairs <= 0.0)
    last = int(negative[0]) if negative.size else pairs.size
    return float(np.clip(1.0 + 2.0 * np.sum(pairs[:last]), 1.0, n / 16.0))


def score(fit: Fit, rows: int, phi: float) -> float:
    """Tempered log-evidence of a fitted hypothesis; only differences mean anything.

    Laplace's approximation: the likelihood at the optimum, the prior there, and for every unknown how much of its prior
    range the data rule out. A nuisance that had to move pays by its prior, one that is merely there pays too.
    """
    worth = max(rows / phi, 4.0)
    likelihood = -0.5 * worth * np.log(max(fit.mse, 1e-12))
    return float(likelihood - 0.5 * fit.prior - 0.5 * _log_volume(fit, phi) + _log_odds(fit))


def _log_volume(fit: Fit, phi: float) -> float:
    """Logarithm of prior variance over posterior variance, over all unknowns."""
    if not fit.z.size:
        return 0.0
    s = fit.space.spreads
    information = (fit.normal - np.diag(s**-2)) * np.outer(s, s) / (phi * max(fit.mse, 1.0))
    sign, value = np.linalg.slogdet(np.eye(s.size) + information)
    return float(value) if sign > 0 else 0.0


def _log_odds(fit: Fit) -> float:
    return float(sum(np.log(c.effect.odds) for c in fit.space.causes if c.effect is not None))
