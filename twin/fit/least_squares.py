"""Bounded Levenberg-Marquardt for a few unknowns and many residuals.

Written here because the general ones spend most of their time on an SVD of the tall Jacobian, which costs more than
the simulations; the normal equations of at most a dozen scaled unknowns are cheap and well conditioned enough.
Source: Nocedal, Wright, Numerical Optimization, 2nd ed. (2006), section 10.3; Marquardt's diagonal scaling.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray

Residuals = Callable[[FloatArray], FloatArray]
Slopes = Callable[[FloatArray], FloatArray]

_DAMPINGS = (1e-3, 1e-1, 1e1, 1e3)


@dataclass(frozen=True, slots=True)
class Minimum:
    """Where the search ended: unknowns `z`, `cost` = sum of squares, simulations used; `normal` = J'J where its last
    round began.

    That is one step early on purpose. Another Jacobian at the end would cost a fifth to a quarter of all time spent
    here, and what is quoted does not need it: a hypothesis that is accepted has been fitted again from where it ended,
    and the standard errors of seven such (`bench/inverse_crime.py`, seed 5, cases 0 to 9) differ by 0.1 % at most. Of
    the thousand fits that four of these diagnoses made on the way, the largest change of an unknown's error is below
    0.2 % in the middle one and a factor of 2 to 8 in one in twenty: hypotheses that the search left unfinished.
    """

    z: FloatArray
    cost: float
    residuals: FloatArray
    normal: FloatArray
    evaluations: int


def jacobian(residuals: Residuals, z: FloatArray, r: FloatArray, steps: FloatArray, upper: FloatArray) -> FloatArray:
    """Forward differences, backward where the upper bound is near; shape (n, len(z))."""
    columns = np.empty((r.size, z.size), order="F")
    for k, step in enumerate(steps):
        signed = -step if z[k] + step > upper[k] else step
        moved = z.copy()
        moved[k] += signed
        columns[:, k] = (residuals(moved) - r) / signed
    return columns


def minimise(
    residuals: Residuals,
    start: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    steps: FloatArray,
    rounds: int = 12,
    about: Slopes | None = None,
) -> Minimum:
    """Minimises the sum of squares from `start` within the bounds; stops when a round gains less than 1e-4 of it.

    `about`: a Jacobian that costs less and is about right, for as long as its steps lead anywhere.
    """
    z = np.clip(start, lower, upper)
    r = residuals(z)
    cost = float(r @ r)
    used = 1
    normal = np.zeros((z.size, z.size))
    first = 0
    for _ in range(rounds if z.size else 0):
        j = jacobian(residuals, z, r, steps, upper) if about is None else about(z)
        used += z.size
        normal = j.T @ j
        gradient = j.T @ r
        better = False
        before = cost
        for index in range(first, len(_DAMPINGS)):
            trial = np.clip(z + _step(normal, gradient, z, lower, upper, _DAMPINGS[index]), lower, upper)
            new_r = residuals(trial)
            used += 1
            new_cost = float(new_r @ new_r)
            if new_cost < cost:
                z, r, cost, better = trial, new_r, new_cost, True
                first = max(0, index - 1)
                break
        if about is not None and not better:
            about, first = None, 0
        elif not better or before - cost < 1e-4 * before:
            break
    return Minimum(z, cost, r, normal, used)


def _step(
    normal: FloatArray, gradient: FloatArray, z: FloatArray, lower: FloatArray, upper: FloatArray, damping: float
) -> FloatArray:
    """The damped step; an unknown that sits at its bound and wants out stays there."""
    free = ~(((z <= lower) & (gradient > 0.0)) | ((z >= upper) & (gradient < 0.0)))
    step = np.zeros_like(z)
    if free.any():
        a = normal[np.ix_(free, free)]
        diagonal = np.diag(a)
        a = a + np.diag(damping * diagonal + 1e-12 * max(float(diagonal.max()), 1e-300))
        step[free] = -np.linalg.lstsq(a, gradient[free], rcond=None)[0]
    return step


def descend(
    residuals: Residuals, start: FloatArray, which: np.ndarray, lower: FloatArray, upper: FloatArray
) -> FloatArray:
    """Pattern search over the unknowns `which`, to which the response jumps, with shrinking relative steps.

    Source: Hooke, Jeeves, J. ACM 8 (1961) 212.
    """
    z = np.clip(start, lower, upper)
    r = residuals(z)
    cost = float(r @ r)
    for size in (0.12, 0.05, 0.02, 0.008, 0.003, 0.001):
        for k in which:
            for sign in (1.0, -1.0):
                trial = z.copy()
                trial[k] = np.clip(z[k] * (1.0 + sign * size), lower[k], upper[k])
                r = residuals(trial)
                if float(r @ r) < cost:
                    z, cost = trial, float(r @ r)
                    break
    return z
