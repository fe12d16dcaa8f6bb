"""Steps of a reading under noise that came after them: a digital gauge behind an analog line.

Such readings lie on no lattice, but about one. While the stem moves it passes all places alike, so that readings which
crowd about places a step apart were rounded there. Where it rests they crowd anyhow: these rows say nothing.
Source: Mardia, Jupp, Directional Statistics (Wiley 2000), section 5.3 (mean resultant length).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import DataNote, FloatArray, Recording
from logs.spoken import HOUSE, Spoken

#: What moves goes so many standard deviations of the noise in `_WITHIN_S` to either side.
_MOVES, _WITHIN_S = 8.0, 0.15
#: So many rows further out, too.
_FURTHER = 2
#: A step is so many of these at least, so that every reading belongs to one; and so many steps are in what was read.
_LEAST, _STEPS = 9.0, 12
#: Noise below this share of what was read is none, as of a simulation.
_FINEST = 1e-5
#: Rows in motion that are asked for, and the mean resultant length about the steps, in each half of them.
_ROWS, _CROWDED = 300, 0.6


def on_their_steps(
    recordings: Sequence[Recording], sigma: float, spoken: Spoken = HOUSE
) -> tuple[list[Recording], list[DataNote]]:
    """The recordings with every reading at the step about which it lies, if all of them crowd about steps.

    `sigma`: standard deviation of a reading at rest; `spoken`: the units of what is said. From there on they are
    readings of the gauge before the line.
    """
    step, place = blurred_step(recordings, sigma)
    if step <= 0.0:
        return list(recordings), []
    snapped = [replace(r, position=step * np.round((r.position - place) / step) + place) for r in recordings]
    unit = recordings[0].position_unit
    size, noise = spoken.text(step, unit, 4), spoken.text(sigma, unit, 2)
    what = f"readings lie about steps of {size}, with {noise} of noise that came after them"
    return snapped, [DataNote(what, "each was taken for the step it is about")]


def blurred_step(recordings: Sequence[Recording], sigma: float) -> tuple[float, float]:
    """The step about which the positions of all recordings crowd, in their unit, and the place of one; (0, 0) where
    they do not."""
    moving = _near_the_most(np.concatenate([_in_motion(r, sigma) for r in recordings]))
    span = float(np.ptp(moving)) if moving.size >= _ROWS else 0.0
    if sigma <= 0.0 or span < _STEPS * _LEAST * sigma:
        return 0.0, 0.0
    sigma = max(sigma, _FINEST * span)
    bins = int(np.ceil(4.0 * span / sigma))
    counts = np.histogram(moving, bins, (moving.min(), moving.max() + 1e-12 * span))[0]
    per_span = np.arange(4 * bins // 2 + 1) / 4.0  # steps in the span, for a transform padded to four times its length
    length = np.abs(np.fft.rfft(counts, 4 * bins))
    length[(per_span < _STEPS) | (per_span > span / (_LEAST * sigma))] = 0.0
    step = _refined(moving, span / max(float(per_span[int(np.argmax(length))]), 1.0), span)
    if min(abs(resultant(half, step)) for half in np.array_split(moving, 2)) <= _CROWDED:
        return 0.0, 0.0
    return step, step * float(np.angle(resultant(moving, step))) / (2.0 * np.pi)


def _near_the_most(values: FloatArray) -> FloatArray:
    """The values without those that no stem was at: a code for "no value" is a step of its own to all others."""
    if not values.size:
        return values
    low, high = np.percentile(values, (5.0, 95.0))
    near: FloatArray = values[(values > low - (high - low)) & (values < high + (high - low))]
    return near


def resultant(values: FloatArray, step: float) -> complex:
    """Whose length is how much the values crowd about places `step` apart (1: on them, 0: anywhere), and its angle
    where these are."""
    return complex(np.mean(np.exp(2j * np.pi * values / step)))


def _refined(values: FloatArray, step: float, span: float) -> float:
    """The step near `step` about which the values crowd most."""
    near = 1.0 / (1.0 / step + np.linspace(-0.25, 0.25, 51) / span)
    return float(near[int(np.argmax([abs(resultant(values, one)) for one in near]))])


def _in_motion(recording: Recording, sigma: float) -> FloatArray:
    """The readings of a stem that moves, without those that repeat the one before.

    It has moved as seen from one row further out and from two, too: one false reading beside a stem at rest is no way.
    """
    y = recording.position
    side = max(1, round(_WITHIN_S / recording.period_s))
    edge = side + _FURTHER
    if y.size <= 2 * edge:
        return np.empty(0)
    rows = np.arange(edge, y.size - edge)
    ways = np.stack([y[rows + k] - y[rows - k] for k in range(side, edge + 1)])
    moves = (np.abs(ways) > _MOVES * sigma).all(axis=0)  # NaN compares false
    here = y[rows]
    fresh: FloatArray = here[moves & np.isfinite(here) & (here != y[rows - 1])]
    return fresh
