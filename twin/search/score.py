"""How hypotheses are compared: a log-evidence that does not believe in independent errors.

What the best hypothesis leaves is not white: the pressure wanders, a wrong form leaves a slow rest, one missed slip
shifts everything after it. Its autoregression, frozen, whitens the residuals of *all* hypotheses, so that none can buy
evidence with its own noise model; the whitened residuals count by a Student t likelihood, because a few missed slips
are few, however large; and what correlation is left divides the number of samples.
Source: Ljung, System Identification (1999), ch. 7; Lange, Little, Taylor, J. Am. Stat. Assoc. 84 (1989) 881 (t errors);
Geyer, Stat. Sci. 7 (1992) 473 (integrated autocorrelation); Laplace's approximation of the evidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.fft import next_fast_len
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

from logs.recording import FloatArray
from twin.fit.fitting import Fit

_ORDER = 24
_NU = 5.0
_LEAST_SCALE = 0.02  # of the mean square
_FURTHER_NUMBER = 0.1
#: Share of residuals that are not 0, below which readings are intervals.
_INTERVALS = 0.5


@dataclass(frozen=True, slots=True)
class Yardstick:
    """What all hypotheses of a channel are measured with.

    `phi`: residual samples worth one independent one, `white_phi` the same after whitening with `filter` (FIR, leading
    1), all taken from the best hypothesis. `square`: where readings are intervals, which most predictions lie within,
    what the best leaves in the mean of the others; 0 elsewhere.
    """

    rows: int
    phi: float = 1.0
    white_phi: float = 1.0
    filter: FloatArray = field(default_factory=lambda: np.ones(1))
    square: float = 0.0

    def score(self, fit: Fit) -> float:
        """Tempered log-evidence of a fitted hypothesis; only differences mean anything.

        The likelihood at the optimum, the prior there, and for every unknown how much of its prior range the data rule
        out. A nuisance that had to move pays by its prior, one that is merely there pays too.
        """
        likelihood = self._log_likelihood(fit.residuals) / self.white_phi
        return float(likelihood - 0.5 * fit.prior - 0.5 * _log_volume(fit, self.phi) + _log_odds(fit))

    def _log_likelihood(self, residuals: FloatArray) -> float:
        """With a scale of its own; of intervals with the same for all: a reading that holds what is predicted says no
        more of the noise than that it is smaller, and thousands of them must not vouch for the scale of the others."""
        if self.square > 0.0:
            return float(-0.5 * (_NU + 1.0) * np.sum(np.log1p(np.square(residuals) / (_NU * self.square))))
        return student_log_likelihood(lfilter(self.filter, [1.0], residuals)[self.filter.size - 1 :])


def make_yardstick(best: FloatArray, use: np.ndarray) -> Yardstick:
    """The yardstick from the residuals of the best hypothesis."""
    phi = inflation(best, use)
    beyond = best[use & (best != 0.0)]
    if 0 < beyond.size < _INTERVALS * np.count_nonzero(use):
        return Yardstick(int(np.count_nonzero(use)), phi, phi, square=float(np.mean(np.square(beyond))))
    fir = whitening_filter(best[use])
    white = lfilter(fir, [1.0], best)
    return Yardstick(int(np.count_nonzero(use)), phi, inflation(white, use), fir)


def yardstick_for(fits: Sequence[Fit], use: np.ndarray) -> Yardstick:
    """The yardstick for some hypotheses, from the residuals of the one that leaves least."""
    return make_yardstick(min(fits, key=lambda f: f.mse).residuals, use)


def whitening_filter(residuals: FloatArray, order: int = _ORDER) -> FloatArray:
    """FIR that whitens: 1, -a1, ..., -aq of the autoregression by Yule and Walker."""
    r = residuals - residuals.mean()
    n = r.size
    if n < 20 * order or not r.any():
        return np.ones(1)
    acf = _sums(r, order) / n
    acf[0] *= 1.0 + 1e-6
    return np.concatenate([[1.0], -solve_toeplitz(acf[:order], acf[1:])])


def student_log_likelihood(values: FloatArray) -> float:
    """Log-likelihood of independent Student t errors with 5 degrees of freedom at their best scale."""
    square = np.square(values)
    # few large errors among many small ones still have a size
    least = max(_LEAST_SCALE * float(np.mean(square)), 1e-12)
    scale = max(float(np.median(square)) / 0.528, least)
    for _ in range(25):
        new = max((_NU + 1.0) * scale * float(np.mean(square / (square + _NU * scale))), least)
        if abs(new - scale) < 1e-5 * scale:
            break
        scale = new
    return float(-0.5 * values.size * np.log(scale) - 0.5 * (_NU + 1.0) * np.sum(np.log1p(square / (_NU * scale))))


def inflation(residuals: FloatArray, use: np.ndarray) -> float:
    """Integrated autocorrelation of the residual, >= 1: how many samples are worth one independent one."""
    r = residuals[use]
    n = r.size
    if n < 64:
        return 1.0
    r = r - r.mean()
    acf = _sums(r, n // 8 - 1)
    if acf[0] <= 0.0:
        return 1.0
    acf = acf / acf[0]
    pairs = acf[1::2][: acf.size // 2 - 1] + acf[2::2][: acf.size // 2 - 1]
    negative = np.flatnonzero(pairs <= 0.0)
    last = int(negative[0]) if negative.size else pairs.size
    return float(np.clip(1.0 + 2.0 * np.sum(pairs[:last]), 1.0, n / 16.0))


def _sums(r: FloatArray, last: int) -> FloatArray:
    """Sums of products of `r` with itself 0 to `last` places on: no more zeros behind it than keep these apart."""
    length = next_fast_len(r.size + last, real=True)
    power = np.abs(np.fft.rfft(r, length)) ** 2
    return np.asarray(np.fft.irfft(power, length)[: last + 1])


def _log_volume(fit: Fit, phi: float) -> float:
    """Logarithm of prior variance over posterior variance, over all unknowns."""
    if not fit.z.size:
        return 0.0
    s = fit.space.spreads
    information = (fit.normal - np.diag(s**-2)) * np.outer(s, s) / (phi * max(fit.mse, 1.0))
    sign, value = np.linalg.slogdet(np.eye(s.size) + information)
    return float(value) if sign > 0 else 0.0


def _log_odds(fit: Fit) -> float:
    """Prior log-odds of the causes: effects and forms have their own; where one number is wrong a further is rare."""
    numbers = sum(c.effect is None for c in fit.space.causes)
    effects = sum(np.log(c.effect.odds) for c in fit.space.causes if c.effect is not None)
    effects += sum(np.log(c.form.odds) for c in fit.space.causes if c.form is not None)
    return float(effects + np.log(_FURTHER_NUMBER) * max(numbers - 1, 0))
