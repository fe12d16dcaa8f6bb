"""What of an error came back when the same commands were given again, and noise that is too loud to be called noise.

A gap of a model is the part of its error that repeats. An error that was there once is a disturbance: no candidate can
be blamed for it, and a floor measured between repeats holds it; but when it is far louder than the resting reading it
is named as what it is. Source: pure error against lack of fit, Draper, Smith, Applied Regression Analysis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from logs.recording import FloatArray, Recording
from twin.choose.decide import Decision
from twin.fit.case import Case
from twin.fit.channel import predict_reading_given_pressure
from twin.fit.trial import Trial
from twin.noise.lattice import lattice_step
from twin.noise.model import LOUD, SignalNoise
from twin.noise.repeats import find_repeats
from twin.noise.robust import robust_sigma
from twin.replay.simulate import simulate_recording

#: Repeats are too different when they differ by many times the resting reading's noise (`LOUD`), and by this share of
#: travel, or by the pressure that moves the stem so far. Where the pressure is measured, what it does not account for
#: need not be so loud: healthy machines differ by up to 1.35 times their noise at rest.
MATERIAL = 0.006
UNLIKE, MATERIAL_GIVEN_PRESSURE = 1.5, 0.0015
#: Of the variance by which repeats differ: causes that leave less explain why, if the resting reading has less, too.
#: Of the noise of the resting reading: what may be left then.
EXPLAINED, AT_REST = 0.5, 1.5


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


def differ_for_a_cause(decision: Decision, noise: SignalNoise) -> bool:
    """Whether what was accepted for the position, or a drift, explains by what repeats differ: that is no noise then.

    What drifts from one repeat to the next makes them differ; measured by that difference, the noise hides any smaller
    cause, and may be so loud that the drift itself is not accepted.
    """
    if noise.source != "repeats" or noise.resting is None or noise.resting**2 >= EXPLAINED * noise.sigma**2:
        return False
    explaining = [f for f in decision.findings.fits if any(c.effect and c.effect.drifts for c in f.space.causes)]
    explaining += [decision.accepted] if decision.names else []
    return any(f.mse < EXPLAINED for f in explaining)


def leaves_what_rests(decision: Decision) -> bool:
    """Whether what was accepted leaves about the noise, when that is the resting reading's."""
    return bool(decision.names) and decision.accepted.mse <= AT_REST * decision.floor


@dataclass(frozen=True, slots=True)
class Disturbance:
    """A signal whose repeats differ by `repeats`, though at rest its noise is `resting` only [`unit`]."""

    signal: str
    repeats: float
    resting: float
    unit: str


def disturbance(case: Case, trials: Sequence[Trial] = (), margin_position: float = 0.0) -> Disturbance | None:
    """The loudest signal that does not repeat, if there is one that matters for the stem; None without repeats.

    `trials`: the recordings with their measured pressure, where there is one; `margin_position`: see `Margin`.
    """
    design = case.base.design
    slack = MATERIAL * design.travel + 2.0 * margin_position
    signals = (
        ("position", case.noise.position, 1.0, design.position_unit),
        ("pressure", case.noise.pressure, design.compliance, design.pressure_unit),
    )
    errors: list[Recording] = []
    for name, noise, gain, unit in signals:
        if noise is None or noise.source == "repeats":
            continue
        loud = max(LOUD * noise.sigma, slack / gain)
        between = noise.by_source.get("repeats", 0.0)
        if between > loud and _between(errors := errors or _errors(case), name) > loud:
            return Disturbance(name, between, noise.sigma, unit)
    return _given_the_pressure(case, trials)


def _errors(case: Case) -> list[Recording]:
    """The recordings less what the design makes of their commands: a play keeps how repeats begin differently."""
    errors = []
    for recording in case.recordings:
        pressure, position = simulate_recording(case.base, recording)
        driven = None if recording.pressure is None else recording.pressure - pressure
        errors.append(replace(recording, pressure=driven, position=recording.position - position))
    return errors


def _between(recordings: Sequence[Recording], name: str) -> float:
    """The noise of a signal by what its repeats differ by; 0 without any."""
    pieces = [piece for pair in find_repeats(recordings) if (piece := pair.difference(name)) is not None]
    return robust_sigma(np.concatenate(pieces)) if pieces else 0.0


def _given_the_pressure(case: Case, trials: Sequence[Trial]) -> Disturbance | None:
    """The same for the position, less what the design makes of the pressure that was measured each time."""
    noise, design = case.noise.position, case.base.design
    resting = _at_rest(case)
    driven = [t for t in trials if t.pressure is not None]
    if resting is None or len(driven) < len(trials) or noise.by_source.get("repeats", 0.0) <= UNLIKE * resting:
        return None
    errors = [
        replace(t.recording, position=t.recording.position - predict_reading_given_pressure(case.base, t))
        for t in driven
    ]
    between = _between(errors, "position")
    if between <= max(UNLIKE * resting, MATERIAL_GIVEN_PRESSURE * design.travel):
        return None
    return Disturbance("position", between, resting, design.position_unit)


def _at_rest(case: Case) -> float | None:
    """The position's noise at rest; a coarse reading that rests on one step errs by its rounding all the same."""
    step = lattice_step(np.concatenate([r.position for r in case.recordings])) or 0.0
    resting = case.noise.position.resting
    return float(np.hypot(resting, step / np.sqrt(12.0))) if resting else None
