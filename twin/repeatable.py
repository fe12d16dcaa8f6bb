"""What of an error came back when the same commands were given again, and noise that is too loud to be called noise.

A gap of a model is the part of its error that repeats. An error that was there once is a disturbance: no candidate can
be blamed for it, and a floor measured between repeats holds it; but when it is far louder than the resting reading it
is named as what it is. Source: pure error against lack of fit, Draper, Smith, Applied Regression Analysis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray
from twin.case import Case
from twin.fit.trial import Trial
from twin.noise.model import LOUD
from twin.noise.repeats import find_repeats

#: Repeats are too different when they differ by many times the resting reading's noise (`LOUD`), and by this share of
#: travel, or by the pressure that moves the stem so far.
MATERIAL = 0.006


def repeated_share(residuals: FloatArray, trials: Sequence[Trial]) -> float | None:
    """Share of the squared residuals that the repeats have in common, about 0 for noise and 1 for a model's error.

    `residuals`: shape (sum of rows,), 0 in rows that do not count. None where no command was given twice.
    """
    at = np.cumsum([0, *(t.recording.n for t in trials)])
    parts = {id(t.recording): residuals[a:b] for t, a, b in zip(trials, at[:-1], at[1:], strict=True)}
    common = whole = 0.0
    for pair in find_repeats([t.recording for t in trials]):
        first, second = parts[id(pair.first)][pair.rows], parts[id(pair.second)]
        there = pair.first.time_s[pair.rows] + pair.shift_s
        row = np.clip(np.searchsorted(pair.second.time_s, there - 1e-9), 0, pair.second.n - 1)
        common += float(first @ second[row])
        whole += 0.5 * float(first @ first + second[row] @ second[row])
    return common / whole if whole > 0.0 else None


@dataclass(frozen=True, slots=True)
class Disturbance:
    """A signal whose repeats differ by `repeats`, though at rest its noise is `resting` only [`unit`]."""

    signal: str
    repeats: float
    resting: float
    unit: str


def disturbance(case: Case, margin_position: float = 0.0) -> Disturbance | None:
    """The loudest signal that does not repeat, if there is one that matters for the stem; None without repeats."""
    design = case.base.design
    slack = MATERIAL * design.travel + 2.0 * margin_position
    signals = (
        ("position", case.noise.position, 1.0, design.position_unit),
        ("pressure", case.noise.pressure, design.compliance, design.pressure_unit),
    )
    for name, noise, gain, unit in signals:
        if noise is None or noise.source == "repeats":
            continue
        between = noise.by_source.get("repeats", 0.0)
        if between > LOUD * noise.sigma and between * gain > slack:
            return Disturbance(name, between, noise.sigma, unit)
    return None
