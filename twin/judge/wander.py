"""A pressure that wanders by itself: small, like nothing in the vocabulary, and never given the chance to repeat.

A regulator's output drifts by some thousandths of its span, slower than the noise of its reading. Repeats show what of
it belongs to the commands; where nothing was repeated, so little may be either, and counts as noise of the whole chain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from logs.recording import DataNote, FloatArray
from twin.choose.stages import StageResult
from twin.fit.case import Case
from twin.fit.channel import predict_reading, predict_reading_given_pressure
from twin.fit.trial import Trial
from twin.judge.repeatable import MATERIAL, Disturbance, disturbance, repeated_share
from twin.judge.swing import Swing, swing_in, swing_note
from twin.where.closure import rms

#: Of the reading's noise; what wanders by less changes nothing.
_SLIGHT = 0.5
#: What wanders does so all the time. An error is an event if the loudest twentieth of its seconds holds so much of it:
#: noise has 0.5 there, what wandered on four benches 0.3 to 0.5, and 0.94 and more what came and went on five.
_LOUDEST, _EVENTS = 0.05, 0.75


@dataclass(frozen=True, slots=True)
class Unrest:
    """What the bench does by itself: a signal that does not repeat, a swing, a pressure that wanders (see `wander`)."""

    loud: Disturbance | None
    swing: Swing | None
    astray: float | None

    @property
    def disturbed(self) -> bool:
        """Whether there is a gap, whatever causes it."""
        return self.loud is not None or self.swing is not None

    def heard(self, case: Case) -> Case:
        """The case with the wandering in its noise."""
        return replace(case, sigma_y=hypot(case.sigma_y, self.astray or 0.0))

    def notes(self, case: Case) -> list[DataNote]:
        """What to say of it."""
        notes = [_note(self.astray, case)] if self.astray is not None else []
        if self.swing is None:
            return notes
        units = {"position": case.scales.position_unit, "pressure": case.scales.pressure_unit}
        return [swing_note(self.swing, units[self.swing.signal], case.scales.spoken), *notes]


def unrest(case: Case, result: StageResult, margin_position: float) -> Unrest:
    """Looks at the noise, at the design's error and at what the converter's candidates left."""
    loud, swing = disturbance(case, result.trials, margin_position), swing_in(result)
    return Unrest(loud, swing, None if loud is not None or swing is not None else wander(case, result, margin_position))


def wander(case: Case, result: StageResult, margin_position: float = 0.0) -> float | None:
    """What the unexplained error of the converter does to the stem: RMS [position], None where it is a gap or nothing.

    It is a gap where commands were repeated (then it is known whether it comes back), where it comes and goes, and
    where it matters.
    """
    first = result.decisions[0]
    if first.findings.channel.name != "pressure" or first.explained:
        return None
    if repeated_share(first.findings.none.residuals, first.findings.channel.trials) is not None:
        return None
    if comes_and_goes(first.findings.none.residuals, first.findings.channel.trials):
        return None
    driven = [t for t in result.trials if t.pressure is not None]
    moved = [predict_reading_given_pressure(case.base, t) - predict_reading(case.base, t) for t in driven]
    size = rms(np.concatenate([m[t.use_y] for m, t in zip(moved, driven, strict=True)]))
    return size if _SLIGHT * case.sigma_y < size < MATERIAL * case.travel + 2.0 * margin_position else None


def comes_and_goes(residuals: FloatArray, trials: Sequence[Trial]) -> bool:
    """Whether most of an error (n,), in units of its noise, lies in a few of its seconds."""
    excess, at = [np.zeros(1)], 0
    for trial in trials:
        rows = max(1, round(1.0 / trial.recording.period_s))
        count = trial.recording.n // rows
        seconds = residuals[at : at + count * rows].reshape(count, rows)
        excess.append(np.maximum(rows * np.square(seconds.mean(axis=1)) - 1.0, 0.0))
        at += trial.recording.n
    loudest = np.sort(np.concatenate(excess))[::-1]
    return float(loudest[: round(_LOUDEST * loudest.size)].sum()) > _EVENTS * float(loudest.sum())


def _note(size: float, case: Case) -> DataNote:
    design = case.base.design
    pressure = design.spoken.text(size / design.compliance, design.pressure_unit, 2)
    return DataNote(
        what=f"the pressure is off by about {pressure} in a way that no cause explains, and no command was repeated",
        handled="taken as the converter's own wandering and counted as noise; a repeat of the commands would tell",
        rows=0,
        first_row=None,
    )
