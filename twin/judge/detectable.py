"""What a record could have shown: per cause the smallest size that would have been accepted, or why none would.

The response to a size is projected off the design numbers' responses (re-tuning would hide that part); what is left
must reach the evidence and the gain that the decision asks for, and the gap without which nothing is named. Responses
need not be in proportion to the size (a delay inside a lag, a band that nothing leaves), so the size is walked towards
where they suffice.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from logs.recording import FloatArray
from twin.choose.rules import DecisionRules
from twin.diagnosis import EffectTest
from twin.fit.case import Case
from twin.fit.channel import Channel
from twin.fit.least_squares import jacobian
from twin.fit.numbers import nominal, reference, retuned, unit
from twin.fit.space import make_space
from twin.judge.remainder import SLIGHT
from twin.judge.tolerance import TOLERANCE
from twin.judge.upheld import EXPLAINED, HARDLY
from twin.model.catalog import effects as catalogued
from twin.model.effect import Effect, Form, Parameter, Scales
from twin.model.plant import Inserted, Plant
from twin.search.candidates import effect_causes

_STEPS, _THREADS = 5, 2
#: A size is near enough when what it shows is within these bounds of what is needed.
_NEAR = (0.8, 1.3)
#: Share of a record's time that is the whole of it.
_WHOLE = 0.9
#: The first and the largest relative error of a design number that is asked about, and the largest downwards.
_FIRST_WRONG, _WRONG, _TOO_SMALL = 0.01, 0.5, 0.8
#: A size that is none, as a share of the range, and what it may show: a form may do something without any.
_NOTHING, _NOTHING_SHOWS = 1e-7, 0.1


@dataclass(frozen=True, slots=True)
class Detector:
    """What a channel would have to be shown. `nuisance`: orthonormal responses of the design numbers, (n, numbers)."""

    channel: Channel
    base: Plant
    scales: Scales
    nuisance: FloatArray
    plain: FloatArray
    needed: float

    def shown(self, plant: Plant, nuisance: FloatArray) -> float:
        """The power that a changed plant's response keeps beside re-tuning, 1 = enough."""
        change = self.channel.residuals(plant) - self.plain
        change -= nuisance @ (nuisance.T @ change)
        return float(change @ change) / self.needed


def detection_limits(
    channels: Sequence[Channel], base: Plant, scales: Scales, effects: Sequence[Effect], rules: DecisionRules
) -> tuple[EffectTest, ...]:
    """One line per cause that acts on a trajectory, by name: effects, then numbers; other stages' are left out."""
    lines, numbers = list[EffectTest](), list[EffectTest]()
    for channel in channels:
        basis = _nuisance(channel, base, scales)
        needed = max(2.0 * rules.evidence, max(rules.gain, least_gap(channel)) * channel.rows)
        detector = Detector(channel, base, scales, np.linalg.qr(basis)[0], channel.residuals(base), needed)
        stand_trial = effect_causes(channel, base)
        acting = [e for e in effects if e.stage in channel.stages and e.evidence == "trajectory"]
        tried = [[c.form for c in stand_trial if c.name == e.name and c.form is not None] for e in acting]
        with ThreadPoolExecutor(_THREADS) as pool:
            lines += pool.map(partial(_best_form, detector), acting, tried)
        for k, name in enumerate(channel.numbers):
            others = np.linalg.qr(np.delete(basis, k, axis=1))[0]
            numbers.append(_of_number(detector, name, others))
    return tuple(sorted(lines, key=lambda line: line.name) + sorted(numbers, key=lambda line: line.name))


def least_gap(channel: Channel) -> float:
    """What a cause has to make of the channel's mean square, noise = 1, to be upheld (`twin.judge.upheld.upheld`).

    One of the converter may reach the stem and show there for less; what it shows by the pressure alone is promised.
    """
    least = {"pressure": EXPLAINED, "position": HARDLY}.get(channel.name, SLIGHT)
    return least**2 - 1.0


def unseen_in_windows(tests: Sequence[EffectTest], channel: Channel, case: Case) -> tuple[EffectTest, ...]:
    """The tests without a claim about slow changes, where the channel looks at windows of a long record only."""
    seen_s = sum(t.recording.duration_s for t in channel.trials)
    if seen_s > _WHOLE * sum(r.duration_s for r in case.recordings):
        return tuple(tests)
    slow = {name for name, effect in catalogued().items() if effect.drifts}
    why = "the record is so long that it is looked at in windows, and this goes on for longer than a window"
    return tuple(EffectTest(t.name, False, why, t.parameter) if t.name in slow else t for t in tests)


def _nuisance(channel: Channel, base: Plant, scales: Scales) -> FloatArray:
    """What small changes of the design numbers do, shape (n, numbers)."""
    space = make_space(base, (), channel.numbers, scales)
    z = np.zeros(len(space.unknowns))

    def residuals(at: FloatArray) -> FloatArray:
        return channel.residuals(space.plant(at))

    return np.asarray(jacobian(residuals, z, residuals(z), space.steps, space.upper))


def _best_form(detector: Detector, effect: Effect, tried: Sequence[Form]) -> EffectTest:
    """The middle one of an effect's forms, by the share of its plausible range that shows; of those that stand trial.

    Nobody knows which of them a fault takes. The one that shows first would promise too much: a single jump of the
    stem shows at a twentieth of the breakaway that sticks and slips.
    """
    found = [
        (limit, form, main)
        for form in tried
        if not form.outside and (main := _main(form)) is not None
        for limit in [_form_limit(detector, effect, form, main)]
    ]
    found = sorted((one for one in found if one[0] < np.inf), key=lambda one: one[0] / _reach(one[2]))
    limit, form, main = found[len(found) // 2] if found else (np.inf, None, None)
    if main is None or form is None or limit == np.inf:
        return EffectTest(effect.name, False, "this record does not excite it")
    if limit > _reach(main):
        return EffectTest(effect.name, False, "even its largest plausible size would not have shown", main.name)
    value = (main.neutral + _side(main) * limit if main.neutral else limit) * detector.scales.factor(main.kind)
    return EffectTest(effect.name, True, "", main.name, value, detector.scales.unit(main.kind), form.name)


def _form_limit(detector: Detector, effect: Effect, form: Form, main: Parameter) -> float:
    """Smallest distance from neutral that shows [reference units]; beyond the range, or infinite, where none does."""
    base = detector.base
    present = next((one for one in base.inserted if one.effect == effect.name), None)
    if present is not None and present.form.name != form.name:
        return float("inf")

    def shown(size: float) -> float:
        values = _sized(form, main, main.neutral + _side(main) * size, present, detector.scales)
        return detector.shown(base.having([Inserted(effect.name, form, values)]), detector.nuisance)

    if shown(_NOTHING * _reach(main)) > _NOTHING_SHOWS:
        return float("inf")  # it is not the size that shows
    first = min(abs(s - main.neutral) for s in main.starts if s != main.neutral)
    return smallest_shown(shown, first, _reach(main))


def _of_number(detector: Detector, name: str, others: FloatArray) -> EffectTest:
    """How far a design number has to be off to show: upwards, or downwards where that shows nothing."""
    design = detector.base.design
    size = reference(design, name)

    def shown(relative: float) -> float:
        return _shows(detector, name, relative, others)

    limit = smallest_shown(shown, _FIRST_WRONG, _WRONG)
    most, room = _WRONG, nominal(design, name) / size
    if limit > most and room > _WRONG:  # a bound that was never met shows when it is lower
        most = _TOO_SMALL * min(room, 1.0)
        limit = smallest_shown(lambda relative: shown(-relative), _FIRST_WRONG, most)
    if limit > most:
        return EffectTest(f"parameter:{name}", False, "this record does not excite it", name)
    if limit < TOLERANCE:  # within it, a number is off only where that shows clearly
        clear = replace(detector, needed=max(detector.needed, (SLIGHT**2 - 1.0) * detector.channel.rows))
        limit = min(TOLERANCE, smallest_shown(lambda relative: _shows(clear, name, relative, others), limit, TOLERANCE))
    return EffectTest(f"parameter:{name}", True, "", name, limit * size, unit(design, name))


def _shows(detector: Detector, name: str, relative: float, others: FloatArray) -> float:
    """What a design number shows that is off by a share of its reference."""
    design = detector.base.design
    changed = retuned(design, {name: nominal(design, name) + relative * reference(design, name)})
    return detector.shown(Plant(changed, detector.base.inserted), others)


def smallest_shown(shown: Callable[[float], float], first: float, largest: float) -> float:
    """The smallest size with `shown(size)` about 1; above `largest` where it is not reached, infinite where nothing is.

    From `first`, by the power law through the last two sizes; `shown` grows about with the square of a size.
    """
    size = min(first, largest)
    low, high = (0.0, 0.0), (np.inf, np.inf)  # sizes that do not show, and that do
    order, last = 2.0, (0.0, 0.0)
    for _ in range(_STEPS):
        power = shown(size)
        if _NEAR[0] <= power <= _NEAR[1]:
            return size
        low, high = ((size, power), high) if power < 1.0 else (low, (size, power))
        if last[1] > 0.0 and power > 0.0 and last[0] != size:
            order = min(max(np.log(power / last[1]) / np.log(size / last[0]), 0.5), 4.0)
        last = (size, power)
        if low[0] >= largest:
            break
        guess = size * power ** (-1.0 / order) if power > 1e-12 else largest
        size = _between(guess, low[0], high[0], largest)
    if high[0] < np.inf:
        return high[0]
    return float("inf") if low[1] < 1e-6 else 2.0 * largest


def _between(guess: float, low: float, high: float, largest: float) -> float:
    """The guess, or the geometric middle where it lies outside of what is still open."""
    top = min(high, largest)
    if low < guess < top:
        return guess
    return float(np.sqrt(low * top)) if high < np.inf and low > 0.0 else 0.3 * top if high < np.inf else top


def _sized(form: Form, main: Parameter, size: float, present: Inserted | None, scales: Scales) -> tuple[float, ...]:
    """Values of the form at `size` of its main parameter, its other sizes nil, its shape at the first start.

    A form that the design has changes by as much.
    """
    if present is None:
        rest = {p.name: p.neutral if p.size else p.starts[0] for p in form.parameters}
        return tuple((rest | {main.name: size})[p.name] * scales.factor(p.kind) for p in form.parameters)
    change = (size - main.neutral) * scales.factor(main.kind)
    return tuple(v + change if p is main else v for p, v in zip(form.parameters, present.values, strict=True))


def _main(form: Form) -> Parameter | None:
    return next((p for p in form.parameters if p.size), None)


def _side(main: Parameter) -> float:
    """Which way from neutral the nearest start lies."""
    nearest = min((s for s in main.starts if s != main.neutral), key=lambda s: abs(s - main.neutral))
    return 1.0 if nearest > main.neutral else -1.0


def _reach(main: Parameter) -> float:
    """The largest plausible distance from neutral on that side."""
    return abs((main.upper if _side(main) > 0.0 else main.lower) - main.neutral)
