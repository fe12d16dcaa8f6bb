"""Whether a judgement stands on data that no fit has seen."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from twin.choose.decide import Decision
from twin.choose.stages import StageResult
from twin.choose.trim import doubtful
from twin.diagnosis import Cause, Verdict
from twin.fit.fitting import Fit
from twin.judge.gap import GapParts, retuning_pays
from twin.judge.remainder import CLEAR, FREE, SLIGHT, leaves_too_much, no_better_than_numbers
from twin.judge.verdict import Judgement, verdict_of
from twin.model.catalog import effects
from twin.record.sensing import Sensing
from twin.where.closure import rms

#: Of the error before; a model that leaves more has explained nothing.
NO_BETTER = 0.95
#: Of the noise; a design that misses by less has no gap.
HARDLY = 1.15
#: Of the noise; a design that misses by more has a gap, whatever explains it.
DOUBTFUL = 1.6
#: Of the noise; a pressure that is off by more has a cause, where one explains it to its noise.
EXPLAINED = 2.0
#: Of the squared gap; what is predicted so well on unseen rows was no wandering of an unmeasured pressure.
TRACE = 0.1


def upheld(
    parts: GapParts,
    judgement: Judgement,
    floor: float,
    sensing: Sensing,
    apart: bool,
    wandering: float = 1.0,
    disturbed: bool = False,
    exact: bool = False,
    shown: Collection[str] = (),
    swings: bool = False,
) -> tuple[GapParts, Judgement]:
    """The judgement, taken back where data that no fit has seen speak against it; with the errors that go with it.

    A cause is not named for an error below the noise, nor when the model with it predicts no better; nor is a design
    without a gap that misses by far more than the noise. What the readings themselves showed (false, held, coarse ones)
    needs no prediction. `apart`: the pressure was measured, so that a cause before it has a signal of its own.
    `wandering`: mean square, noise = 1, that the true model leaves because nobody knows the driving pressure exactly; a
    prediction from the command leaves it too. `disturbed`: there is a gap, whatever causes it; `exact`: see
    `explained_to_noise`; `shown`: see `shown_by_pressure`; `swings`: a signal swings by itself, which shakes the stem
    through its friction or hides how it does, so that only a cause that leaves nothing else is believed.
    """
    before, after = rms(parts.before), rms(parts.after)
    if judgement.verdict == "no_gap" and before > DOUBTFUL * floor:
        return _unexplained(parts, judgement)
    if not judgement.causes:
        return (parts, judgement) if judgement.verdict == "no_gap" else _unexplained(parts, judgement)
    if sensing.accepted:
        return _seen(parts, judgement, floor, sensing, shown)
    # what the pressure shows need not reach the stem, unless that is clearly off
    told = before <= CLEAR * floor and _all_in(judgement, shown)
    vain = (after > NO_BETTER * before and not told) or (swings and not exact) or doubted(judgement, exact)
    trace = exact and _follows_commands(judgement.causes) and after**2 - floor**2 < TRACE * (before**2 - floor**2)
    # how much an unmeasured pressure wandered by itself nobody knows, but no law of the commands predicts that
    hardly = before <= (HARDLY if apart or trace else SLIGHT) * floor
    if hardly or (before < SLIGHT * floor and (vain or _any_of_many(judgement, exact))):
        left = _named_only(judgement, shown)
        return (parts, left) if left.causes and not doubted(left, exact) else nothing(parts, judgement, disturbed)
    vain = vain or _leaves_too_much(parts, wandering**0.5 * floor, judgement, apart, exact, shown)
    return _unexplained(parts, judgement) if vain else (parts, judgement)


def _leaves_too_much(
    parts: GapParts, floor: float, judgement: Judgement, apart: bool, exact: bool, shown: Collection[str]
) -> bool:
    before, after = rms(parts.before), rms(parts.after)
    errors = parts.driven or (before, after)
    if leaves_too_much(*errors, floor, judgement.causes, apart, exact, shown):
        return True
    return no_better_than_numbers(rms(parts.retuned), after, floor, judgement.causes, _all_in(judgement, shown))


def _seen(
    parts: GapParts, judgement: Judgement, floor: float, sensing: Sensing, shown: Collection[str]
) -> tuple[GapParts, Judgement]:
    """The judgement where the readings themselves showed something, which needs no prediction."""
    before = rms(parts.before)
    if {c.name for c in judgement.causes} == {"sensor_quantization"} and before > _coarse(floor, sensing.step):
        return _unexplained(parts, judgement)
    return parts, _named_only(judgement, {*sensing.accepted, *shown}) if before <= floor else judgement


def _any_of_many(judgement: Judgement, exact: bool) -> bool:
    """Whether only causes that the record cannot tell apart are together likely; of a slight gap that is no answer."""
    return doubted(replace(judgement, alike={}), exact)


def _coarse(floor: float, step: float) -> float:
    """Error beyond which steps of a reading are not all that is wrong: more than noise and rounding leave."""
    return float(np.hypot(DOUBTFUL * floor, 0.5 * step))


def _all_in(judgement: Judgement, names: Collection[str]) -> bool:
    return {c.name for c in judgement.causes} <= set(names)


def _follows_commands(causes: Collection[Cause]) -> bool:
    """Whether the causes are laws of few numbers in which time does not stand."""
    known = effects()
    drifts = any(c.name in known and known[c.name].drifts for c in causes)
    return not drifts and all(len(c.parameters) <= FREE for c in causes)


def nothing(parts: GapParts, judgement: Judgement, disturbed: bool) -> tuple[GapParts, Judgement]:
    """No causes, and no gap but for what disturbs."""
    verdict: Verdict = "unexplained" if disturbed else "no_gap"
    return replace(parts, after=parts.before), Judgement(verdict, (), judgement.ranking, ())


def _unexplained(parts: GapParts, judgement: Judgement) -> tuple[GapParts, Judgement]:
    """No causes; what is left is the better of the design as given and the re-tuned one."""
    after = parts.retuned if retuning_pays(parts) else parts.before
    return replace(parts, after=after), Judgement("unexplained", (), judgement.ranking, ())


def doubted(judgement: Judgement, exact: bool) -> bool:
    """Whether none of the named causes is, with what cannot be told from it, nearly as likely as not.

    `exact`: all is explained to its noise.
    """
    probability = {r.name: r.probability for r in judgement.ranking} | {c.name: c.probability for c in judgement.causes}
    sets = judgement.confusable if exact else ()
    return all(doubtful(c.name, probability, judgement.alike.get(c.name, ()), sets) for c in judgement.causes)


def explained_to_noise(result: StageResult) -> bool:
    """Whether what was accepted explains all of its signals to their noise."""
    return all(d.exact for d in result.decisions if d.names)


def shown_by_pressure(result: StageResult) -> tuple[str, ...]:
    """Causes of the converter for which the measured pressure speaks, whether or not they reach the stem.

    A supply that gives too little for the last tenth of the range moves nothing where the stem is at its stop by then.
    What is explained to its noise may be less than clear.
    """
    pressure = [d for d in result.decisions if d.findings.channel.name == "pressure" and d.explained]
    return tuple(name for d in pressure if d.findings.none.mse > _shows(d) ** 2 * d.floor for name in d.names)


def shown_beyond_steps(result: StageResult) -> tuple[str, ...]:
    """Causes for which a reading in sharp steps speaks that no rounding explains, however small beside a step.

    Errors on unseen rows are those of the reading, rounding and all, in which what moves the stem by less than a step
    may not show; what lies beyond half a step is all that a fit to such a reading counts.
    """
    behind = result.decisions[-1]
    return behind.names if shows_beyond_steps(behind, behind.findings.none) else ()


def shows_beyond_steps(decision: Decision, less: Fit) -> bool:
    """Whether a reading in sharp steps speaks against a smaller hypothesis than the accepted one."""
    steps = decision.findings.channel.half > 0.0 and decision.slips is None
    return bool(steps and decision.exact and less.mse > CLEAR**2 * decision.floor)


def _shows(decision: Decision) -> float:
    """Of the noise, by how much a pressure has to be off to show a cause by itself."""
    return EXPLAINED if decision.exact else CLEAR


def _named_only(judgement: Judgement, names: Collection[str]) -> Judgement:
    """The judgement with those causes only that stand in `names`: there is no error for any other."""
    causes = tuple(c for c in judgement.causes if c.name in names)
    sets = tuple(s for s in judgement.confusable if s[0] in names)
    return replace(judgement, verdict=verdict_of(causes), causes=causes, confusable=sets)
