"""The points that stand for what is known of a play and its stem: each goes through the play, then they are one again.

A point: stem, rate limit, travel, play output, closing edge, opening edge, compliance, as in `control/play_filter.py`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from control.exact import Matrix, decay, triangle

X, R, T, W, A1, A2, K = range(7)
SIZE = 7
REACH = math.sqrt(7.0)  # of the points, in standard deviations


def moved(
    mean: Sequence[float], cov: Matrix, pressures: Sequence[float], tau_s: float, part_s: float
) -> tuple[float, float]:
    """Mean stem and play output [in] after these pressures [psi], each in force for `part_s`, by fourteen points; `cov`
    changes with them. The five numbers stay what they are, and so does the covariance among them."""
    root, up, down = triangle(cov), [], []
    for c in range(SIZE):
        column = [REACH * line[c] for line in root]
        up.append(_through([m + r for m, r in zip(mean, column, strict=True)], pressures, tau_s, part_s))
        down.append(_through([m - r for m, r in zip(mean, column, strict=True)], pressures, tau_s, part_s))
    return _gathered(cov, root, up, down)


def _through(point: Sequence[float], pressures: Sequence[float], tau_s: float, part_s: float) -> tuple[float, float]:
    """Stem and play output of one point after these pressures, one per part: the play, then the rate-limited lag of
    `observer.follow`."""
    x, rate, travel, w, a1, a2, k = point
    fade = decay(part_s / tau_s) if tau_s > 0.0 else 0.0
    for p in pressures:
        before = w
        w = min(max(k * (p - a1), min(k * (p - a2), w), 0.0), travel)
        toward = 0.5 * (before + w)
        gap = toward - x
        straight_s = min(abs(gap) / rate - tau_s, part_s)
        if straight_s <= 0.0 or tau_s <= 0.0:
            x = toward - gap * fade
        else:
            x += math.copysign(rate * straight_s, gap)
            x = toward - (toward - x) * decay((part_s - straight_s) / tau_s)
    return x, w


def _gathered(
    cov: Matrix, root: Matrix, up: Sequence[tuple[float, float]], down: Sequence[tuple[float, float]]
) -> tuple[float, float]:
    """The means of stem and play output over points that began at +- the root's columns; their covariances go into
    `cov`."""
    points = [*up, *down]
    centre_x, centre_w = points[0]
    x = w = 0.0
    for each_x, each_w in points:
        x += each_x - centre_x
        w += each_w - centre_w
    x, w = centre_x + x / len(points), centre_w + w / len(points)
    xx = xw = ww = 0.0
    for each_x, each_w in points:
        xx += (each_x - x) * (each_x - x)
        xw += (each_x - x) * (each_w - w)
        ww += (each_w - w) * (each_w - w)
    cov[X][X], cov[W][W], cov[X][W] = xx / len(points), ww / len(points), xw / len(points)
    cov[W][X] = cov[X][W]
    for i in (R, T, A1, A2, K):
        with_x = with_w = 0.0
        for r, (up_x, up_w), (down_x, down_w) in zip(root[i], up, down, strict=True):
            with_x += r * (up_x - down_x)
            with_w += r * (up_w - down_w)
        cov[X][i] = cov[i][X] = REACH * with_x / len(points)
        cov[W][i] = cov[i][W] = REACH * with_w / len(points)
    return x, w
