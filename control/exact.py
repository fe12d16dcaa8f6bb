"""Arithmetic that gives the same bits on every machine: + - * / and square roots, in a fixed order.

exp and pow of the C library, those of numpy, BLAS and LAPACK choose their instructions by the processor they find, and
so differ in the last bit from machine to machine. A controller branches, and a branch makes a centimetre of a bit. So
controllers use what is here, on plain floats: IEEE 754 defines each of these operations to the last bit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

Matrix = list[list[float]]
Row = Sequence[tuple[int, float]]  # the places of a row that are not zero, and what is there
_PART = 0.0625
_ORDER = 9
_NOTHING = 700.0
_LOST = 1e-13  # of a variance: what is left of it is rounding


@lru_cache(maxsize=256)
def decay(u: float) -> float:
    """exp(-u) for u >= 0, to some 1e-15 of it for u < 1: a Taylor series near 0, squared as often as needed.

    Source: "scaling and squaring", Moler and Van Loan, "Nineteen dubious ways to compute the exponential of a matrix".
    """
    if u > _NOTHING:
        return 0.0
    halvings = 0
    while u > _PART:
        u *= 0.5
        halvings += 1
    left = 1.0
    for order in range(_ORDER, 0, -1):
        left = 1.0 - u * left / order
    for _ in range(halvings):
        left *= left
    return left


def sign(value: float) -> int:
    """1 for what is above 0, else -1."""
    return 1 if value > 0.0 else -1


def lag(dt_s: float, tau_s: float) -> float:
    """The share of a first-order lag's way that it goes in a time; all of it without a lag."""
    return 1.0 - decay(dt_s / tau_s) if tau_s > 0.0 else 1.0


def length(a: float, b: float) -> float:
    """The square root of a^2 + b^2."""
    return math.sqrt(a * a + b * b)


def triangle(covariance: Matrix) -> Matrix:
    """The lower triangle L with L L' = covariance (Cholesky); a column is zero where nothing but rounding is left, so
    that a covariance without full rank has one too."""
    size = len(covariance)
    lower = [[0.0] * size for _ in range(size)]
    for j in range(size):
        row = lower[j]
        left = covariance[j][j]
        for value in row[:j]:
            left -= value * value
        if left <= _LOST * covariance[j][j]:
            continue
        pivot = math.sqrt(left)
        row[j] = pivot
        for i in range(j + 1, size):
            below = lower[i]
            total = covariance[i][j]
            for c in range(j):
                total -= below[c] * row[c]
            below[j] = total / pivot
    return lower


def times(matrix: Matrix, row: Row) -> list[float]:
    """matrix row', one number per line of the matrix."""
    found = []
    for line in matrix:
        total = 0.0
        for place, value in row:
            total += value * line[place]
        found.append(total)
    return found


def dot(row: Row, values: Sequence[float]) -> float:
    """row values'."""
    total = 0.0
    for place, value in row:
        total += value * values[place]
    return total


def considered(
    mean: list[float], covariance: Matrix, row: Row, off: float, variance: float, learns: int
) -> tuple[list[float], Matrix]:
    """Mean and covariance after `row` times what is unknown was found larger by `off`, with this variance.

    The first `learns` learn; the others are only considered (Schmidt's filter). The covariance is Joseph's form,
    P - g t' - t g' + s g g' with t = P row' and s = row t + variance, which is one whatever the gain g is.
    """
    toward = times(covariance, row)
    power = dot(row, toward) + variance
    gain = [value / power if place < learns else 0.0 for place, value in enumerate(toward)]
    learned = [value + g * off for value, g in zip(mean, gain, strict=True)]
    after = [line.copy() for line in covariance]
    for i, (g, t) in enumerate(zip(gain, toward, strict=True)):
        for j in range(i + 1):
            after[i][j] += power * g * gain[j] - g * toward[j] - t * gain[j]
            after[j][i] = after[i][j]
    return learned, after
