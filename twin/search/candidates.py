"""Which causes stand trial on a channel: the design numbers of its stages and every effect of its stages."""

from __future__ import annotations

from twin.fit.channel import Channel
from twin.fit.space import Cause
from twin.kernels.sensor_slots import S_SEEN
from twin.model.catalog import effects
from twin.model.effect import Effect, Form
from twin.model.plant import Inserted, Plant

#: What makes a reading that rounds down, in `twin/ready/rounding.py`.
ROUNDS_BY = "lvdt_calibration"


def number_causes(channel: Channel) -> list[Cause]:
    """The design numbers of the channel as causes."""
    return [Cause(f"parameter:{name}") for name in channel.numbers]


def effect_causes(channel: Channel, base: Plant | None = None) -> list[Cause]:
    """Every effect of the channel's stages in every form that acts on the trajectory.

    An effect of the `base` plant stands trial only if the design's file brought it, and in the file's form: it may have
    changed. What was inserted for the record's sake (a late sample) is settled, but for the zero of a reading that
    rounds down: whatever else is wrong with the calibration is beside that.
    """
    records = max((trial.place.of for trial in channel.trials), default=1)
    several = len(channel.trials) > 1
    broken = any(trial.place.broken for trial in channel.trials)
    settled = base is not None and bool(base.coefficients(0.0).sensor[S_SEEN])
    refreshed = not settled and all(trial.fresh is not None for trial in channel.trials)
    return [
        Cause(effect.name, effect, form, values)
        for effect in effects().values()
        if effect.stage in channel.stages and effect.evidence == "trajectory"
        for form, values in _forms(effect, base)
        if not (form.once and several)
        and (not form.apart or 2 <= records <= form.apart)
        and (broken or not form.anew)
        and (refreshed or not form.seen)
        and not form.described
        and (channel.name == "pressure" or not form.by_pressure)
    ]


def _forms(effect: Effect, base: Plant | None) -> list[tuple[Form, tuple[float, ...]]]:
    """The forms on trial, with the values that the design gives them already."""
    present = None if base is None else next((one for one in base.inserted if one.effect == effect.name), None)
    if base is None or present is None:
        return [(form, ()) for form in effect.forms]
    if effect.name in base.design.effects:
        return [(present.form, tuple(present.values))] if any(p.size for p in present.form.parameters) else []
    return _with_zero(effect, present) if effect.name == ROUNDS_BY else []


def _with_zero(effect: Effect, present: Inserted) -> list[tuple[Form, tuple[float, ...]]]:
    """The forms that can have the zero that is `present`, with it."""
    zero = dict(zip((p.name for p in present.form.parameters), present.values, strict=True))
    able = [form for form in effect.forms if zero.keys() <= {p.name for p in form.parameters}]
    return [(form, tuple(zero.get(p.name, p.neutral) for p in form.parameters)) for form in able]
