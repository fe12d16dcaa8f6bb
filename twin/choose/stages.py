"""Stage by stage: the converter on its measured pressure, then valve and sensor on the pressure that was there.

Without a measured pressure there is one channel, the whole chain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.choose.decide import Decision, decide
from twin.choose.form_by_stem import formed_by_stem
from twin.choose.lean import leaning
from twin.choose.rules import DecisionRules
from twin.choose.unbent import unbent
from twin.choose.witness import (
    driven_by_model,
    gauge_lies,
    gauge_wanders,
    left_of_position,
    missed_of_position,
    still_denied,
)
from twin.fit.case import Case
from twin.fit.channel import Channel, chain_channel, position_channel, pressure_channel
from twin.fit.fitting import Fit
from twin.fit.in_steps import in_steps
from twin.fit.numbers import nominal, retuned
from twin.fit.smooth import BELIEVING, CAREFUL, noise_left, smoothed_pressure
from twin.fit.trial import Trial
from twin.model.plant import Plant
from twin.search.search import Searcher
from twin.search.search_rules import SearchRules

#: What is left of the pressure's noise by smoothing is known to this share of itself.
NOISE_UNSURE = 0.25

Progress = Callable[[str, float], None]
Watch = Callable[[Searcher], None]


@dataclass(frozen=True, slots=True)
class StageResult:
    """Decisions per channel ("pressure" and "position", or "chain" alone) and the plant they add up to.

    `astray`: the pressure was read, but the stem did not follow what was read (see `twin.choose.witness`); `denied`:
    the causes in which its model of the converter had, all the same, explained the reading.
    """

    case: Case
    decisions: tuple[Decision, ...]
    trials: tuple[Trial, ...]
    astray: bool = False
    denied: tuple[str, ...] = ()

    @property
    def causes(self) -> tuple[str, ...]:
        """Names of all accepted causes."""
        return tuple(name for d in self.decisions for name in d.names)

    def plant(self) -> Plant:
        """The base plant with everything accepted."""
        return combined(self.case.base, [d.accepted for d in self.decisions if d.explained])


def combined(base: Plant, fits: Sequence[Fit]) -> Plant:
    """One plant out of fits on different channels: each brings its design numbers and its effects."""
    design = base.design
    found = Plant(design, base.inserted)
    for one in fits:
        plant = one.plant
        design = retuned(design, {n: nominal(plant.design, n) for n in one.space.numbers})
        found = found.having([i for i in plant.inserted if i not in base.inserted])
    return Plant(design, found.inserted)


def judge(
    case: Case,
    search: SearchRules,
    rules: DecisionRules,
    progress: Progress,
    watch: Watch = lambda _searcher: None,
) -> StageResult:
    """Runs the search on every channel that the signals allow; `watch` is shown each search as it begins."""
    if case.sigma_p is None:
        channel = in_steps(case, chain_channel(case.trials, case.sigma_y))
        if case.noise.position.source != "repeats":
            # Without measured pressure and without repeats nobody knows how much the pressure wandered by itself.
            rules = replace(rules, quiet=3.0 * rules.quiet)
        return StageResult(case, (_judge(case, channel, search, rules, progress, watch),), case.trials)
    first = _judge(case, pressure_channel(case.trials, case.sigma_p), search, rules, progress, watch)
    first = formed_by_stem(case, first, rules)
    heard = _by_witness(case, first)
    channel = in_steps(case, position_channel(heard.trials, case.sigma_y))
    floor = 1.0 if heard.astray else 1.0 + pressure_doubt(case, channel, heard.decision)
    second = _judge(case, channel, search, rules, progress, watch, floor)
    if not heard.astray:
        modelled = driven_by_model(_believed(first), case.trials)
        if still_denied(case, modelled, _likely(second)):
            heard = replace(heard, trials=modelled, astray=True)
            channel = in_steps(case, position_channel(modelled, case.sigma_y))
            second = _judge(case, channel, search, rules, progress, watch)
    return StageResult(case, (heard.decision, second), heard.trials, heard.astray, heard.denied)


def _likely(decision: Decision) -> Fit:
    """What was accepted, or the likeliest single cause."""
    findings = decision.findings
    single = findings.best_of_size(1)
    return single if decision.accepted is findings.none and single is not None else decision.accepted


@dataclass(frozen=True, slots=True)
class _Heard:
    """The decision on the pressure after the stem was heard, what drives the valve, and what `StageResult` keeps."""

    decision: Decision
    trials: tuple[Trial, ...]
    astray: bool = False
    denied: tuple[str, ...] = ()


def _by_witness(case: Case, first: Decision) -> _Heard:
    trials, modelled = drive_by_measured(case, first), driven_by_model(_believed(first), case.trials)
    read, left = left_of_position(case, trials), left_of_position(case, modelled)
    if first.names:
        designed = driven_by_model(first.findings.none.plant, case.trials)
        with_it = min(missed_of_position(case, driven) for driven in (trials, modelled))
        same_all_along = gauge_lies(with_it, missed_of_position(case, designed))
        if same_all_along or gauge_lies(min(read, left), left_of_position(case, designed)):
            silent = replace(first, accepted=first.findings.none, explained=False, rest=1.0)
            return _Heard(silent, designed, True, first.names)
    believing = left_of_position(case, drive_by_measured(case, first, BELIEVING))
    return _Heard(first, modelled, True) if gauge_wanders(read, left, believing) else _Heard(first, trials)


def driven_again(case: Case, result: StageResult) -> tuple[Trial, ...]:
    """The trials of another look at the same records, driven as those of a result."""
    converter = result.decisions[0]
    return driven_by_model(_believed(converter), case.trials) if result.astray else drive_by_measured(case, converter)


def pressure_doubt(case: Case, channel: Channel, converter: Decision) -> float:
    """What the doubt about the driving pressure does to the position: mean square in units of the noise variance.

    Believing the readings altogether lets their own noise drive the play, too: what they add counts as far as it
    is more than that noise.
    """
    believing = position_channel(drive_by_measured(case, converter, BELIEVING), case.sigma_y)
    difference = (channel.prediction(case.base) - believing.prediction(case.base))[channel.use]
    square = case.coarse.shifted(difference) if case.coarse is not None else float(np.mean(np.square(difference)))
    return _beyond_noise(case, channel, believing, _best(converter)) * square / channel.sigma**2


def _beyond_noise(case: Case, careful: Channel, believing: Channel, plant: Plant) -> float:
    """Share of what the pressure readings add, and only the believing believe, that may be more than their noise."""
    noise, sigma = case.noise.pressure, case.sigma_p
    added, expected = [], []
    for one, other in zip(careful.trials, believing.trials, strict=True):
        if noise is None or sigma is None or one.pressure is None or other.pressure is None:
            return 1.0
        rows = one.grid.offsets
        added.append(np.square(other.pressure[rows] - one.pressure[rows]))
        left = noise_left(plant, one, sigma, noise.correlation)
        expected.append(np.where(np.isfinite(left), left, sigma**2))
    ratio = float(np.mean(np.concatenate(added)) / max(float(np.mean(np.concatenate(expected))), 1e-300))
    return float(np.clip(ratio - (1.0 - NOISE_UNSURE), 0.0, 1.0))


def drive_by_measured(case: Case, converter: Decision, care: float = CAREFUL) -> tuple[Trial, ...]:
    """The trials with their smoothed measured pressure, smoothed about the best converter model there is."""
    return driven_about(_best(converter), case, care)


def _best(converter: Decision) -> Plant:
    """The best converter model there is; what was accepted, where that is as good."""
    if converter.explained and converter.exact:
        return converter.accepted.plant
    return min((converter.findings.none, *converter.findings.fits), key=lambda f: f.mse).plant


def _believed(converter: Decision) -> Plant:
    """The converter with what was accepted: what else fits the readings best fits a gauge that strays, too."""
    return (converter.accepted if converter.explained else converter.findings.none).plant


def driven_about(plant: Plant, case: Case, care: float = CAREFUL) -> tuple[Trial, ...]:
    """The trials with their measured pressure, smoothed about what `plant` makes of the commands; as they are without.

    `care`: see `smoothed_pressure`.
    """
    noise, sigma = case.noise.pressure, case.sigma_p
    if noise is None or sigma is None:
        return case.trials
    memory = noise.correlation
    return tuple(t.with_pressure(smoothed_pressure(plant, t, sigma, memory, care=care)) for t in case.trials)


def _judge(
    case: Case,
    channel: Channel,
    search: SearchRules,
    rules: DecisionRules,
    progress: Progress,
    watch: Watch,
    floor: float = 1.0,
) -> Decision:
    searcher = Searcher(channel, case.base, case.scales, search, progress, _resting(case, channel))
    watch(searcher)
    return leaning(unbent(decide(searcher.run(), rules, floor), case.scales), case.scales, rules)


def _resting(case: Case, channel: Channel) -> float:
    """Mean squared error of the channel's reading at rest, noise variance = 1; 1 where that is not known."""
    noise = case.noise.pressure if channel.name == "pressure" else case.noise.position
    resting = noise.resting if noise is not None else None
    return 1.0 if resting is None else float(min(1.0, (resting / channel.sigma) ** 2))
