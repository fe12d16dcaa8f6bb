"""Limit cycles that the describing function predicts: where the linear part meets -1 / N(A)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from control.analysis.describing import play_describing_function
from control.analysis.loop import LinearLoop
from control.design import DesignModel

ComplexArray = npt.NDArray[np.complex128]
FloatArray = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
WITHIN = np.geomspace(1.0 / 1.2, 1.2, 60)  # of a frequency: where its neighbour's crossing is looked for


@dataclass(frozen=True, slots=True)
class LimitCycle:
    """Amplitude of the pressure at the play [psi] and of the stem [in]; angular frequency [rad/s].

    `stable`: disturbances die out and the loop comes back to this oscillation.
    """

    pressure_psi: float
    stem_in: float
    omega: float
    stable: bool

    @property
    def period_s(self) -> float:
        return float(2.0 * np.pi / self.omega)


def predict(loop: LinearLoop, design: DesignModel, n: int = 600, points: int = 4000) -> list[LimitCycle]:
    """All intersections with amplitudes from just above half the deadband to 50 times that.

    For every amplitude the frequency is found at which L(jw) N(A) is real and negative; its modulus goes through 1 at
    a limit cycle, and falls with the amplitude where the cycle is stable.
    """
    amplitudes = 0.5 * design.deadband * (1.0 + np.geomspace(1e-3, 50.0, n))
    at, near = _frequencies(loop, _play(design, amplitudes[:-1]), points)
    low, high = amplitudes[at], amplitudes[at + 1]
    before, after = _excess(loop, design, low, near), _excess(loop, design, high, near)
    crosses = before * after <= 0.0  # not so where one of them is NaN
    amplitude = _bisect(loop, design, low[crosses], high[crosses], near[crosses])
    slope = _play(design, amplitude)
    omega = _real_axis(loop, slope, near[crosses])
    stem = amplitude * np.abs(slope * loop.after_play(omega))
    stable = (before > 0.0) & (after < 0.0)
    columns = zip(amplitude.tolist(), stem.tolist(), omega.tolist(), stable[crosses].tolist(), strict=True)
    return [LimitCycle(*column) for column in columns]


def grows(loop: LinearLoop, design: DesignModel) -> bool:
    """Whether the loop is unstable with the play wide open, so that oscillations beyond some size grow without end."""
    line = loop(loop.frequencies(2000)) * design.compliance
    crossing = (np.diff(np.sign(line.imag)) != 0) & (line.real[:-1] < -1.0)
    return bool(crossing.any())


def _frequencies(loop: LinearLoop, slopes: ComplexArray, points: int) -> tuple[Indices, FloatArray]:
    """The frequencies [rad/s] at which one of the play's `slopes` makes the loop real and negative, and the places of
    those slopes; as near as a grid of `points` tells."""
    grid = loop.frequencies(points)
    line, places, found = loop(grid), [], []
    for place, slope in enumerate(slopes):
        turned = line * slope
        crossing = np.nonzero((np.diff(np.sign(turned.imag)) != 0) & (turned.real[:-1] < 0.0))[0]
        places.append(np.full(crossing.size, place))
        found.append(grid[crossing])
    return np.concatenate(places), np.concatenate(found)


def _play(design: DesignModel, amplitudes: FloatArray) -> ComplexArray:
    return play_describing_function(amplitudes, design.deadband, design.compliance)


def _real_axis(loop: LinearLoop, slopes: ComplexArray, near: FloatArray) -> FloatArray:
    """The frequencies nearest `near` at which L N is real [rad/s]; NaN where there is none within 20 %."""
    grid, row = near[:, None] * WITHIN, np.arange(near.size)
    imaginary = (loop(grid) * slopes[:, None]).imag
    crosses = np.diff(np.sign(imaginary)) != 0
    i = np.where(crosses, np.abs(np.log(WITHIN[:-1])), np.inf).argmin(axis=1)
    before, after = imaginary[row, i], imaginary[row, i + 1]
    with np.errstate(invalid="ignore", divide="ignore"):  # where nothing crosses
        share = before / (before - after)
    found = grid[row, i] + share * (grid[row, i + 1] - grid[row, i])
    return np.where(crosses.any(axis=1), found, np.nan)


def _excess(loop: LinearLoop, design: DesignModel, amplitudes: FloatArray, near: FloatArray) -> FloatArray:
    """|L N| - 1 where L N is real and negative; NaN where it is not."""
    slopes = _play(design, amplitudes)
    omega = _real_axis(loop, slopes, near)
    with np.errstate(invalid="ignore"):  # NaN goes through
        return np.asarray(np.abs(loop(omega) * slopes) - 1.0)


def _bisect(loop: LinearLoop, design: DesignModel, low: FloatArray, high: FloatArray, near: FloatArray) -> FloatArray:
    """The amplitudes between `low` and `high` at which |L N| goes through 1."""
    sign = np.sign(_excess(loop, design, low, near))
    for _ in range(40):
        middle = 0.5 * (low + high)
        same = np.sign(_excess(loop, design, middle, near)) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return 0.5 * (low + high)
