"""A channel whose readings are so coarse that each says an interval (see `twin.noise.coarse`)."""

from __future__ import annotations

from dataclasses import replace

from twin.fit.case import Case
from twin.fit.channel import Channel


def in_steps(case: Case, channel: Channel) -> Channel:
    """The channel with intervals for readings, where the position is coarse; as it is elsewhere."""
    steps = case.coarse
    return channel if steps is None else replace(channel, sigma=steps.beyond, half=steps.half)
