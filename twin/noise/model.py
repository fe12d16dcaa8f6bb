"""The noise of the readings without any model of the valve: from repeats, else still stretches, else fast changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import erfc, exp, lgamma, log, sqrt
from typing import Literal

import numpy as np

from logs.recording import FloatArray, Recording
from twin.noise.lattice import lattice_step
from twin.noise.repeats import RepeatPair, find_repeats
from twin.noise.robust import (
    MAX_LAG,
    autocorrelation,
    autoregression,
    clipped,
    correlation_samples,
    robust_sigma,
    whiten,
)
from twin.noise.still import fast_sigma, still_pieces, taken_by_parabola

Source = Literal["repeats", "still", "high_frequency", "none"]

_TAIL = 4.5  # sigmas; a Gaussian reading passes it once in 150,000
_LEAST = 200  # samples before a source is trusted


@dataclass(frozen=True, slots=True)
class SignalNoise:
    """Noise of one signal in its own unit.

    `sigma` leaves out false readings and is never below that of the reading's own step. `correlation_samples` is the
    integrated correlation time; `ar` and `innovation_sigma` are the whitening filter. `heavy_tail_p` is the chance that
    Gaussian noise shows as many values beyond 4.5 sigma; `tail_ratio` is the full RMS over sigma. `by_source` holds
    sigma from every source that was there: repeats much louder than still stretches mean that something in the motion
    does not repeat.
    """

    sigma: float
    correlation_samples: float
    source: Source
    samples: int
    period_s: float
    ar: tuple[float, ...] = ()
    innovation_sigma: float = 0.0
    heavy_tail_p: float = 1.0
    tail_ratio: float = 1.0
    by_source: Mapping[str, float] = field(default_factory=dict)

    def effective_samples(self, rows: int) -> float:
        """How many independent values `rows` consecutive readings carry."""
        return max(1.0, rows / self.correlation_samples)

    def whiten(self, residual: FloatArray) -> FloatArray:
        """The residual, shape (n,), as independent values of unit variance if it were this noise; NaN stays NaN."""
        if self.sigma <= 0.0:
            return residual
        return whiten(residual, self.ar, self.sigma, self.innovation_sigma)


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """Noise of the position reading, and of the pressure reading where there is one."""

    position: SignalNoise
    pressure: SignalNoise | None = None
    pairs: int = 0

    def whiten(self, residual: FloatArray) -> FloatArray:
        """A position residual as independent values of unit variance, see `SignalNoise.whiten`."""
        return self.position.whiten(residual)


def estimate_noise(recordings: Sequence[Recording]) -> NoiseModel:
    """Measures the noise of recordings that share a unit; uses no model and no candidate's residual.

    Every source is computed, the first with at least 200 samples is used: repeats of a command sequence (differences
    over sqrt 2), still stretches (about a parabola), second differences (fast part only, taken as white).
    """
    pairs = find_repeats(recordings)
    pressured = [r for r in recordings if r.pressure is not None]
    return NoiseModel(
        position=_signal("position", recordings, pairs),
        pressure=_signal("pressure", pressured, pairs) if pressured else None,
        pairs=len(pairs),
    )


def _signal(name: str, recordings: Sequence[Recording], pairs: Sequence[RepeatPair]) -> SignalNoise:
    period = float(np.median([r.period_s for r in recordings if r.n > 1] or [float("nan")]))
    repeated = [piece for pair in pairs if (piece := pair.difference(name)) is not None]
    still = _still(name, recordings)
    fast = [fast_sigma(getattr(r, name)) for r in recordings if r.n >= 3]
    sources: dict[Source, list[FloatArray]] = {"repeats": repeated, "still": still}
    by_source: dict[str, float] = {
        key: robust_sigma(np.concatenate(pieces)) for key, pieces in sources.items() if _rows(pieces)
    }
    if fast:
        by_source["high_frequency"] = float(np.median(fast))
    tail_pieces = sources["still"] if _rows(sources["still"]) >= _LEAST else repeated
    tail_p, ratio = _tails(np.concatenate(tail_pieces)) if tail_pieces else (1.0, 1.0)
    # a coarse reading stands still without being right: it is never better than its step allows
    least = (lattice_step(np.concatenate([getattr(r, name) for r in recordings])) or 0.0) / sqrt(12.0)
    for source, pieces in sources.items():
        if _rows(pieces) >= _LEAST:
            return _measured(source, pieces, period, tail_p, ratio, by_source, least)
    sigma = max(by_source.get("high_frequency", 0.0), least)
    source = "high_frequency" if fast else "none"
    rows = sum(r.n for r in recordings)
    return SignalNoise(sigma, 1.0, source, rows, period, (), sigma, tail_p, ratio, by_source)


def _still(name: str, recordings: Sequence[Recording]) -> list[FloatArray]:
    """Still pieces under a constant command or, if those are too few, under any."""
    known = [r for r in recordings if r.n > 1]
    held = [piece for r in known for piece in still_pieces(getattr(r, name), r.period_s, r.command)]
    if _rows(held) >= _LEAST:
        return held
    return [piece for r in known for piece in still_pieces(getattr(r, name), r.period_s)]


def _measured(
    source: Source,
    pieces: list[FloatArray],
    period_s: float,
    tail_p: float,
    ratio: float,
    by_source: Mapping[str, float],
    least: float,
) -> SignalNoise:
    spread = robust_sigma(np.concatenate(pieces))
    sigma = max(spread, least)
    tame = [clipped(piece, spread) for piece in pieces]
    taken = taken_by_parabola(pieces, MAX_LAG) if source == "still" else None
    rho = autocorrelation(tame, MAX_LAG, taken)
    tau = correlation_samples(rho)
    rows = _rows(pieces)
    ar, variance = autoregression(rho, rows)
    return SignalNoise(sigma, tau, source, rows, period_s, ar, sigma * sqrt(variance), tail_p, ratio, by_source)


def _rows(pieces: Sequence[FloatArray]) -> int:
    return int(sum(np.count_nonzero(np.isfinite(piece)) for piece in pieces))


def _tails(values: FloatArray) -> tuple[float, float]:
    """Chance of so many values beyond 4.5 sigma under a Gaussian (Poisson), and the full RMS over the robust sigma."""
    sample = values[np.isfinite(values)]
    sigma = robust_sigma(sample)
    if sigma <= 0.0 or sample.size == 0:
        return 1.0, 1.0
    beyond = int(np.count_nonzero(np.abs(sample) > _TAIL * sigma))
    expected = sample.size * erfc(_TAIL / sqrt(2.0))
    return poisson_tail(beyond, expected), float(np.sqrt(np.mean(np.square(sample)))) / sigma


def poisson_tail(count: int, expected: float) -> float:
    """Chance of `count` or more events when `expected` are expected."""
    if count == 0:
        return 1.0
    below = sum(exp(k * log(expected) - expected - lgamma(k + 1)) for k in range(min(count, 1000)))
    if below < 0.999:
        return max(1.0 - below, 0.0)
    # the far tail by its first term: 1 - below has lost its digits there
    return min(1.0, 2.0 * exp(max(count * log(expected) - expected - lgamma(count + 1), -700.0)))
