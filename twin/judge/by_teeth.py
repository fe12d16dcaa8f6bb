"""Stick-slip recognised by its slips, where no path can be followed.

Which slip comes before a reversal and which after it may hang on a hundredth of a psi, and how firmly a stem sticks may
differ from one stick to the next. The right cause then predicts the readings hardly better than none, and every other
is held against what it is not. What it does predict is how often the stem stands and jumps, and how far: the teeth of
`twin.events.teeth`, looked for alike in the readings and in what a model would have recorded.
Source: Wood, Nature 466 (2010) 1102 (a synthetic record's summary statistics in the place of its path).
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from logs.recording import DataNote, FloatArray
from logs.spoken import HOUSE, Spoken
from twin.choose.decide import Decision
from twin.choose.stages import StageResult
from twin.events.teeth import Pushes, Slips, Teeth, Valve, fixed_in_place, pushes, teeth, together
from twin.fit.case import Case
from twin.fit.channel import Channel
from twin.fit.fitting import Fit, evaluated, fit
from twin.fit.space import Cause, Space, cause_starts, make_space
from twin.model.plant import Plant
from twin.search.candidates import effect_causes
from twin.search.reform import curved

#: Teeth that are many, and the share of the way that is jumped in all that a model without slips may jump. Fewer are
#: enough where what slips leaves no more than a share of the gap's squares.
_MANY, _FEW = 10, 0.4
_SOME, _LEFT = 8, 0.1
#: The best hypotheses without slips, which are asked whether they make the teeth.
_OTHERS = 5
#: Factor by which a model's teeth may be more or fewer, longer or shorter.
_ALIKE = 1.5
#: What it may leave at the most of the squares that the design misses by: it is no worse a model for being a wild one.
_LEAVES = 0.7
_ROUNDS, _THREADS = 6, 2
#: Causes up to which what was accepted is believed, if it slips: two are rare, and more are what a wild path seems.
_BESIDE = 2
_SEED = 20101102


def by_slips(case: Case, result: StageResult, unexplained: bool) -> StageResult | None:
    """The result with a stem that slips, where its teeth say so; None where they do not, or a path can be followed.

    `unexplained`: nothing that was accepted has stood; else what was accepted is left alone where it explains the
    reading to its noise, or slips itself with at most one other cause beside it.
    """
    decision = result.decisions[-1]
    slips = any(map(_slips_by, decision.accepted.space.causes)) and len(decision.names) <= _BESIDE
    if not unexplained and (decision.exact or slips or not decision.names):
        return None
    found = slipping(case, decision)
    return None if found is None else replace(result, decisions=(*result.decisions[:-1], found))


def slips_note(result: StageResult, pressure_unit: str, spoken: Spoken = HOUSE) -> list[DataNote]:
    """What to say where a cause was recognised by its slips; `spoken`: in which units."""
    decision = result.decisions[-1]
    if decision.slips is None:
        return []
    seen, model, name = decision.slips.seen, decision.slips.model, decision.names[0]
    what = f"the stem stands and jumps {seen.count} times, and no model says when"
    handled = (
        f"{name} was recognised by how often and how far: its model jumps {model.count} times, by "
        f"{spoken.text(model.typical, pressure_unit, 2)} in the median instead of "
        f"{spoken.value(seen.typical, pressure_unit):.2g}, and no cause without jumps "
        "that leaves less jumps half as far in all; what it leaves of the error is no measure of it"
    )
    return [DataNote(what, handled)]


def slipping(case: Case, decision: Decision) -> Decision | None:
    """The decision for what makes a stem slip, where its teeth say so and nothing else does; None otherwise."""
    channel = decision.findings.channel
    if channel.name != "position" or any(trial.pressure is None for trial in channel.trials):
        return None
    look = _looking(channel, _valve(case))
    seen = look.teeth(channel.measured)
    if seen.count < _SOME or fixed_in_place(seen):
        return None
    found = _likeliest(case, decision, look, seen)
    if found is None or found.mse > _LEAVES * decision.findings.none.mse:
        return None
    if seen.count < _MANY and decision.rest_of(found) > _LEFT:
        return None
    if any(look.of(other.plant).total > _FEW * seen.total for other in _better(decision, found)):
        return None
    findings = replace(decision.findings, fits=(*decision.findings.fits, found))
    slips = Slips(seen, look.of(found.plant))
    return Decision(findings, found, True, True, decision.rest_of(found), decision.floor, slips=slips)


def _likeliest(case: Case, decision: Decision, look: _Look, seen: Teeth) -> Fit | None:
    """Of what makes such teeth the hypothesis that leaves least, its numbers fitted as far as its teeth stay alike."""
    channel = decision.findings.channel

    def tried(one: tuple[Space, FloatArray]) -> Fit | None:
        space, z = one
        return evaluated(channel, space, z) if look.alike(space.plant(z), seen) else None

    with ThreadPoolExecutor(_THREADS) as pool:
        able = [one for one in pool.map(tried, _slips(case, decision)) if one is not None]
    if not able:
        return None
    best = min(able, key=lambda one: one.mse)
    fitted = fit(channel, best.space, [best.z], rounds=_ROUNDS)
    return fitted if look.alike(fitted.plant, seen) else best


@dataclass(frozen=True, slots=True)
class _Look:
    """Looks for teeth in what a channel read or would have read, through the same `noise` every time, shape (n,)."""

    channel: Channel
    pushed: tuple[Pushes, ...]
    noise: FloatArray

    def of(self, plant: Plant) -> Teeth:
        """The teeth that a plant would have shown."""
        return self.teeth(self.channel.prediction(plant) + self.noise)

    def alike(self, plant: Plant, seen: Teeth) -> bool:
        """Whether a plant would have shown about as many teeth, and about as long ones."""
        some = self.of(plant)
        if not some.count:
            return False
        off = np.log([some.count / seen.count, some.typical / seen.typical])
        return bool(np.max(np.abs(off)) < np.log(_ALIKE))

    def teeth(self, reading: FloatArray) -> Teeth:
        """The teeth of readings over all trials; false ones are bridged."""
        rows, use = np.arange(reading.size), self.channel.use
        reading = np.interp(rows, rows[use], reading[use])
        ends = np.cumsum([trial.recording.n for trial in self.channel.trials])[:-1]
        return together(list(map(teeth, self.pushed, np.split(reading, ends))))


def _looking(channel: Channel, valve: Valve) -> _Look:
    driven = [(t.recording.time_s, t.pressure[t.grid.offsets]) for t in channel.trials if t.pressure is not None]
    noise = np.random.default_rng(_SEED).standard_normal(channel.measured.size)
    return _Look(channel, tuple(pushes(*one, valve) for one in driven), valve.sigma * noise)


def _valve(case: Case) -> Valve:
    """The valve as designed; repeats that slip otherwise differ by more than noise, and a resting reading does not."""
    design, noise = case.base.design, case.noise.position
    sigma = case.sigma_y if noise.resting is None else min(case.sigma_y, noise.resting)
    deadband, sigma_p = design.a1 - design.a2, case.sigma_p or 0.0
    return Valve(design.compliance, design.tau_s, deadband, sigma, sigma_p, noise.correlation_samples)


def _better(decision: Decision, found: Fit) -> list[Fit]:
    """The best laws that do not slip and leave less all the same.

    A free curve, in place or in time, follows any wild path a little; teeth that are fixed in place have been left
    alone before.
    """
    fits = (decision.findings.none, decision.findings.retuned, *decision.findings.fits)
    laws = sorted((f for f in fits if not any(map(_slips_or_bends, f.space.causes))), key=lambda f: f.mse)
    return [f for f in laws[:_OTHERS] if f.mse < found.mse]


def _slips_or_bends(cause: Cause) -> bool:
    return _slips_by(cause) or (cause.form is not None and curved(cause.form))


def _slips_by(cause: Cause) -> bool:
    return cause.effect is not None and cause.effect.erratic


def _slips(case: Case, decision: Decision) -> Iterator[tuple[Space, FloatArray]]:
    """Everything that slips, in every form and at each of its starts, with the numbers of the design."""
    channel = decision.findings.channel
    for cause in filter(_slips_by, effect_causes(channel, case.base)):
        space = make_space(case.base, [cause], channel.numbers, case.scales)
        for start in cause_starts(cause, case.scales, channel.recordings):
            yield space, np.concatenate([np.zeros(len(space.numbers)), start])
    yield from ((f.space, f.z) for f in decision.findings.fits if len(f.names) == 1 and _slips_by(f.space.causes[0]))
