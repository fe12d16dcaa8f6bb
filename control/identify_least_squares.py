"""Least squares that a few false readings cannot pull, for a handful of bounded numbers and many rows.

Levenberg-Marquardt with soft-L1 weights on the normal equations: for fewer than twenty numbers that is accurate enough,
and many times faster than decomposing the whole Jacobian in every step.
Source: Marquardt, SIAM J. Appl. Math. 11 (1963) 431; weights: Holland and Welsch, Commun. Stat. A6 (1977) 813.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from control.identify_model import compiled
from logs.recording import FloatArray

SMALLEST_GAIN = 1e-7  # relative fall of the cost below which it is done


@dataclass(frozen=True, slots=True)
class Problem:
    """`residual` (data - prediction) as a function of the numbers; their bounds; a small change of each; `soft` is
    the residual beyond which a row counts less and less."""

    residual: Callable[[FloatArray], FloatArray]
    low: FloatArray
    high: FloatArray
    steps: FloatArray
    soft: float


@compiled
def _normal(slopes: FloatArray, rest: FloatArray, soft: float, matrix: FloatArray, vector: FloatArray) -> None:
    p, n = slopes.shape
    for k in range(n):
        weight = 1.0 / np.sqrt(1.0 + (rest[k] / soft) ** 2)
        for i in range(p):
            scaled = weight * slopes[i, k]
            vector[i] -= scaled * rest[k]
            for j in range(i + 1):
                matrix[i, j] += scaled * slopes[j, k]
    for i in range(p):
        for j in range(i):
            matrix[j, i] = matrix[i, j]


def soft_cost(rest: FloatArray, soft: float) -> float:
    """Sum of 2 soft^2 (sqrt(1 + (r / soft)^2) - 1): r^2 for small, 2 soft |r| for large residuals."""
    return float(2.0 * soft**2 * np.sum(np.sqrt(1.0 + (rest / soft) ** 2) - 1.0))


def slopes_of(problem: Problem, at: FloatArray, rest: FloatArray) -> FloatArray:
    """d residual / d number by forward differences (backward at an upper bound), shape (numbers, rows)."""
    steps = np.where(at + problem.steps < problem.high, problem.steps, -problem.steps)
    return np.stack(
        [(problem.residual(at + step * unit) - rest) / step for step, unit in zip(steps, np.eye(at.size), strict=True)]
    )


def minimise(problem: Problem, start: FloatArray, *, rounds: int) -> tuple[FloatArray, float]:
    """The numbers with the lowest soft cost near `start`, and that cost, after at most `rounds` Jacobians."""
    at = np.clip(start, problem.low, problem.high)
    rest = problem.residual(at)
    cost, damping = soft_cost(rest, problem.soft), 1e-3
    for _ in range(rounds):
        slopes = slopes_of(problem, at, rest)
        matrix, vector = np.zeros((at.size, at.size)), np.zeros(at.size)
        _normal(slopes, rest, problem.soft, matrix, vector)
        before = cost
        for _ in range(8):
            trial = _step(problem, at, matrix, vector, damping)
            trial_rest = problem.residual(trial)
            trial_cost = soft_cost(trial_rest, problem.soft)
            if trial_cost < cost:
                at, rest, cost, damping = trial, trial_rest, trial_cost, max(damping / 6.0, 1e-9)
                break
            damping *= 5.0
        if before - cost <= SMALLEST_GAIN * before:
            break
    return at, cost


def _step(problem: Problem, at: FloatArray, matrix: FloatArray, vector: FloatArray, damping: float) -> FloatArray:
    """One damped step; a number at a bound that it wants to cross stays there."""
    stuck = ((at <= problem.low) & (vector < 0.0)) | ((at >= problem.high) & (vector > 0.0))
    size = np.diag(matrix)
    free = ~stuck & (size > 0.0)
    move = np.zeros_like(at)
    if free.any():
        inner = matrix[np.ix_(free, free)] + damping * np.diag(size[free])
        move[free] = np.linalg.lstsq(inner, vector[free], rcond=None)[0]
    return np.clip(at + move, problem.low, problem.high)
