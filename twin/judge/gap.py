"""The held-out gap of everything the diagnosis quotes: before, re-tuned, after, and without each cause."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray
from twin.choose.decide import Decision
from twin.choose.stages import StageResult
from twin.fit.case import Case
from twin.fit.channel import chain_channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import make_space
from twin.judge.heldout import errors_on_channel, is_erratic, predict_heldout
from twin.judge.verdict import Judgement
from twin.record.sensing import Sensing
from twin.search.reform import lays_open
from twin.where.closure import rms

Progress = Callable[[str, float], None]

#: Candidates of the ranking whose own held-out gap is worth computing.
_RANKED = 6
#: Of the error after; a cause without which the error is smaller than that is not needed.
IDLE = 1.03
#: Of the noise; beside another cause, one without which unseen data are missed by less is not named.
BESIDE = 1.25
#: Of the noise; what is left beyond that is what a form that is not quite true leaves, and any bystander finds some of
#: it: a cause is named beside another only where more than so many times that error is left without it.
FORM_LEAVES, BYSTANDER = 1.5, 1.15
#: Of 53 machines of strangers that were left unexplained with a re-tuned model, four had it by far worse on an unseen
#: record than the design (as much as 38 times the error); three of those had left 58 % of the squares and more.
PAYS = 0.5


@dataclass(frozen=True, slots=True)
class GapParts:
    """Held-out errors, shape (n,), NaN where a row does not count; RMS in % of travel per cause and candidate.

    `without[name]`: the named causes less this one, what is left of its channel fitted anew; a channel that has no
    other is the design as given, without the numbers that had moved beside the cause. `alone[name]`: this candidate as
    the only cause of its channel. `driven`: errors before and after as RMS in the unit of the reading, given the
    measured pressure, where what was accepted behind it is erratic.
    """

    before: FloatArray
    retuned: FloatArray
    after: FloatArray
    without: dict[str, float]
    alone: dict[str, float]
    driven: tuple[float, float] | None = None


def heldout_parts(
    case: Case, result: StageResult, judgement: Judgement, retuned: Fit, sensing: Sensing, progress: Progress
) -> GapParts:
    """Refits everything on the rows that are not held out and predicts those that are."""
    chain = chain_channel(case.trials, case.sigma_y)
    before = predict_heldout(case, case.base, [], [])
    again = predict_heldout(case, case.base, [retuned], [chain])
    named = [d for d in result.decisions if d.explained]
    if judgement.verdict == "unexplained":
        after = again
    elif judgement.verdict == "no_gap" or not named:  # what the readings themselves show leaves the design as it is
        after = before
    else:
        after = _predicted(case, {d: d.accepted for d in named})
    if "sensor_dropouts" in sensing.accepted and judgement.verdict != "unexplained":
        before, again, after = _with_false_readings(case, retuned, sensing, before, again, after)
    progress("held-out gap", 0.5)
    percent = 100.0 / case.travel
    without = {name: percent * rms(_left_out(case, named, name)) for d in named for name in d.names}
    alone = _alone(case, result, named, percent)
    progress("held-out gap", 1.0)
    return GapParts(before, again, after, without, alone, driven_errors(named))


def idle_cause(
    parts: GapParts, judgement: Judgement, result: StageResult, travel: float, healthy: float = 0.0
) -> str | None:
    """The cause behind the pressure without which unseen data are predicted as well as with it, if there is one.

    Or as well as a healthy machine is: to an error of `healthy` percent of travel. A cause of the converter has the
    pressure to show for itself, which this error is not about; and one that stands alone is judged by `upheld`.
    """
    behind = {name for d in result.decisions if d.findings.channel.name != "pressure" for name in d.names}
    enough = max(IDLE * 100.0 / travel * rms(parts.after), healthy)
    spare = [c.name for c in judgement.causes if c.name in behind and parts.without.get(c.name, np.inf) < enough]
    if len(judgement.causes) < 2 or not spare:
        return None
    return min(spare, key=lambda name: parts.without[name])


def passes_for_noise(parts: GapParts, floor_percent: float, travel: float) -> float:
    """The error on unseen data that needs no cause beside another one [percent of travel]: little more than noise.

    Nor than what is left: where all causes leave less than the noise, that was estimated too large; where they leave
    clearly more, it is what a wrong form leaves, or slips that come a moment too early.
    """
    after = 100.0 * rms(parts.after) / travel
    if after > FORM_LEAVES * floor_percent and parts.driven is None:
        return BYSTANDER * after
    return BESIDE * min(floor_percent, after)


def retuning_pays(parts: GapParts) -> bool:
    """Whether the re-tuned design misses unseen data by less than `PAYS` of the squares of the design as given.

    Numbers that leave more than that are not what is wrong, but bent to imitate it, and go astray on other commands.
    """
    return bool(rms(parts.retuned) ** 2 < PAYS * rms(parts.before) ** 2)


def _predicted(case: Case, fits: dict[Decision, Fit]) -> FloatArray:
    channels = [d.findings.channel for d in fits]
    return predict_heldout(case, case.base, list(fits.values()), channels)


def driven_errors(named: Sequence[Decision]) -> tuple[float, float] | None:
    """The errors behind the measured pressure, given that, where they are of an erratic cause; else None.

    From the command alone a slip may come a moment too early, and is then off by all of its way until the next.
    """
    for decision in named:
        channel = decision.findings.channel
        if channel.name == "position" and is_erratic(decision.accepted):
            errors = (decision.findings.none.residuals, errors_on_channel(decision.accepted, channel))
            before, after = (channel.sigma * rms(np.where(channel.use, e, np.nan)) for e in errors)
            return before, after
    return None


def _with_false_readings(
    case: Case, retuned: Fit, sensing: Sensing, *errors: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The errors with the false readings among the rows: they are part of the gap before, and accounted for after."""
    chain = chain_channel(case.everything.trials, case.sigma_y)
    false = np.concatenate(sensing.bad_rows) & np.isfinite(chain.measured)
    before, again, after = (error.copy() for error in errors)
    before[false] = (chain.measured - chain.prediction(case.base))[false]
    again[false] = (chain.measured - chain.prediction(retuned.plant))[false]
    after[false] = 0.0
    return before, again, after


def _left_out(case: Case, named: list[Decision], name: str) -> FloatArray:
    """Errors with all named causes but one."""
    fits = {}
    for decision in named:
        kept = set(decision.names) - {name}
        smaller = [f for f in (decision.findings.none, *decision.findings.fits) if set(f.names) == kept]
        smaller = [f for f in smaller if not lays_open(decision.accepted, f)]
        if name not in decision.names:
            fits[decision] = decision.accepted
        elif kept and (name.startswith("parameter:") or not smaller):
            fits[decision] = fitted_without(decision, name, case)
        elif kept:
            fits[decision] = min(smaller, key=lambda f: f.mse)
        elif not kept:
            fits[decision] = decision.findings.none
    return _predicted(case, fits)


def fitted_without(decision: Decision, name: str, case: Case) -> Fit:
    """The accepted causes less one of them; an accused number may not ride along either."""
    accepted = decision.accepted
    causes = [c for c in accepted.space.causes if c.name != name]
    numbers = [n for n in accepted.space.numbers if f"parameter:{n}" != name]
    space = make_space(accepted.space.base, causes, numbers, case.scales)
    return fit(decision.findings.channel, space, starts_of(space, [accepted]), rounds=8)


def _alone(case: Case, result: StageResult, named: list[Decision], percent: float) -> dict[str, float]:
    """The best single candidates of each channel, each with what the other channels accepted."""
    gaps: dict[str, float] = {}
    for decision in result.decisions:
        singles = sorted((f for f in decision.findings.fits if len(f.names) == 1), key=lambda f: f.mse)
        for single in singles[:_RANKED]:
            fits = {d: d.accepted for d in named if d is not decision} | {decision: single}
            gaps[single.names[0]] = percent * rms(_predicted(case, fits))
    return gaps
