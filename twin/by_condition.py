"""The gap where whole conditions are held out: each recording predicted by a model fitted to those commanded otherwise.

Blocks of time, as in `twin/heldout.py`, let every fit see all kinds of excitation; this asks whether the causes carry
over to commands that no fit has met. Recordings with the same commands are one condition.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from twin.case import Case
from twin.closure import gap
from twin.diagnosis import Gap
from twin.fit.channel import chain_channel
from twin.fit.fitting import Fit
from twin.heldout import predict_folds
from twin.noise.repeats import find_repeats
from twin.stages import StageResult


def gap_by_condition(case: Case, result: StageResult, retuned: Fit, floor: float, seed: int) -> Gap | None:
    """The gap before, re-tuned and with what `result` accepted; None for a single condition, or a thinned look."""
    fold_of = _condition_folds(case)
    if case.everything is not case or fold_of is None:
        return None
    folds = np.concatenate([np.full(t.recording.n, k) for t, k in zip(case.trials, fold_of, strict=True)])
    weights = [(folds != k).astype(np.float64) for k in range(2)]
    named = [d for d in result.decisions if d.explained]
    chain = chain_channel(case.trials, case.sigma_y)
    fits, channels = [d.accepted for d in named], [d.findings.channel for d in named]
    before = predict_folds(case, case.base, [], [], weights, folds)
    again = predict_folds(case, case.base, [retuned], [chain], weights, folds)
    after = predict_folds(case, case.base, fits, channels, weights, folds)
    return gap(before, again, after, floor, case.travel, case.noise.position.correlation_samples, seed)


def _condition_folds(case: Case) -> npt.NDArray[np.int64] | None:
    """0 or 1 per recording, the same for repeats; None where there is one condition only."""
    at = {id(t.recording): k for k, t in enumerate(case.trials)}
    like = list(range(len(case.trials)))
    for pair in find_repeats([t.recording for t in case.trials]):
        first, second = sorted((like[at[id(pair.first)]], like[at[id(pair.second)]]))
        like = [first if k == second else k for k in like]
    conditions = {k: n for n, k in enumerate(dict.fromkeys(like))}
    if len(conditions) < 2:
        return None
    return np.array([conditions[k] % 2 for k in like], dtype=np.int64)
