"""Shapes over the position grid with which effects bend the curves; `xi` is position / travel, 0 = open, 1 = closed."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray


def bow(xi: FloatArray) -> FloatArray:
    """A parabola: 0 at both ends, 1 at mid travel."""
    return 4.0 * xi * (1.0 - xi)


def swing(xi: FloatArray) -> FloatArray:
    """A cubic: 0 at both ends and at mid travel, about +1 at 21 % and -1 at 79 % of travel."""
    return 10.4 * xi * (1.0 - xi) * (1.0 - 2.0 * xi)


def bump(xi: FloatArray, centre: float, width: float) -> FloatArray:
    """A bell of height 1 at `centre`; `width` is its standard deviation as a fraction of travel."""
    return np.exp(-0.5 * np.square((xi - centre) / max(width, 1e-3)))


def detrended(shape: FloatArray, xi: FloatArray) -> FloatArray:
    """`shape` without the straight line that fits it best, so that it says nothing about offset and compliance."""
    slope, level = np.polyfit(xi, shape, 1)
    rest: FloatArray = shape - (level + slope * xi)
    return rest
