"""What next: the experiment that best separates what is still in dispute, or the sensor that it would take.

After a clear verdict nothing; after `no_gap` and `unexplained` the experiment that shows what these records could not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from control.experiment import Experiment
from control.preview import duration_words
from logs.spoken import Spoken
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult
from twin.choose.weigh import Weights
from twin.diagnosis import Cause, EffectTest, NextExperiment
from twin.judge.verdict import Judgement
from twin.next.coverage import best_coverage, blind_spots, weakens
from twin.next.criterion import Scale
from twin.next.file import rounded, toml_text
from twin.next.fresh import open_sweep, poor_ground
from twin.next.limits import Limits, limits_of
from twin.next.rivals import Dispute, disputes
from twin.next.search import Found, best_experiment
from twin.next.sensors import advice

FILE = "next.toml"
#: An experiment that brings less than this share of what settles a dispute is not worth the bench's time.
_HELPS = 0.3
#: ... and below this share it is not even a hint.
_HINTS = 0.05
#: What is asked of an experiment beyond what settles a dispute on average: half of the time less comes out.
_SAFE = 1.5
#: A cause with less than this is said to be left open, though nothing rivals it: one in ten is not there.
_BEYOND_DOUBT = 0.9
#: Times the noise: what named causes may leave before it is worth a word.
_MUCH = 2.0


@dataclass(frozen=True, slots=True)
class Proposal:
    """What the diagnosis says, and the text of `next.toml`; None where no experiment could help or none is needed."""

    next: NextExperiment
    file: str | None = None
    experiment: Experiment | None = None


def propose(
    result: StageResult, judgement: Judgement, tests: Sequence[EffectTest], rules: DecisionRules, weights: Weights
) -> Proposal:
    """The next experiment after a judgement; `tests` say which effects the records could have shown."""
    case = result.case
    limits = limits_of(case.base.design, case.recordings)
    open_ = disputes(result, judgement)
    if not open_ and judgement.causes:
        return _settled(result, judgement)
    if not judgement.causes:
        return _coverage(result, judgement, tests, rules, limits)
    words = [_alike_words(dispute, case.sigma_p is not None) for dispute in open_ if dispute.alike]
    needed = _SAFE * weights.temperature * math.log(1.0 / weights.confusable)
    nearest: tuple[Experiment, float] | None = None
    for dispute in open_:
        if not dispute.rivals:
            continue
        found = best_experiment(dispute, _scale(result, dispute), limits, needed)
        gains = {r.name: d.gain / needed for r, d in zip(dispute.rivals, found.distances, strict=True)}
        gain = max(gains.values())
        if gain >= _HELPS:
            return _experiment(result, dispute, found, gains, words)
        words += [_below_noise(dispute, found, case.sigma_p is not None, result)]
        if gain >= _HINTS and (nearest is None or gain > nearest[1]):
            nearest = found.experiment, gain
    if nearest is not None:
        return _hint(*nearest, words)
    return Proposal(NextExperiment(" ".join(words) or "No experiment of the library separates what is left."))


def _proposed(experiment: Experiment, why: str, said: str = "") -> Proposal:
    """The experiment with its file; `why` stands in the file, and in the diagnosis where nothing else is `said`."""
    return Proposal(NextExperiment(said or why, FILE), toml_text(experiment, why), experiment)


def _settled(result: StageResult, judgement: Judgement) -> Proposal:
    """After causes without a rival: who is not beyond doubt, and what they leave, of the signal in which it is."""
    sure = min(c.probability for c in judgement.causes)
    worst = max(result.decisions, key=lambda d: d.accepted.mse)
    channel = worst.findings.channel
    # beyond the edges of coarse steps there is next to no noise: what is left is held against that of the reading
    left = worst.accepted.mse**0.5 * (channel.sigma / result.case.sigma_y if channel.half > 0.0 else 1.0)
    much = (
        f"in the {'pressure' if channel.name == 'pressure' else 'position'}, on the rows that they were "
        f"fitted to, they leave {left:.2g} times its noise, which no candidate explains: repeat the record to see "
        "whether that repeats."
    )
    doubts = _doubts(judgement.causes)
    if doubts:
        return Proposal(NextExperiment(doubts + (f" And {much}" if left > _MUCH else "")))
    if left > _MUCH:
        return Proposal(
            NextExperiment(f"No experiment is needed to name the causes (probability at least {sure:.2f}); {much}")
        )
    return Proposal(
        NextExperiment(f"No further experiment is needed: each cause has a probability of at least {sure:.2f}.")
    )


def _doubts(causes: Sequence[Cause]) -> str:
    """What is left open though nothing rivals the causes: those that may not be there; empty if none is in doubt."""
    unsure = [f"{_plain(c.name)} ({c.probability:.2f})" for c in causes if c.probability < _BEYOND_DOUBT]
    if not unsure:
        return ""
    together = math.prod(c.probability for c in causes)
    all_of_them = f", that all {len(causes)} causes are there about {together:.2f}" if len(causes) > 1 else ""
    return (
        f"Likely but not beyond doubt: {', '.join(unsure)}{all_of_them}. No other known cause does as well in their "
        "place, so no experiment of the library separates them from one: record once more, and diagnose both records "
        "together to see whether they are named again."
    )


def _hint(found: Experiment, gain: float, words: Sequence[str]) -> Proposal:
    """The experiment that comes nearest, where none is enough: with the next diagnosis it may be another dispute."""
    experiment = rounded(found)
    why = (
        f"Without another signal the most that an experiment can add is {100.0 * gain:.0f} % of what settles it, "
        f"in {duration_words(experiment.duration_s)}."
    )
    return _proposed(experiment, why, " ".join([*words, why]))


def _experiment(
    result: StageResult, dispute: Dispute, found: Found, gains: Mapping[str, float], words: Sequence[str]
) -> Proposal:
    """The proposal of an experiment; `gains` are per rival, in units of what settles the dispute."""
    experiment = rounded(found.experiment)
    scales = result.case.scales
    unit = scales.pressure_unit if dispute.channel == "pressure" else scales.position_unit
    settled = [_plain(name) for name, gain in gains.items() if gain >= 1.0]
    helped = [_plain(name) for name, gain in gains.items() if _HELPS <= gain < 1.0]
    claims = [f"separates {_plain(dispute.cause)} from {' and '.join(settled)}"] if settled else []
    claims += [f"helps to separate {_plain(dispute.cause)} from {' and '.join(helped)}"] if helped else []
    open_ = [_plain(name) for name, gain in gains.items() if gain < _HELPS]
    size = max(found.distances, key=lambda d: d.gain).spread
    why = (
        f"{' and '.join(claims)} in {duration_words(experiment.duration_s)}: "
        f"predictions differ by up to {scales.spoken.text(size, unit, 2)} RMS beyond what re-fitting could hide."
    )
    why = why[0].upper() + why[1:] + (f" It leaves {' and '.join(open_)} open." if open_ else "") + dispute.caveat
    return _proposed(experiment, why, " ".join([why, *words]))


def _coverage(
    result: StageResult, judgement: Judgement, tests: Sequence[EffectTest], rules: DecisionRules, limits: Limits
) -> Proposal:
    """After `no_gap` or `unexplained`: what would show the effects that these records could not have shown."""
    spoken = result.case.scales.spoken
    spots = blind_spots(tests, result.case.scales, result.case.base.design)
    unexplained = judgement.verdict == "unexplained"
    start = "None of the known effects accounts for the gap. " if unexplained else ""
    fresh = _fresh_start(result, limits, start) if unexplained else None
    if fresh is not None:
        return fresh
    found = best_coverage(result, spots, rules, limits) if spots else None
    if found is None:
        here = "These records would have shown every known effect of a clear size"
        here += f", except {_blind_words([spot.name for spot in spots], tests, spoken)}" if spots else ""
        unshown = ", which no experiment of the library would show" if spots else ""
        tail = "; repeat them to see whether the gap repeats." if unexplained else ": no further experiment is needed."
        return Proposal(NextExperiment(start + here + unshown + tail))
    experiment = rounded(found.experiment)
    why = (
        f"{start}The next experiment would show {_blind_words(found.shown, tests, spoken)}, in "
        f"{duration_words(experiment.duration_s)}."
    )
    return _proposed(experiment, why)


def _fresh_start(result: StageResult, limits: Limits, start: str) -> Proposal | None:
    """Where the records are a poor ground for explaining a gap: the plain sweep to begin with; else None."""
    poor = poor_ground(result.case.everything.recordings, result.case.travel)
    sweep = open_sweep(limits)
    if poor is None or sweep is None:
        return None
    experiment = rounded(sweep)
    why = (
        f"{start}The records are a poor ground to look for others: {poor}. Sweep the valve in open loop over its full "
        f"stroke with inner reversals ({experiment.kind}, {duration_words(experiment.duration_s)}), and diagnose that."
    )
    return _proposed(experiment, why)


def _blind_words(names: Sequence[str], tests: Sequence[EffectTest], spoken: Spoken) -> str:
    """Effects with what these records say of each: nothing, or only from which size on."""
    limits = {t.name: t for t in tests if t.testable and t.detection_limit is not None}
    hidden = [_plain(name) for name in names if name not in limits]
    words = [f"{' and '.join(hidden)} (here not testable)"] if hidden else []
    for name in names:
        if name in limits:
            test = limits[name]
            size = spoken.text(test.detection_limit or 0.0, test.unit, 2)
            side = "below" if weakens(test) else "above"
            words.append(f"{_plain(name)} (here only with a {_plain(test.parameter)} {side} {size})")
    return ", ".join(words)


def _scale(result: StageResult, dispute: Dispute) -> Scale:
    case = result.case
    sigma = case.sigma_p if dispute.channel == "pressure" and case.sigma_p is not None else case.sigma_y
    period_s = sum(r.period_s for r in case.recordings) / len(case.recordings)
    return Scale(dispute.channel, sigma, max(dispute.phi * period_s, 1e-3), dispute.excess)


def _alike_words(dispute: Dispute, measured_pressure: bool) -> str:
    return " ".join(
        f"{_plain(dispute.cause).capitalize()} and {_plain(name)} cannot be separated with these sensors, whatever the "
        f"experiment: add {advice(dispute.cause, name, measured_pressure)}."
        for name in dispute.alike
    )


def _below_noise(dispute: Dispute, found: Found, measured_pressure: bool, result: StageResult) -> str:
    """That no experiment tells the cause from any of its rivals, and which signal would tell it from which."""
    scale = _scale(result, dispute)
    share = max(d.spread for d in found.distances) / (scale.sigma * scale.excess**0.5)
    signals: dict[str, list[str]] = {}
    for rival in dispute.rivals:
        signals.setdefault(advice(dispute.cause, rival.name, measured_pressure), []).append(_plain(rival.name))
    names = " or ".join(_plain(rival.name) for rival in dispute.rivals)
    if len(signals) == 1:
        add = next(iter(signals))
    else:
        add = "; ".join(f"for {' and '.join(rivals)} {signal}" for signal, rivals in signals.items())
    return (
        f"{_plain(dispute.cause).capitalize()} cannot be separated from {names} with these sensors: in the best "
        f"experiment of the library they differ by at most {share:.2g} of the noise; add {add}.{dispute.caveat}"
    )


def _plain(name: str) -> str:
    return name.removeprefix("parameter:").replace("_", " ")
