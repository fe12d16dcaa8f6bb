"""The noise of the readings without any model of the valve: from repeats, else still stretches, else fast changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import erfc, exp, lgamma, log, sqrt
from typing import Literal

import numpy as np

from logs.recording import FloatArray, Recording
from twin.noise.driven import undriven
from twin.noise.fast import fast_memory
from twin.noise.lattice import lattice_step
from twin.noise.repeats import RepeatPair, find_repeats
from twin.noise.robust import (
    MAX_LAG,
    autocorrelation,
    autoregression,
    clipped,
    correlation_samples,
    remembered,
    robust_sigma,
    whiten,
)
from twin.noise.still import (
    even_windows,
    given_back,
    held_windows,
    still_pieces,
    still_stretches,
    straight_windows,
)

Source = Literal["repeats", "still", "straight", "high_frequency", "none"]

_TAIL = 4.5  # sigmas; a Gaussian reading passes it once in 150,000
LOUD = 4.0  # times the resting noise: a difference of repeats beyond it has a cause
_LEAST = 200  # samples before a source is trusted
_COMPLETE = 0.9  # of the rows: with fewer readings the memory is of first order


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

    @property
    def resting(self) -> float | None:
        """Sigma of the signal while it rests, or where the command is even; None where neither was seen."""
        return _resting(self.by_source)

    @property
    def correlation(self) -> FloatArray:
        """From reading to reading, at lags 0, 1, ... as far as it may be known; of first order, where no filter is."""
        first = (self.correlation_samples - 1.0) / (self.correlation_samples + 1.0)
        return remembered(self.ar or (first,), MAX_LAG)

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


def estimate_noise(recordings: Sequence[Recording], repeats: bool = True) -> NoiseModel:
    """Measures the noise of recordings that share a unit; uses no model and no candidate's residual.

    `repeats`: whether by repeats, where there are any; not, where it is known why these differ.

    Every source is computed, the first with at least 200 samples is used: repeats of a command sequence (differences
    over sqrt 2), still stretches (about a parabola; under a constant command or, for the position, which may rest in
    the deadband, under any), stretches of an even command, second differences (with a first-order memory at most).
    """
    pairs = find_repeats(recordings) if repeats else []
    pressured = [r for r in recordings if r.pressure is not None]
    return NoiseModel(
        position=_signal("position", recordings, pairs),
        pressure=_signal("pressure", pressured, pairs) if pressured else None,
        pairs=len(pairs),
    )


def _signal(name: str, recordings: Sequence[Recording], pairs: Sequence[RepeatPair]) -> SignalNoise:
    known = [r for r in recordings if r.n >= 3]
    if name == "position":  # a record that rests at a stop behind a rounded reading shows no noise, but has some
        known = [r for r in known if not _at_rest(r.position)] or known
    if not known:
        return SignalNoise(0.0, 1.0, "none", 0, float("nan"))
    period = float(np.median([r.period_s for r in known]))
    sources: dict[Source, list[FloatArray]] = {
        "repeats": [piece for pair in pairs if (piece := pair.difference(name)) is not None],
        "still": _pieces(name, known, "held"),
    }
    if name == "position" and _rows(sources["still"]) < _LEAST:
        sources["still"] = _resting_pieces(known)
    sources["straight"] = _pieces(name, known, "straight")
    by_source = {str(key): robust_sigma(np.concatenate(p)) for key, p in sources.items() if _rows(p)}
    fast = [fast_memory(getattr(r, name)) for r in known]
    level, phi = (float(np.median(column)) for column in zip(*fast, strict=True))
    by_source["high_frequency"] = level
    calm = sources["still"] if _rows(sources["still"]) >= _LEAST else sources["repeats"]
    tail_p, ratio = _tails(np.concatenate(calm)) if calm else (1.0, 1.0)
    # a coarse reading stands still without being right: it is never better than its step allows
    least = (lattice_step(np.concatenate([getattr(r, name) for r in known])) or 0.0) / sqrt(12.0)
    for source, pieces in sources.items():
        if source == "repeats" and _louder(by_source):
            continue
        if _rows(pieces) >= _LEAST:
            return _measured(source, pieces, period, tail_p, ratio, by_source, least)
    sigma, rows = max(level, least), sum(r.n for r in known)
    memory, fresh = (1.0 + phi) / (1.0 - phi), sigma * sqrt(1.0 - phi**2)
    ar = (phi,) if phi > 0.0 else ()
    return SignalNoise(sigma, memory, "high_frequency", rows, period, ar, fresh, tail_p, ratio, by_source)


def _at_rest(reading: FloatArray) -> bool:
    """Whether a reading never changes over a whole record."""
    known = reading[np.isfinite(reading)]
    return known.size > 0 and bool(np.ptp(known) == 0.0)


def _louder(by_source: Mapping[str, float]) -> bool:
    """Whether repeats differ so much more than the resting signal that the difference is no noise of the reading.

    A deadband that grows, a disturbance that comes once: as a floor it would hide its own cause.
    """
    resting = _resting(by_source)
    return resting is not None and by_source.get("repeats", 0.0) > LOUD * max(resting, by_source["high_frequency"])


def _resting(by_source: Mapping[str, float]) -> float | None:
    return by_source.get("still", by_source.get("straight"))


def _pieces(name: str, recordings: Sequence[Recording], kind: Literal["held", "straight"]) -> list[FloatArray]:
    """Residuals of one signal where the command is held, or where it is even."""
    pieces: list[FloatArray] = []
    for r in recordings:
        starts = (held_windows if kind == "held" else straight_windows)(r.time_s, r.command)
        pieces += still_pieces(getattr(r, name), r.period_s, starts, still=kind != "straight")
    return pieces


def _resting_pieces(recordings: Sequence[Recording]) -> list[FloatArray]:
    """Residuals of the position where it rests under any command, as a stem may in its deadband."""
    found = [
        (r, one) for r in recordings for one in still_stretches(r.position, r.period_s, even_windows(r.n, r.period_s))
    ]
    return undriven([piece for _, (_, piece) in found], [(r, rows) for r, (rows, _) in found])


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
    rho = autocorrelation([clipped(piece, spread) for piece in pieces], MAX_LAG)
    rows = _rows(pieces)
    if source != "repeats":
        rho, grown = given_back(rho, [piece.size for piece in pieces])
        spread *= grown
    sigma = max(spread, least)
    tau = correlation_samples(rho)
    # each lag of a reading with holes is of other pairs: over many of them that is no autocorrelation, over one it is
    complete = rows > _COMPLETE * sum(piece.size for piece in pieces)
    ar, variance = autoregression(rho if complete else rho[:2], rows)
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
