"""What a record could have shown: per effect the smallest size that would have been accepted, or why none would.

The response to a small size is projected off the design numbers' responses (re-tuning would hide that part); what is
left must reach the evidence and the gain that the decision asks for.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import FloatArray
from twin.choose.decide import DecisionRules
from twin.diagnosis import EffectTest
from twin.effect import Effect, Form, Parameter, Scales
from twin.fit.channel import Channel
from twin.fit.least_squares import jacobian
from twin.fit.space import make_space
from twin.plant import Inserted, Plant


def detection_limits(
    channels: Sequence[Channel], base: Plant, scales: Scales, effects: Sequence[Effect], rules: DecisionRules
) -> tuple[EffectTest, ...]:
    """One line per effect, in the order given; effects of stages that no channel judges are not testable."""
    lines = []
    for channel in channels:
        nuisance = _nuisance(channel, base, scales)
        for effect in effects:
            if effect.stage in channel.stages and effect.evidence == "trajectory":
                lines.append(_best_form(channel, base, scales, effect, nuisance, rules))
    return tuple(sorted(lines, key=lambda line: line.name))


def _nuisance(channel: Channel, base: Plant, scales: Scales) -> FloatArray:
    """Orthonormal basis of what re-tuning the design numbers can do, shape (n, numbers)."""
    space = make_space(base, (), channel.numbers, scales)
    z = np.zeros(len(space.unknowns))

    def residuals(at: FloatArray) -> FloatArray:
        return channel.residuals(space.plant(at))

    basis, _ = np.linalg.qr(jacobian(residuals, z, residuals(z), space.steps, space.upper))
    return np.asarray(basis)


def _best_form(
    channel: Channel, base: Plant, scales: Scales, effect: Effect, nuisance: FloatArray, rules: DecisionRules
) -> EffectTest:
    limits = [(_limit(channel, base, scales, effect, form, nuisance, rules), form) for form in effect.forms]
    limit, form = min(limits, key=lambda pair: pair[0])
    main = _main(form)
    if main is None or not np.isfinite(limit):
        return EffectTest(effect.name, False, "this record does not excite it")
    factor = scales.factor(main.kind)
    largest = max(abs(main.upper - main.neutral), abs(main.lower - main.neutral)) * factor
    if limit > largest:
        return EffectTest(effect.name, False, "even its largest plausible size would not have shown", main.name)
    return EffectTest(effect.name, True, "", main.name, limit, scales.unit(main.kind))


def _limit(
    channel: Channel,
    base: Plant,
    scales: Scales,
    effect: Effect,
    form: Form,
    nuisance: FloatArray,
    rules: DecisionRules,
) -> float:
    """Smallest size in record units; infinite where the response is nil."""
    main, present = _main(form), next((one for one in base.inserted if one.effect == effect.name), None)
    if main is None or (present is not None and present.form.name != form.name):
        return float("inf")
    sizes = sorted(
        form.parameters[0].starts if main is form.parameters[0] else main.starts, key=lambda s: abs(s - main.neutral)
    )
    plain = channel.residuals(base)
    for size in sizes:
        values = _sized(form, main, size, present, scales)
        changed = channel.residuals(base.having([Inserted(effect.name, form, values)]))
        change = changed - plain
        change -= nuisance @ (nuisance.T @ change)
        power = float(change @ change)
        needed = max(2.0 * rules.evidence, rules.gain * channel.rows)
        if power > 1e-6 * needed:
            return abs(size - main.neutral) * scales.factor(main.kind) * float(np.sqrt(needed / power))
    return float("inf")


def _sized(form: Form, main: Parameter, size: float, present: Inserted | None, scales: Scales) -> tuple[float, ...]:
    """Values of the form at `size` of its main parameter; a form that the design has changes by as much."""
    if present is None:
        return tuple((size if p is main else p.starts[0]) * scales.factor(p.kind) for p in form.parameters)
    change = (size - main.neutral) * scales.factor(main.kind)
    return tuple(v + change if p is main else v for p, v in zip(form.parameters, present.values, strict=True))


def _main(form: Form) -> Parameter | None:
    return next((p for p in form.parameters if p.size), None)
