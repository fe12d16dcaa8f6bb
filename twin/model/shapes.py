"""Shapes over the position grid with which effects bend the curves; `xi` is position / travel, 0 = open, 1 = closed."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.model.effect import Parameter

CENTRE = Parameter(
    name="centre",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.2, 0.5, 0.8),
    scale=0.2,
    doc="where on the travel, 0 = open",
    neutral=0.5,
    size=False,
)
WIDTH = Parameter(
    name="width",
    kind="fraction",
    lower=0.02,
    upper=0.3,
    starts=(0.08,),
    scale=0.05,
    doc="standard deviation of the bell, fraction of travel",
    neutral=0.1,
    size=False,
)
#: A moment of all recordings, looked for at so many: what changes all at once shows from there on only.
WHEN = Parameter(
    name="when",
    kind="fraction",
    lower=0.02,
    upper=0.98,
    starts=tuple(0.02 + 0.96 * (0.5 + k) / 24 for k in range(24)),
    scale=0.2,
    doc="when it changes, fraction of all recordings",
    neutral=0.5,
    smooth=False,
    size=False,
)


def bow(xi: FloatArray) -> FloatArray:
    """A parabola: 0 at both ends, 1 at mid travel."""
    return 4.0 * xi * (1.0 - xi)


def swing(xi: FloatArray) -> FloatArray:
    """A cubic: 0 at both ends and at mid travel, about +1 at 21 % and -1 at 79 % of travel."""
    return 10.4 * xi * (1.0 - xi) * (1.0 - 2.0 * xi)


def bump(xi: FloatArray, centre: float, width: float) -> FloatArray:
    """A bell of height 1 at `centre`; `width` is its standard deviation as a fraction of travel."""
    return np.exp(-0.5 * np.square((xi - centre) / max(width, 1e-3)))


def edge(xi: FloatArray, centre: float, width: float) -> FloatArray:
    """From 0 to 1 about `centre`; there as steep as a straight piece as long as `width`, a fraction of travel."""
    return 0.5 * (1.0 + np.tanh(2.0 * (xi - centre) / max(width, 1e-9)))


def detrended(shape: FloatArray, xi: FloatArray) -> FloatArray:
    """`shape` without the straight line that fits it best, so that it says nothing about offset and compliance."""
    slope, level = np.polyfit(xi, shape, 1)
    rest: FloatArray = shape - (level + slope * xi)
    return rest
