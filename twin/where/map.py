"""The where-map: every split of the reducible error over one or many recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray
from twin.diagnosis import Bin, Where
from twin.noise.model import SignalNoise
from twin.where.frequency import frequency_shares
from twin.where.regime import DIRECTIONS, REGIMES, Regimes, classify
from twin.where.strata import bin_shares, class_shares, even_edges
from twin.where.telescope import stage_shares, two_stage_terms


@dataclass(frozen=True, slots=True)
class WherePiece:
    """One recording with its predictions, float64 arrays of shape (n,) in the recording's units.

    `full` is the model driven by the command, `from_pressure` the model driven by the measured, smoothed pressure
    (None where it was not measured). `pressure` is that smoothed pressure, or the model's. `use` marks the rows that
    count: not the ones known to be false.
    """

    time_s: FloatArray
    reading: FloatArray
    full: FloatArray
    pressure: FloatArray
    from_pressure: FloatArray | None = None
    use: npt.NDArray[np.bool_] | None = None

    def error(self) -> FloatArray:
        """Reading less full prediction; NaN in rows that do not count."""
        error = self.reading - self.full
        return error if self.use is None else np.where(self.use, error, np.nan)


def where_map(pieces: Sequence[WherePiece], noise: SignalNoise, travel: float) -> Where:
    """Shares of the reducible squared error of all pieces together; groups that cannot be known are None.

    Time in the map runs through the pieces one after the other.
    """
    error = _joined(pieces, WherePiece.error)
    sigma, memory = noise.sigma, noise.correlation_samples
    stage = None
    if all(piece.from_pressure is not None for piece in pieces):
        reading, full = _joined(pieces, lambda p: p.reading), _joined(pieces, lambda p: p.full)
        terms = two_stage_terms(reading, full, _joined(pieces, lambda p: _some(p.from_pressure)))
        stage = stage_shares(error, terms, sigma, "actuator_or_sensor", memory)
    classes = [_classes(piece, noise, travel) for piece in pieces]
    direction = np.concatenate([c.direction for c in classes])
    regime = np.concatenate([c.regime for c in classes])
    pressure = _joined(pieces, lambda p: p.pressure)
    time = _run_time(pieces)

    def binned(quantity: FloatArray, edges: FloatArray) -> tuple[Bin, ...] | None:
        return bin_shares(error, quantity, edges, sigma, memory)

    return Where(
        stage=stage,
        direction=class_shares(error, direction, DIRECTIONS, sigma, memory),
        regime=class_shares(error, regime, REGIMES, sigma, memory),
        position=binned(_joined(pieces, lambda p: p.reading), even_edges(np.zeros(1), 10, 0.0, travel)),
        pressure=binned(pressure, even_edges(pressure)),
        time=binned(time, even_edges(time)),
        frequency=frequency_shares([(p.time_s, p.error()) for p in pieces], sigma, noise.ar),
    )


def _classes(piece: WherePiece, noise: SignalNoise, travel: float) -> Regimes:
    reading = piece.reading if piece.use is None else np.where(piece.use, piece.reading, np.nan)
    memory = noise.correlation_samples
    return classify(piece.time_s, reading, piece.full, piece.pressure, noise.sigma, travel, correlation_samples=memory)


def _joined(pieces: Sequence[WherePiece], take: Callable[[WherePiece], FloatArray]) -> FloatArray:
    return np.concatenate([take(piece) for piece in pieces])


def _run_time(pieces: Sequence[WherePiece]) -> FloatArray:
    """Time from 0 through all pieces in turn."""
    parts: list[FloatArray] = []
    end = 0.0
    for piece in pieces:
        parts.append(end + piece.time_s - piece.time_s[0])
        end = float(parts[-1][-1])
    return np.concatenate(parts)


def _some(array: FloatArray | None) -> FloatArray:
    assert array is not None
    return array
