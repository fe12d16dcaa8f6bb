"""What a profile says of its bench, before anybody has spoken to it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from hal.bench import BenchInfo
from hal.profile import Profile
from hal.tick import min_period_s, plan_tick

_NOT_ASKED: Mapping[str, str] = MappingProxyType({})


def info_of(profile: Profile, port: str = "", identity: Mapping[str, str] = _NOT_ASKED) -> BenchInfo:
    """What a profile says of its bench, whether or not it is there.

    `identity`: what the device at `port` has said of itself.
    """
    limits = profile.limits
    return BenchInfo(
        name=profile.name,
        port=port,
        command_unit=profile.command_unit,
        command_min=limits.command_min,
        command_max=limits.command_max,
        safe_command=profile.safe_command,
        travel_in=profile.travel_in,
        min_period_s=min_period_s(plan_tick(profile), profile),
        has_pressure=profile.signals.pressure is not None,
        identity=dict(identity),
        profile=profile.model_dump(mode="json", exclude_none=True),
    )
