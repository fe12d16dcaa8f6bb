"""The gap where whole conditions are held out: each recording predicted by a model fitted to those commanded otherwise.

Blocks of time, as in `twin/judge/heldout.py`, let every fit see all kinds of excitation; this asks whether the causes
carry over to commands that no fit has met. Recordings with the same commands are one condition. What was judged on a
look at large records is fitted to that look, and predicts all rows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import Recording
from twin.choose.stages import StageResult
from twin.diagnosis import Gap
from twin.fit.channel import chain_channel
from twin.fit.fitting import Fit
from twin.judge.heldout import FOLDS, predict_folds
from twin.noise.repeats import find_repeats
from twin.where.closure import floor_doubt, gap


def gap_by_condition(result: StageResult, retuned: Fit, floor: float) -> Gap | None:
    """The gap before, re-tuned and with what `result` accepted; None for a single condition.

    `retuned` was fitted to the case of the `result`; `floor` is the noise of the position, in its unit.
    """
    case, whole = result.case, result.case.everything
    fold_of = _condition_folds(whole.recordings)
    if fold_of is None:
        return None
    looked_at = [span.record for span in case.spans] or range(len(case.trials))
    fitted = np.concatenate([np.full(t.recording.n, fold_of[k]) for t, k in zip(case.trials, looked_at, strict=True)])
    folds = np.concatenate([np.full(r.n, k) for r, k in zip(whole.recordings, fold_of, strict=True)])
    weights = [(fitted != k).astype(np.float64) for k in range(FOLDS)]
    named = [d for d in result.decisions if d.explained]
    chain = chain_channel(case.trials, case.sigma_y)
    fits, channels = [d.accepted for d in named], [d.findings.channel for d in named]
    before = predict_folds(case, case.base, [], [], weights, folds)
    again = predict_folds(case, case.base, [retuned], [chain], weights, folds)
    after = predict_folds(case, case.base, fits, channels, weights, folds)
    noise = whole.noise.position
    return gap(before, again, after, floor, case.travel, noise.correlation_samples, floor_doubt(noise))


def _condition_folds(recordings: Sequence[Recording]) -> list[int] | None:
    """The fold that predicts each recording, the same for repeats; None where there is one condition only."""
    at = {id(r): k for k, r in enumerate(recordings)}
    like = list(range(len(recordings)))
    for pair in find_repeats(recordings, most=None):
        first, second = sorted((like[at[id(pair.first)]], like[at[id(pair.second)]]))
        like = [first if k == second else k for k in like]
    conditions = {k: n for n, k in enumerate(dict.fromkeys(like))}
    return [conditions[k] % FOLDS for k in like] if len(conditions) > 1 else None
