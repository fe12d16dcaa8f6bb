"""Limit cycles by harmonic balance: several harmonics, the play and the rate limit in the time domain, no formula.

It checks the describing function (one harmonic, no rate limit), and says what the describing function leaves out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from control.analysis.limit_cycle import LimitCycle
from control.analysis.loop import LinearLoop
from control.design import DesignModel
from control.observer import follow

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
POINTS = 256


@dataclass(frozen=True, slots=True)
class Balanced:
    """A periodic solution: half the peak-to-peak of the stem [in], the period [s], and how well the harmonics balance
    (the residual's norm over the norm of the pressure's harmonics)."""

    stem_in: float
    period_s: float
    residual: float


def balance(loop: LinearLoop, design: DesignModel, start: LimitCycle, harmonics: int = 4) -> Balanced:
    """The limit cycle near `start`, with the odd harmonics 1, 3, ... (2 `harmonics` - 1) balanced.

    The equations: pressure harmonic h = -B(j h w) stem harmonic h, the stem being the settled answer of play, rate
    limit and lag to the pressure. The unknowns are scaled by the starting point.
    """
    from scipy.optimize import least_squares

    orders = 2 * np.arange(harmonics) + 1
    scale = start.pressure_psi

    def unpack(z: FloatArray) -> tuple[float, ComplexArray]:
        pressure = np.empty(harmonics, dtype=np.complex128)
        pressure[0] = scale * z[1]
        pressure[1:] = scale * (z[2::2] + 1j * z[3::2])
        return start.omega * float(np.exp(z[0])), pressure

    def residual(z: FloatArray) -> FloatArray:
        omega, pressure = unpack(z)
        stem: ComplexArray = np.fft.rfft(stem_wave(orders, pressure, omega, design, loop.stem_tau_s)) * 2.0 / POINTS
        error: ComplexArray = (
            pressure + loop.before_play(np.asarray(orders * omega, dtype=np.float64)) * stem[orders]
        ) / scale
        return np.concatenate([error.real, error.imag])

    z0 = np.zeros(2 * harmonics)
    z0[1] = 1.0
    found = least_squares(residual, z0, xtol=1e-9, ftol=1e-9, max_nfev=60)
    omega, pressure = unpack(found.x)
    wave = stem_wave(orders, pressure, omega, design, loop.stem_tau_s)
    size = float(np.linalg.norm(pressure)) / scale
    left = float(np.linalg.norm(found.fun)) / size if size > 0.1 else float("inf")
    return Balanced(0.5 * float(np.ptp(wave)), float(2.0 * np.pi / omega), left)


def stem_wave(
    orders: npt.NDArray[np.int_], pressure: ComplexArray, omega: float, design: DesignModel, tau_s: float
) -> FloatArray:
    """One settled period of the stem for a pressure of these harmonics, shape (POINTS,) [in]."""
    angle = 2.0 * np.pi * np.arange(POINTS) / POINTS
    wave = np.real(np.exp(1j * np.outer(angle, orders)) @ pressure)
    dt_s = 2.0 * np.pi / omega / POINTS
    periods = 2 + int(np.ceil(5.0 * tau_s * omega / (2.0 * np.pi)))
    half, k = 0.5 * design.deadband, design.compliance
    z, x = float(wave[0]), 0.0
    out = np.empty(POINTS)
    for _ in range(min(periods, 12)):
        for i in range(POINTS):
            before = z
            z = min(max(z, wave[i] - half), wave[i] + half)
            x = follow(x, 0.5 * k * (before + z), tau_s, design.rate_limit, dt_s)
            out[i] = x
    return np.asarray(out - out.mean(), dtype=np.float64)
