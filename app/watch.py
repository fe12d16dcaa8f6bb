"""Opening a bench only to look at it: nothing is written, on entering and leaving neither."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

import click

from app.options import plant_options, profile_of

if TYPE_CHECKING:
    from hal.clock import Clock
    from hal.modbus_bench import ModbusBench
    from hal.profile import Profile
    from sim_device.server import VirtualDevice


@contextmanager
def open_to_look(
    port: str | None = None,
    profile: str | Profile | None = None,
    *,
    physics: str | None = None,
    seed: int = 0,
    effects: Sequence[str] = (),
    plant: Sequence[str] = (),
    real_time: bool = True,
) -> Iterator[tuple[ModbusBench, Clock]]:
    """The bench of a profile at `port`; without one, a virtual valve, whose time may be stepped.

    Raises: `BadInput`, `PortFault`, `WireFault`, `BenchFault`.
    """
    from hal.clock import RealClock, SteppedClock
    from hal.errors import BadInput
    from hal.modbus_bench import ModbusBench
    from hal.reopen import Reopening

    found = profile_of(profile, physics)
    if port is not None:
        if physics or effects or plant:
            raise BadInput("--physics, --effect and --plant belong to the virtual valve; leave them out with --port")
        clock: Clock = RealClock()
        reopening = Reopening(say=partial(click.echo, err=True))
        with ModbusBench(found, port, clock, read_only=True, reopening=reopening) as bench:
            yield bench, clock
        return
    clock = RealClock() if real_time else SteppedClock()
    with (
        _virtual(found, physics, seed, plant_options(effects, plant), clock) as device,
        ModbusBench(found, device.port, clock, pacing="none", margin_s=2.0, read_only=True) as bench,
    ):
        yield bench, clock


def _virtual(
    profile: Profile, physics: str | None, seed: int, options: dict[str, object], clock: Clock
) -> VirtualDevice:
    from app.slow import STARTING, say_if_slow
    from sim_device.physics.catalog import make_physics
    from sim_device.server import VirtualDevice

    name = physics or ("positioner" if profile.command_unit == "percent" else "thesis")
    with say_if_slow(STARTING):
        return VirtualDevice(profile, make_physics(name, seed, **options), clock)
