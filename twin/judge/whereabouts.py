"""Where the gap lies: the signals' own split over the chain, and the split that the named causes imply."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np

from twin.choose.stages import StageResult, combined
from twin.diagnosis import Share, Where
from twin.fit.case import Case
from twin.fit.channel import predict_reading, predict_reading_given_pressure, pressure_fine
from twin.fit.fitting import Fit
from twin.fit.numbers import NUMBERS, nominal, retuned
from twin.fit.trial import Trial
from twin.model.plant import Plant
from twin.where.map import WherePiece, where_map
from twin.where.telescope import shares_of

_STAGES = ("ep", "actuator", "sensor")


def whereabouts(case: Case, trials: Sequence[Trial]) -> Where:
    """The where-map of the design's error as the signals of `trials` alone have it; `attributed` stays open."""
    pieces = []
    for trial in trials:
        driven = trial.pressure is not None
        pressure = trial.pressure if trial.pressure is not None else pressure_fine(case.base, trial)
        pieces.append(
            WherePiece(
                time_s=trial.recording.time_s,
                reading=np.nan_to_num(trial.recording.position),
                full=predict_reading(case.base, trial),
                pressure=pressure[trial.grid.offsets],
                from_pressure=predict_reading_given_pressure(case.base, trial) if driven else None,
                use=trial.use_y,
            )
        )
    return where_map(pieces, case.noise.position, case.travel)


def attributed(case: Case, result: StageResult, named: Collection[str]) -> dict[str, Share] | None:
    """Shares of the explained error per stage, with the causes that the final verdict has `named`; None without any.

    Causes are inserted along the chain, and each stage gets what it changed. A stage without a named cause gets
    nothing: what re-tuning moved there in passing goes with the first stage that has one.
    """
    fits = [d.accepted for d in result.decisions if d.explained and not set(d.names).isdisjoint(named)]
    if not fits:
        return None
    guilty = [stage for stage in _STAGES if any(c.stage == stage for f in fits for c in f.space.causes)]
    plants = [case.base, *(_up_to(case, fits, guilty, last) for last in _STAGES)]
    steps = [np.concatenate([predict_reading(p, t) for t in case.trials]) for p in plants]
    use = np.concatenate([t.use_y for t in case.trials])
    parts = np.stack([(b - a)[use] for a, b in pairwise(steps)], axis=1)
    explained = parts.sum(axis=1)
    return shares_of(parts * explained[:, None], list(_STAGES), 0.0)


def _up_to(case: Case, fits: Sequence[Fit], guilty: Sequence[str], last: str) -> Plant:
    """The plant with the causes, and the numbers that go with them, of the stages up to `last` only."""
    kept = [stage for stage in guilty if _STAGES.index(stage) <= _STAGES.index(last)]
    whole = combined(case.base, fits)
    stage_of = {c.name: c.stage for f in fits for c in f.space.causes}
    inserted = [i for i in whole.inserted if i.effect in stage_of and stage_of[i.effect] in kept]
    owner = {n: NUMBERS[n] if NUMBERS[n] in guilty else guilty[0] for f in fits for n in f.space.numbers}
    moved = {n: nominal(whole.design, n) for n, stage in owner.items() if stage in kept}
    return Plant(retuned(case.base.design, moved), case.base.inserted).having(inserted)
