"""Limit cycles by harmonic balance: several harmonics, the play and the rate limit in the time domain, no formula.

It checks the describing function (one harmonic, no rate limit), and says what the describing function leaves out. It
looks for its starting points itself, so that it can find what the describing function misses.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from control.analysis.limit_cycle import LimitCycle
from control.analysis.loop import LinearLoop
from control.design import DesignModel

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Orders = npt.NDArray[np.int_]
POINTS = 256
RESIDUAL = 1e-5
SMALLEST = 0.01  # of travel; a smaller swing is not looked for
STARTS = 6


@dataclass(frozen=True, slots=True)
class Balanced:
    """A periodic solution: half the peak-to-peak of the stem [in], the period [s], and how well the harmonics balance
    (the residual's norm over the norm of the pressure's harmonics)."""

    stem_in: float
    period_s: float
    residual: float


def find_cycles(loop: LinearLoop, design: DesignModel, harmonics: int = 4) -> list[Balanced]:
    """Every limit cycle that the balance finds, largest first; no describing function takes part.

    Starts where, over a grid of amplitudes and frequencies, the first harmonic alone comes nearest to balance.
    """
    found: list[Balanced] = []
    for cycle in _solve(loop, design, starting_points(loop, design), harmonics):
        new = all(abs(cycle.stem_in / other.stem_in - 1.0) > 0.02 for other in found)
        if cycle.residual < RESIDUAL and 2.0 * cycle.stem_in > SMALLEST * design.travel and new:
            found.append(cycle)
    return sorted(found, key=lambda cycle: -cycle.stem_in)


def starting_points(loop: LinearLoop, design: DesignModel) -> list[LimitCycle]:
    """Local minima of the first harmonic's imbalance, best first, from just above half the deadband to forty times
    it and over periods from 1.5 to 60 times the lags of the loop."""
    lags_s = loop.stem_tau_s + loop.ep_tau_s + loop.dead_time_s + loop.late_s + loop.tick_s
    amplitudes = 0.5 * design.deadband * np.geomspace(1.02, 40.0, 32)
    omegas = 2.0 * np.pi / (lags_s * np.geomspace(1.5, 60.0, 40))
    grid = np.array([(a, w) for a in amplitudes for w in omegas])
    waves = stem_waves(np.array([1]), np.asarray(grid[:, :1], dtype=np.complex128), grid[:, 1], design, loop.stem_tau_s)
    stem = np.fft.rfft(waves)[:, 1] * 2.0 / POINTS
    off = np.abs(1.0 + loop.before_play(grid[:, 1]) * stem / grid[:, 0]).reshape(amplitudes.size, omegas.size)
    around = np.pad(off, 1, constant_values=np.inf)
    neighbours = [np.roll(around, by, (0, 1))[1:-1, 1:-1] for by in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    lowest = np.argwhere((off < 1.0) & np.all([off <= n for n in neighbours], axis=0))
    best = sorted(lowest.tolist(), key=lambda at: float(off[at[0], at[1]]))[:STARTS]
    return [LimitCycle(float(amplitudes[i]), 0.0, float(omegas[j]), True) for i, j in best]


def balance(loop: LinearLoop, design: DesignModel, start: LimitCycle, harmonics: int = 4) -> Balanced:
    """The limit cycle near `start`, with the odd harmonics 1, 3, ... (2 `harmonics` - 1) balanced.

    The equations: pressure harmonic h = -B(j h w) stem harmonic h, the stem being the settled answer of play, rate
    limit and lag to the pressure. The unknowns are scaled by the starting point.
    """
    return _solve(loop, design, [start], harmonics)[0]


def _solve(loop: LinearLoop, design: DesignModel, starts: Sequence[LimitCycle], harmonics: int) -> list[Balanced]:
    """All starts side by side by Levenberg's and Marquardt's steps: a wave takes as long as a hundred of them.

    An unknown is the logarithm of the frequency, the others are the pressure's harmonics; the first one is real.
    """
    if not starts:
        return []
    orders, n, m = 2 * np.arange(harmonics) + 1, 2 * harmonics, len(starts)
    scale, omega_0 = np.array([s.pressure_psi for s in starts]), np.array([s.omega for s in starts])

    def waves(z: FloatArray) -> tuple[FloatArray, ComplexArray, FloatArray]:
        """Of unknowns with shape (starts, rows, n): frequencies, pressure harmonics, stem waves, a row each."""
        pressure = z[..., 0::2] + 1j * z[..., 1::2]
        pressure[..., 0] = z[..., 1]
        pressure = (pressure * scale[:, None, None]).reshape(-1, harmonics)
        omega = (omega_0[:, None] * np.exp(np.clip(z[..., 0], -3.0, 3.0))).ravel()
        return omega, pressure, stem_waves(orders, pressure, omega, design, loop.stem_tau_s)

    def residuals(z: FloatArray) -> FloatArray:
        omega, pressure, wave = waves(z)
        stem = np.fft.rfft(wave)[:, orders] * 2.0 / POINTS
        error = pressure + loop.before_play(np.outer(omega, orders)) * stem
        shaped = np.concatenate([error.real, error.imag], axis=1).reshape(m, -1, n)
        return np.asarray(shaped / scale[:, None, None])

    z = np.zeros((m, n))
    z[:, 1] = 1.0
    z, left = levenberg_marquardt(residuals, z)
    omega, pressure, wave = waves(z[:, None, :])
    size = np.linalg.norm(pressure, axis=1) / scale
    return [
        Balanced(0.5 * float(np.ptp(wave[i])), float(2.0 * np.pi / omega[i]), float(left[i] / size[i]))
        if size[i] > 0.1
        else Balanced(0.0, float(2.0 * np.pi / omega[i]), float("inf"))
        for i in range(m)
    ]


def levenberg_marquardt(
    residuals: Callable[[FloatArray], FloatArray], z: FloatArray, steps: int = 25
) -> tuple[FloatArray, FloatArray]:
    """The unknowns `z`, shape (starts, n), of every start after `steps` damped steps, and the norms of what is left.

    `residuals` takes shape (starts, rows, n) and gives the same shape.
    """
    m, n = z.shape
    nudges = np.vstack([np.zeros(n), 1e-5 * np.eye(n)])

    def slopes(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        rows = residuals(at[:, None, :] + nudges)
        return rows[:, 0], np.swapaxes((rows[:, 1:] - rows[:, :1]) / 1e-5, 1, 2)

    damping = np.full(m, 1e-2)
    left, jacobian = slopes(z)
    for _ in range(steps):
        turned = np.swapaxes(jacobian, 1, 2)
        normal = turned @ jacobian + damping[:, None, None] * np.eye(n)
        trial = z - np.linalg.solve(normal, turned @ left[..., None])[..., 0]
        trial_left, trial_jacobian = slopes(trial)
        better = np.linalg.norm(trial_left, axis=1) < np.linalg.norm(left, axis=1)
        damping = np.where(better, damping / 5.0, damping * 4.0)
        z, left = np.where(better[:, None], trial, z), np.where(better[:, None], trial_left, left)
        jacobian = np.where(better[:, None, None], trial_jacobian, jacobian)
    return z, np.linalg.norm(left, axis=1)


def stem_waves(
    orders: Orders, pressure: ComplexArray, omega: FloatArray, design: DesignModel, tau_s: float
) -> FloatArray:
    """One settled period of the stem for every row of pressure harmonics, shape (rows, POINTS) [in].

    `pressure` has shape (rows, orders) [psi], `omega` (rows,) [rad/s].
    """
    angle = 2.0 * np.pi * np.arange(POINTS) / POINTS
    waves = np.real(np.exp(1j * np.outer(angle, orders)) @ pressure.T)
    dt_s = 2.0 * np.pi / omega / POINTS
    periods = 2 + int(np.ceil(5.0 * tau_s * float(omega.max()) / (2.0 * np.pi)))
    half, k, rate = 0.5 * design.deadband, design.compliance, design.rate_limit
    z, x = waves[0].copy(), np.zeros(omega.size)
    out = np.empty((POINTS, omega.size))
    for _ in range(min(periods, 12)):
        for i, wave in enumerate(waves):
            before = z
            z = np.minimum(np.maximum(z, wave - half), wave + half)
            x = _follow(x, 0.5 * k * (before + z), tau_s, rate, dt_s)
            out[i] = x
    return np.asarray((out - out.mean(axis=0)).T)


def _follow(x: FloatArray, w: FloatArray, tau_s: float, rate: float, dt_s: FloatArray) -> FloatArray:
    """`control.observer.follow` for many stems at once."""
    gap = w - x
    straight_s = np.minimum(np.maximum(np.abs(gap) / rate - tau_s, 0.0), dt_s)
    x = x + np.copysign(rate * straight_s, gap)
    return w - (w - x) * np.exp((straight_s - dt_s) / tau_s) if tau_s > 0.0 else w
