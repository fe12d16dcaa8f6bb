"""Which causes stand trial on a channel: the design numbers of its stages and every effect of its stages."""

from __future__ import annotations

from collections.abc import Collection

from twin.catalog import effects
from twin.fit.channel import Channel
from twin.fit.space import Cause


def number_causes(channel: Channel) -> list[Cause]:
    """The design numbers of the channel as causes."""
    return [Cause(f"parameter:{name}") for name in channel.numbers]


def effect_causes(channel: Channel, without: Collection[str] = ()) -> list[Cause]:
    """Every effect of the channel's stages in every form that acts on the trajectory, except those in `without`."""
    several = len(channel.trials) > 1
    return [
        Cause(effect.name, effect, form)
        for effect in effects().values()
        if effect.stage in channel.stages and effect.name not in without and effect.evidence == "trajectory"
        for form in effect.forms
        if not (form.once and several)
    ]
