"""A valve simple enough to know by heart, and devices around it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from hal.clock import SteppedClock
from hal.profile import Profile, load_profile
from sim_device.server import VirtualDevice
from sim_device.valve import Outputs


class LinearValve:
    """Pressure is the command in force, position a hundredth of it; remembers everything it was told."""

    def __init__(self) -> None:
        self.told: list[tuple[float, float]] = []

    def advance(self, to_time_s: float, command: float) -> Outputs:
        self.told.append((to_time_s, command))
        return Outputs(pressure_psi=command, position_in=command / 100.0, supply_psi=80.0, temperature_c=21.5)


@pytest.fixture
def valve() -> LinearValve:
    return LinearValve()


@pytest.fixture
def clock() -> SteppedClock:
    return SteppedClock(100.0)


@pytest.fixture(scope="session")
def profile() -> Profile:
    return load_profile("virtual")


Start = Callable[..., VirtualDevice]


@pytest.fixture
def start(profile: Profile, valve: LinearValve, clock: SteppedClock) -> Iterator[Start]:
    """Starts virtual devices that are closed when the test ends."""
    with ExitStack() as stack:
        yield lambda **options: stack.enter_context(
            VirtualDevice(options.pop("profile", profile), valve, clock, **options)
        )
