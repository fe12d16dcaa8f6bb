"""A straight line through points that outliers cannot pull, with a covariance that holds also for few of them.

Fewer points than `ROBUST_FROM` are fitted by least squares: of so few none can be told to be false, and a false one
makes the interval wide. From there on: bisquare weights from a Theil-Sen start, whose scale stays as it is at the start
(one that is found anew shrinks until two points lie on the line and the rest count for nothing). Covariance by psi and
psi' with Huber's correction for few points. Sources: Maronna, Martin and Yohai, "Robust Statistics", Wiley 2006,
chapter 5; Huber, "Robust Statistics", Wiley 1981, section 7.6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray

ROBUST_FROM = 8
BISQUARE = 4.685  # scales: what is further off counts for nothing
_ROUNDS = 20


@dataclass(frozen=True, slots=True)
class Line:
    """y = `start` + `slope` x; `spread` is the covariance of (start, slope), with Student's `freedom`."""

    start: float
    slope: float
    spread: FloatArray
    freedom: int
    used: np.ndarray  # which points count, shape (n,)


def robust_line(x: FloatArray, y: FloatArray) -> Line:
    """The line through three or more points, shape (n,), that do not all have the same x."""
    design = np.column_stack((np.ones_like(x), x))
    freedom = max(1, x.size - 2)
    if x.size < ROBUST_FROM:
        found = np.linalg.lstsq(design, y, rcond=None)[0]
        rest = y - design @ found
        variance = float(rest @ rest) / freedom
        used = np.ones(x.size, dtype=bool)
    else:
        found, variance, used = _bisquare(design, y)
    spread = np.asarray(np.linalg.inv(design.T @ design) * variance, dtype=np.float64)
    return Line(float(found[0]), float(found[1]), spread, freedom, used)


def _bisquare(design: FloatArray, y: FloatArray) -> tuple[FloatArray, float, np.ndarray]:
    """The line, the variance that its covariance takes in place of the residuals', and which points count."""
    from scipy.stats import theilslopes

    n = y.size
    slope = float(theilslopes(y, design[:, 1])[0])
    found = np.array([float(np.median(y - slope * design[:, 1])), slope])
    # The start passes through two of the points or nearly so: those two say nothing of how far the others scatter.
    rest = np.sort(np.abs(y - design @ found))[2:]
    scale = 1.4826 * float(np.median(rest)) * np.sqrt(n / (n - 2)) + 1e-12 + 1e-6 * float(np.ptp(y))
    for _ in range(_ROUNDS):
        far = np.clip(np.abs(y - design @ found) / (BISQUARE * scale), 0.0, 1.0)
        weight = (1.0 - far**2) ** 2
        found = np.linalg.solve(design.T @ (design * weight[:, None]), design.T @ (weight * y))
    rest = y - design @ found
    far = np.clip(np.abs(rest) / (BISQUARE * scale), 0.0, 1.0)
    psi, steep = (1.0 - far**2) ** 2 * rest, (1.0 - far**2) * (1.0 - 5.0 * far**2)
    mean = float(np.mean(steep))
    few = 1.0 + 2.0 / n * float(np.var(steep)) / mean**2
    return found, few**2 * float(psi @ psi) / (n - 2) / mean**2, far < 1.0
