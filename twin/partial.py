"""What is known of a diagnosis that was interrupted: the quality of the data, the noise, the gap of the design and
where it lies; and the verdict, if it had been reached. Causes that were only being tried are not named.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from logs.recording import DataNote
from twin.case import Case
from twin.closure import gap
from twin.diagnosis import Diagnosis
from twin.fit.channel import predict_reading
from twin.fit.smooth import smoothed_pressure
from twin.stages import StageResult
from twin.verdict import Judgement
from twin.where.isolability import describe
from twin.whereabouts import whereabouts

Progress = Callable[[str, float], None]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a diagnosis; `diagnosis` is what was known by then."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        super().__init__(diagnosis.statement)
        self.diagnosis = diagnosis


@dataclass(slots=True)
class Stage:
    """Where a diagnosis is: what its progress was told last."""

    what: str = "the start"
    share: float = 0.0

    def told(self, progress: Progress) -> Progress:
        """`progress`, remembered on the way."""

        def tell(what: str, share: float) -> None:
            self.what, self.share = what, share
            progress(what, share)

        return tell

    def __str__(self) -> str:
        return f"{self.what} ({100.0 * self.share:.0f} %)"


def known_so_far(
    case: Case, notes: Sequence[DataNote], stage: Stage, seed: int, judgement: Judgement | None = None
) -> Diagnosis:
    """The part of the diagnosis that is sure: nothing that was fitted only half is in it.

    Without a `judgement` the verdict is "unexplained": no cause had been decided on.
    """
    trials = case.trials
    if case.sigma_p is not None:
        memory = case.noise.pressure.correlation_samples if case.noise.pressure else 1.0
        plain = [smoothed_pressure(case.base, t, case.sigma_p, memory) for t in trials]
        trials = tuple(t.with_pressure(p) for t, p in zip(trials, plain, strict=True))
    error = np.concatenate([np.where(t.use_y, t.recording.position - predict_reading(case.base, t), np.nan)
                            for t in case.trials])  # fmt: skip
    nothing = np.full(error.size, np.nan)
    numbers = gap(error, nothing, nothing, case.sigma_y, case.travel, case.noise.position.correlation_samples, seed)
    signals = frozenset({"pressure"} if case.sigma_p is not None else set())
    diagnosis = Diagnosis(
        verdict="unexplained",
        statement=f"Interrupted at {stage}, before a cause was decided on: the design is off by {numbers.before:.2g} % "
        f"of travel, and the readings' own noise is {numbers.noise_floor:.2g} %.",
        causes=(),
        ranking=(),
        gap=replace(numbers, reducible_closed=None),
        where=whereabouts(case, StageResult(case, (), trials), seed),
        data_quality=tuple(n for r in case.recordings for n in r.notes) + tuple(notes),
        residual_signature={"interrupted_at": str(stage)},
        structure=tuple(describe(signals)),
    )
    if judgement is None:
        return diagnosis
    names = " and ".join(c.name for c in judgement.causes)
    said = judgement.verdict.replace("_", " ") + (f": {names}" if names else "")
    return replace(
        diagnosis,
        verdict=judgement.verdict,
        causes=judgement.causes,
        ranking=judgement.ranking,
        confusable=judgement.confusable,
        statement=f"Interrupted at {stage}, after the verdict ({said}) and before the gap was measured on held-out "
        f"data: the design is off by {numbers.before:.2g} % of travel (noise {numbers.noise_floor:.2g} %).",
    )
