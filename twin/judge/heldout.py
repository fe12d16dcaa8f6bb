"""The gap on held-out data: blocks of the record take turns in being left out of the fit that predicts them.

Blocks are long against the valve's lags and alternate, so that both halves see all conditions of the excitation. Each
fit begins where that of the whole record ended and is tied to it: loosely, so that what its rows say outweighs the tie,
but firmly where a cause, or what the design has, is erratic, which leaves the prediction less blind and is said in the
answer. Everything is predicted from the command alone: the whole chain.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import numpy.typing as npt

from logs.recording import DataNote, FloatArray
from twin.choose.stages import combined
from twin.fit.case import Case
from twin.fit.channel import Channel, chain_channel
from twin.fit.fitting import Fit, fit
from twin.fit.trial import Trial
from twin.model.catalog import effects
from twin.model.plant import Plant

FOLDS = 2
_THREADS = 2
BLOCKS = 16
_LONG_S = 20.0
#: What the rows of a fold say nothing about stays within so many standard deviations of where the whole record put it.
_LOOSE = 20.0
#: The same where a cause, or what the design has, is erratic. A slip that comes one row earlier is a jump in the
#: squares: half of the rows would buy the time of one of theirs with the times of many others.
_FIRM = 0.3


def fold_weights(trials: Sequence[Trial]) -> list[npt.NDArray[np.float64]]:
    """For each fold the weight of every row in its fit: 0 in the blocks that the fold predicts."""
    fold_of = _folds(trials)
    return [(fold_of != fold).astype(np.float64) for fold in range(FOLDS)]


def _folds(trials: Sequence[Trial]) -> npt.NDArray[np.int64]:
    """The fold of every row of the trials."""
    return np.concatenate([_fold_of_rows(t.recording.time_s, t.led_s) for t in trials])


def _folds_of_everything(case: Case) -> npt.NDArray[np.int64]:
    """The fold that predicts each row of the whole: rows among those that a look was fitted to share their fold."""
    whole = case.everything
    if whole is case:
        return _folds(case.trials)
    folds = [_fold_of_rows(t.recording.time_s) for t in whole.trials]
    for span in case.spans:
        rows = slice(span.start, span.stop)
        folds[span.record][rows] = _fold_of_rows(whole.trials[span.record].recording.time_s[rows])
    return np.concatenate(folds)


def _fold_of_rows(time_s: FloatArray, led_s: float = 0.0) -> npt.NDArray[np.int64]:
    """What only leads to the rest, for `led_s`, is in the same fold as its beginning."""
    first_s = time_s[0] + led_s
    duration = time_s[-1] - first_s
    length = max(duration / BLOCKS, min(_LONG_S, duration / FOLDS))
    block = np.clip((time_s - first_s) // max(length, 1e-9), 0.0, 1e9).astype(np.int64)
    return np.asarray(block % FOLDS, dtype=np.int64)


def refitted(fits: Sequence[Fit], channels: Sequence[Channel], weights: FloatArray, rounds: int = 5) -> list[Fit]:
    """The same hypotheses fitted again, from where they ended, on the rows with weight only.

    A supply that is met in a single block cannot be learned from the others; that is no evidence against it. So every
    unknown is tied to where it ended, but so loosely that whatever these rows do say about it outweighs the tie; not so
    where a cause, or what the design has, is erratic (see `_FIRM`).
    """
    return [
        fit(channel, one.space, [one.z], rounds=rounds, weights=weights, anchor=_tie(one))
        for one, channel in zip(fits, channels, strict=True)
    ]


def _tie(one: Fit) -> tuple[FloatArray, FloatArray]:
    units = np.abs([u.unit for u in one.space.unknowns])
    deviations = one.deviations(max(one.mse, 1.0) ** 0.5) / units
    return one.z, np.maximum((_FIRM if _erratic(one.names, one.space.base) else _LOOSE) * deviations, 1e-6)


def _erratic(names: Sequence[str], base: Plant) -> list[str]:
    """What is erratic of these causes and of what the design has."""
    known = effects()
    there = dict.fromkeys([*names, *(one.effect for one in base.inserted)])
    return [name for name in there if name in known and known[name].erratic]


def tied_note(names: Sequence[str], base: Plant, driven: tuple[float, float] | None = None) -> list[DataNote]:
    """What to say of the held-out error, where one of the named causes is erratic, or an effect of the design.

    `driven`: the errors before and after given the measured pressure, in the unit of the reading, where they are known.
    """
    erratic = " and ".join(_erratic(names, base))
    if not erratic:
        return []
    handled = (
        f"for data held out, all numbers were tied to those of the whole record, by {_FIRM:g} of their standard "
        "deviations: the error on held-out data is less blind than with other causes"
    )
    if driven is not None:
        before, after = (100.0 * error / base.design.travel for error in driven)
        handled += f"; given the measured pressure it falls from {before:.2g} to {after:.2g} % of travel"
    return [DataNote(f"with {erratic}, one slip that comes early outweighs many rows", handled)]


def is_erratic(one: Fit) -> bool:
    """Whether one of its causes, or an effect of the design, is erratic."""
    return bool(_erratic(one.names, one.space.base))


def errors_on_channel(one: Fit, channel: Channel) -> FloatArray:
    """The channel's own residuals, in noises, on rows that the fit of their fold has not seen.

    Given what drives that channel: a slip that a prediction from the command makes a moment too early is right there.
    """
    error = np.full(channel.use.size, np.nan)
    for weights in fold_weights(channel.trials):
        held = (weights == 0.0) & channel.use
        error[held] = channel.residuals(refitted([one], [channel], weights)[0].plant)[held]
    return error


def predict_heldout(case: Case, base: Plant, fits: Sequence[Fit], channels: Sequence[Channel]) -> FloatArray:
    """Errors of the whole chain on rows that the fits of their fold have not seen; NaN where rows do not count."""
    return predict_folds(case, base, fits, channels, fold_weights(case.trials), _folds_of_everything(case))


def predict_folds(
    case: Case,
    base: Plant,
    fits: Sequence[Fit],
    channels: Sequence[Channel],
    weights: Sequence[FloatArray],
    folds: npt.NDArray[np.int64],
) -> FloatArray:
    """The same for folds of any kind: `weights[k]`, per row of the case, is 0 on what fold k predicts; `folds` says for
    each row of the whole which fold that is."""
    whole = case.everything
    chain = chain_channel(whole.trials, whole.sigma_y)
    error = np.full(chain.measured.size, np.nan)

    def predicted(fitted_on: FloatArray) -> FloatArray:
        return chain.prediction(combined(base, refitted(fits, channels, fitted_on)) if fits else base)

    with ThreadPoolExecutor(_THREADS) as pool:
        for fold, reading in enumerate(pool.map(predicted, weights)):
            held = (folds == fold) & chain.use
            error[held] = (chain.measured - reading)[held]
    return error
