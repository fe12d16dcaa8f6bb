"""Limit cycles that the describing function predicts: where the linear part meets -1 / N(A)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from control.analysis.describing import play_describing_function
from control.analysis.loop import LinearLoop
from control.design import DesignModel

FloatArray = npt.NDArray[np.float64]


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
    half = 0.5 * design.deadband
    amplitudes = half * (1.0 + np.geomspace(1e-3, 50.0, n))
    found: list[LimitCycle] = []
    for low, high, omega_low in _frequencies(loop, design, amplitudes, points):
        before, after = _excess(loop, design, low, omega_low), _excess(loop, design, high, omega_low)
        if np.isnan(before) or np.isnan(after) or before * after > 0.0:
            continue
        amplitude, omega = _bisect(loop, design, low, high, omega_low)
        output = amplitude * abs(_play(design, amplitude))
        stem = output * abs(complex(loop.after_play(np.array([omega]))[0]))
        found.append(LimitCycle(amplitude, stem, omega, before > 0.0 > after))
    return found


def grows(loop: LinearLoop, design: DesignModel) -> bool:
    """Whether the loop is unstable with the play wide open, so that oscillations beyond some size grow without end."""
    omega = np.geomspace(1e-3, np.pi / loop.tick_s if loop.tick_s else 1e3, 2000)
    line = loop(omega) * design.compliance
    crossing = (np.diff(np.sign(line.imag)) != 0) & (line.real[:-1] < -1.0)
    return bool(crossing.any())


def _frequencies(
    loop: LinearLoop, design: DesignModel, amplitudes: FloatArray, points: int
) -> list[tuple[float, float, float]]:
    """Neighbouring amplitudes, with every frequency at which the lower one makes the loop real and negative."""
    grid = np.geomspace(1e-3, np.pi / loop.tick_s if loop.tick_s else 1e3, points)
    line = loop(grid)
    triples = []
    for low, high in pairwise(amplitudes):
        turned = line * _play(design, float(low))
        crossing = np.nonzero((np.diff(np.sign(turned.imag)) != 0) & (turned.real[:-1] < 0.0))[0]
        triples += [(float(low), float(high), float(grid[i])) for i in crossing]
    return triples


def _play(design: DesignModel, amplitude: float) -> complex:
    return complex(play_describing_function(np.array([amplitude]), design.deadband, design.compliance)[0])


def _real_axis(loop: LinearLoop, n: complex, near: float) -> float:
    """The frequency near `near` at which L N is real [rad/s]; NaN where there is none within 20 %."""
    low, high = near / 1.2, near * 1.2
    grid = np.geomspace(low, high, 60)
    imaginary = (loop(grid) * n).imag
    crossing = np.nonzero(np.diff(np.sign(imaginary)) != 0)[0]
    if crossing.size == 0:
        return float("nan")
    i = crossing[np.argmin(np.abs(np.log(grid[crossing] / near)))]
    share = imaginary[i] / (imaginary[i] - imaginary[i + 1])
    return float(grid[i] + share * (grid[i + 1] - grid[i]))


def _excess(loop: LinearLoop, design: DesignModel, amplitude: float, near: float) -> float:
    """|L N| - 1 where L N is real and negative."""
    n = _play(design, amplitude)
    omega = _real_axis(loop, n, near)
    if np.isnan(omega):
        return float("nan")
    return float(abs(complex(loop(np.array([omega]))[0]) * n) - 1.0)


def _bisect(loop: LinearLoop, design: DesignModel, low: float, high: float, near: float) -> tuple[float, float]:
    sign = np.sign(_excess(loop, design, low, near))
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sign(_excess(loop, design, middle, near)) == sign else (low, middle)
    amplitude = 0.5 * (low + high)
    n = _play(design, amplitude)
    return amplitude, _real_axis(loop, n, near)
