"""What the valve's kernels are given besides the pressure."""

from __future__ import annotations

from logs.recording import FloatArray

#: First pressure, step, closing and opening curve; and the spreads and weights of the elements.
Tables = tuple[float, float, FloatArray, FloatArray]
Plays = tuple[FloatArray, FloatArray]
#: Over the stem's position, 0 .. travel: extra pressure (closing, opening), relative compliance; single points: none.
Bends = tuple[FloatArray, FloatArray, FloatArray]
#: What the half deadband grows by (closing, opening), compliance relative to the design's.
Grown = tuple[float, float, float]
