"""What is known of a diagnosis that was interrupted: the quality of the data, the noise, the gap of the design and
where it lies; how well each cause alone would do, if that had been tried; and the verdict, if it had been reached.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from hal.errors import BadInput
from logs.recording import DataNote, Recording
from twin.choose.stages import driven_about
from twin.choose.weigh import Weights
from twin.diagnosis import Diagnosis, Gap, Ranked
from twin.fit.case import Case, make_case
from twin.fit.channel import predict_reading
from twin.fit.fitting import Fit
from twin.judge.verdict import Judgement
from twin.judge.whereabouts import whereabouts
from twin.model.plant import Plant
from twin.noise.copies import used_once
from twin.noise.model import NoiseModel, estimate_noise
from twin.ready.timing import Slack
from twin.record.admit import admit
from twin.search.score import make_yardstick
from twin.search.search import Searcher
from twin.where.closure import gap
from twin.where.isolability import describe

Progress = Callable[[str, float], None]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a diagnosis; `diagnosis` is what was known by then."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        super().__init__(diagnosis.statement)
        self.diagnosis = diagnosis


@dataclass(slots=True)
class Known:
    """What a diagnosis has found out so far, and what its progress was told last.

    `margin_share`: the largest share of the margin in a channel's variance. `searches`: those that were begun. `slack`:
    what the timing of the commands leaves open.
    """

    recordings: tuple[Recording, ...]
    plant: Plant
    notes: list[DataNote] = field(default_factory=list)
    noise: NoiseModel | None = None
    case: Case | None = None
    margin_share: float = 0.0
    searches: list[Searcher] = field(default_factory=list)
    judgement: Judgement | None = None
    slack: Slack = field(default_factory=Slack)
    what: str = "the start"
    share: float = 0.0

    def told(self, progress: Progress) -> Progress:
        """`progress`, remembered on the way."""

        def tell(what: str, share: float) -> None:
            self.what, self.share = what, share
            progress(what, share)

        return tell

    def take(self, other: Known) -> None:
        """Goes on with what a further search was made on."""
        self.recordings, self.notes, self.noise, self.slack = other.recordings, other.notes, other.noise, other.slack
        self.case, self.margin_share, self.searches = other.case, other.margin_share, other.searches

    @property
    def stage(self) -> str:
        """Where the diagnosis is, in words."""
        return f"{self.what} ({100.0 * self.share:.0f} %)"


def known_so_far(known: Known, weights: Weights) -> Diagnosis | None:
    """The part of the diagnosis that is sure; None where the records cannot carry one.

    Without a judgement the verdict is "unexplained": no cause had been decided on. The ranking is provisional then.
    """
    try:
        case = known.case or _plain_case(known)
    except BadInput:
        return None
    numbers = _gap(case)
    diagnosis = Diagnosis(
        verdict="unexplained",
        statement="",
        causes=(),
        ranking=_provisional(known.searches, weights),
        gap=numbers,
        where=whereabouts(case, driven_about(case.base, case)),
        data_quality=(*case.notes, *known.notes, _cut_short(known)),
        residual_signature={"interrupted_at": known.stage},
        structure=tuple(describe(case.signals)),
        spoken=case.scales.spoken,
        incomplete=f"interrupted at {known.stage}",
    )
    judgement = known.judgement
    if judgement is not None:
        diagnosis = replace(
            diagnosis,
            verdict=judgement.verdict,
            causes=known.slack.loosened(judgement.causes),
            ranking=judgement.ranking,
            confusable=judgement.confusable,
        )
    return replace(diagnosis, statement=_statement(known, numbers))


def _cut_short(known: Known) -> DataNote:
    """What the verdict of an interrupted diagnosis is worth, for whoever reads no statement."""
    undecided = "the verdict stands for no answer, and the ranking for the causes alone, as far as they were tried"
    unchecked = "its verdict is not checked on held-out data, and the updated model is the design as given"
    return DataNote(f"the diagnosis was interrupted at {known.stage}", unchecked if known.judgement else undecided)


def _plain_case(known: Known) -> Case:
    """The case before anything was found out about timing or false readings. Raises: `BadInput` as `admit`."""
    known.recordings = tuple(used_once(known.recordings)[0])
    noise = known.noise or estimate_noise(known.recordings)
    admit(known.recordings, known.plant, noise)
    return make_case(known.recordings, known.plant.design, known.plant.inserted, noise=noise)


def _gap(case: Case) -> Gap:
    """The gap of the design; nothing was fitted, so every row is unseen."""
    rows = [np.where(t.use_y, t.recording.position - predict_reading(case.base, t), np.nan) for t in case.trials]
    error = np.concatenate(rows)
    nothing = np.full(error.size, np.nan)
    memory = case.noise.position.correlation_samples
    return gap(error, nothing, nothing, case.sigma_y, case.travel, memory)


def _provisional(searches: list[Searcher], weights: Weights) -> tuple[Ranked, ...]:
    """The causes that were tried alone, with their odds against each other; not what a finished search would say."""
    lines: list[Ranked] = []
    for search in searches:
        best: dict[str, Fit] = {}
        for one in sorted(search.tried, key=lambda f: -f.mse):
            best[one.names[0]] = one
        if not best:
            continue
        yardstick = make_yardstick(min(best.values(), key=lambda f: f.mse).residuals, search.channel.use)
        scores = np.array([yardstick.score(one) for one in best.values()])
        odds = np.exp((scores - scores.max()) / weights.temperature)
        chances = np.minimum(odds / odds.sum(), weights.ceiling)
        lines += [Ranked(name, float(p), None) for name, p in zip(best, chances, strict=True)]
    return tuple(sorted(lines, key=lambda line: -line.probability))


def _statement(known: Known, numbers: Gap) -> str:
    judgement = known.judgement
    if judgement is None:
        return (
            f"Interrupted at {known.stage}, before a cause was decided on: the design is off by {numbers.before:.2g} % "
            f"of travel, and the readings' own noise is {numbers.noise_floor:.2g} %."
        )
    names = " and ".join(c.name for c in judgement.causes)
    said = judgement.verdict.replace("_", " ") + (f": {names}" if names else "")
    return (
        f"Interrupted at {known.stage}, after the verdict ({said}) and before all of it was checked on held-out data: "
        f"the design is off by {numbers.before:.2g} % of travel (noise {numbers.noise_floor:.2g} %)."
    )
