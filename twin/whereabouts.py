"""Where the gap lies: the signals' own split over the chain, and the split that the named causes imply."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from control.design import DesignModel
from twin.case import Case
from twin.diagnosis import Share, Where
from twin.fit.channel import predict_reading, predict_reading_given_pressure, pressure_fine
from twin.fit.fitting import Fit
from twin.plant import Plant
from twin.stages import StageResult, combined
from twin.where.map import WherePiece, where_map
from twin.where.telescope import shares_of

_STAGES = ("ep", "actuator", "sensor")


def whereabouts(case: Case, result: StageResult, seed: int) -> Where:
    """The where-map of the design's error, with `attributed` where causes are named."""
    pieces = []
    for trial in result.trials:
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
    where = where_map(pieces, case.noise.position, case.travel, seed)
    return replace(where, attributed=_attributed(case, result, seed))


def _attributed(case: Case, result: StageResult, seed: int) -> dict[str, Share] | None:
    """Shares of the explained error per stage: causes are inserted along the chain, each stage gets what it changed."""
    fits = [d.accepted for d in result.decisions if d.explained]
    if not fits:
        return None
    plants = [_up_to(case, fits, stage) for stage in (None, *_STAGES)]
    steps = [np.concatenate([predict_reading(p, t) for t in case.trials]) for p in plants]
    use = np.concatenate([t.use_y for t in case.trials])
    parts = np.stack([(b - a)[use] for a, b in pairwise(steps)], axis=1)
    explained = parts.sum(axis=1)
    return shares_of(parts * explained[:, None], list(_STAGES), 0.0, seed=seed)


def _up_to(case: Case, fits: list[Fit], last: str | None) -> Plant:
    """The plant with the causes of the stages up to `last` only."""
    if last is None:
        return case.base
    kept = _STAGES[: _STAGES.index(last) + 1]
    whole = combined(case.base, fits)
    stage_of = {c.name: c.stage for f in fits for c in f.space.causes}
    inserted = [i for i in whole.inserted if i.effect in stage_of and stage_of[i.effect] in kept]
    numbers = {n for f in fits for n in f.space.numbers}
    design = whole.design if "actuator" in kept else _with_ep_only(case, whole, "ep_tau" in numbers)
    return Plant(design, case.base.inserted).having(inserted)


def _with_ep_only(case: Case, whole: Plant, retuned_ep: bool) -> DesignModel:
    design = case.base.design
    return replace(design, ep_tau_s=whole.design.ep_tau_s) if retuned_ep else design
