"""What next: the experiment that best separates what is still in dispute, or the sensor that it would take.

After a clear verdict nothing; after `no_gap` and `unexplained` the experiment that shows what these records could not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from control.experiment import Experiment
from control.preview import duration_words
from twin.choose.decide import DecisionRules
from twin.choose.weigh import Weights
from twin.diagnosis import EffectTest, NextExperiment
from twin.next.coverage import best_coverage, blind_spots
from twin.next.criterion import Scale
from twin.next.file import rounded, toml_text
from twin.next.limits import Limits, limits_of
from twin.next.rivals import Dispute, disputes
from twin.next.search import Found, best_experiment
from twin.next.sensors import advice
from twin.stages import StageResult
from twin.verdict import Judgement

FILE = "next.toml"
#: An experiment that brings less than this share of what settles a dispute is not worth the bench's time.
_HELPS = 0.3
#: What is asked of an experiment beyond what settles a dispute on average: half of the time less comes out.
_SAFE = 1.5
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
        sure = min(c.probability for c in judgement.causes)
        left = max(d.accepted.mse for d in result.decisions) ** 0.5
        if left > _MUCH:
            return Proposal(
                NextExperiment(
                    f"No experiment is needed to name the causes (probability at least {sure:.2f}); they leave "
                    f"{left:.2g} times the noise, which no candidate explains: repeat the record to see whether that "
                    "repeats."
                )
            )
        return Proposal(
            NextExperiment(f"No further experiment is needed: each cause has a probability of at least {sure:.2f}.")
        )
    if not judgement.causes:
        return _coverage(result, judgement, tests, rules, limits)
    words = [_alike_words(dispute, case.sigma_p is not None) for dispute in open_ if dispute.alike]
    needed = _SAFE * weights.temperature * math.log(1.0 / weights.confusable)
    for dispute in open_:
        if not dispute.rivals:
            continue
        found = best_experiment(dispute, _scale(result, dispute), limits, needed)
        gains = {r.name: d.gain / needed for r, d in zip(dispute.rivals, found.distances, strict=True)}
        if max(gains.values()) >= _HELPS:
            return _experiment(result, dispute, found, gains, words)
        words += [_below_noise(dispute, found, case.sigma_p is not None, result)]
    return Proposal(NextExperiment(" ".join(words) or "No experiment of the library separates what is left."))


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
    size = max(found.distances, key=lambda d: d.gain).spread
    why = (
        f"{' and '.join(claims)} in {duration_words(experiment.duration_s)}: "
        f"predictions differ by up to {size:.2g} {unit} RMS beyond what re-fitting could hide."
    )
    why = why[0].upper() + why[1:]
    text = " ".join([why, *words])
    return Proposal(NextExperiment(text, FILE), toml_text(experiment, why), experiment)


def _coverage(
    result: StageResult, judgement: Judgement, tests: Sequence[EffectTest], rules: DecisionRules, limits: Limits
) -> Proposal:
    """After `no_gap` or `unexplained`: what would show the effects that these records could not have shown."""
    spots = blind_spots(tests, result.case.scales)
    unexplained = judgement.verdict == "unexplained"
    start = "None of the known effects accounts for the gap. " if unexplained else ""
    if not spots:
        rest = "These records would have shown every known effect of a clear size"
        tail = "; repeat them to see whether the gap repeats." if unexplained else ": no further experiment is needed."
        return Proposal(NextExperiment(start + rest + tail))
    found = best_coverage(result, spots, rules, limits)
    if found is None:
        names = ", ".join(_plain(spot.name) for spot in spots)
        return Proposal(NextExperiment(f"{start}No experiment of the library would show {names} of a clear size."))
    experiment = rounded(found.experiment)
    why = (
        f"{start}The next experiment would show {', '.join(_plain(n) for n in found.shown)}, which these records could "
        f"not, in {duration_words(experiment.duration_s)}."
    )
    return Proposal(NextExperiment(why, FILE), toml_text(experiment, why), experiment)


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
    best = max(found.distances, key=lambda d: d.gain)
    rival = dispute.rivals[found.distances.index(best)].name
    scale = _scale(result, dispute)
    share = best.spread / (scale.sigma * scale.excess**0.5)
    return (
        f"{_plain(dispute.cause).capitalize()} and {_plain(rival)} cannot be separated with these sensors: in the best "
        f"experiment of the library they differ by {share:.2g} of the noise; add "
        f"{advice(dispute.cause, rival, measured_pressure)}."
    )


def _plain(name: str) -> str:
    return name.removeprefix("parameter:").replace("_", " ")
