"""Opening a bench: a real one at a port, or a virtual valve in this process that is spoken to as if it were real.

The virtual valve sits behind a pseudo-terminal and answers Modbus frames; its time is stepped by the loop, so that a
20-minute sweep takes seconds. With `real_time` it takes 20 minutes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from app.options import plant_options, profile_of

if TYPE_CHECKING:
    from hal.clock import Clock
    from hal.profile import Profile
    from hal.safety import SafeBench
    from sim_device.sealed import Sealed
    from sim_device.valve import ValvePhysics

_PACE = {"real": "real time", "stepped": "its time stepped, faster than real"}
DEADMAN_S = 2.0  # a command so much overdue means that the program hangs: the valve goes to safety without it


@dataclass(frozen=True, slots=True)
class Session:
    """An open bench. `virtual` describes the virtual valve behind it as plain values; empty for a real bench."""

    bench: SafeBench
    clock: Clock
    profile: Profile
    virtual: Mapping[str, object]
    sealed: Sealed | None = None

    @property
    def aux_units(self) -> dict[str, str]:
        """The auxiliary channels of the profile and their units."""
        return {name: register.unit for name, register in self.profile.signals.aux.items()}

    @property
    def command_in_force(self) -> float:
        """The command that the valve has before the first tick."""
        held = getattr(self.bench.bench, "held_command", None)
        return self.bench.info.safe_command if held is None else float(held)

    @property
    def calibration_warning(self) -> str | None:
        """One sentence, where the positions that the bench will tell rest on an expired calibration."""
        from hal.clock import utc_now

        calibration = self.profile.calibration
        return None if calibration is None else calibration.warning(utc_now().date())

    @property
    def title(self) -> str:
        """The bench in a few words for the operator."""
        port = self.bench.info.port
        if not self.virtual:
            return f"bench '{self.profile.name}' on {port}"
        pace = _PACE[str(self.virtual["time"])]
        return f"the virtual valve ('{self.virtual['physics']}') behind {port}, Modbus RTU, {pace}"


@contextmanager
def open_bench(
    port: str | None = None,
    profile: str | Path | Profile | None = None,
    *,
    physics: str | None = None,
    seed: int = 0,
    options: Mapping[str, object] | None = None,
    effects: Sequence[str] = (),
    plant: Sequence[str] = (),
    real_time: bool = False,
    acknowledge: bool = False,
    sealed: str | None = None,
    families: Sequence[str] = ("thesis", "reference"),
) -> Iterator[Session]:
    """Opens the bench of a profile at `port`; without one, a virtual valve with plant `physics`.

    `options` go to the plant (`effects={"stiction": 0.4}`, `noise=0.0`, its design numbers); `effects` and `plant` are
    more of them as words, "stiction=0.4" and "compliance=0.18". `sealed` draws plant and
    faults from a seed, out of `families`.
    However the context is left, the valve is at its safe command and the port is closed.
    Raises: `BadInput`, `PortFault`, `WireFault`, `SafetyTrip`.
    """
    from hal.errors import BadInput

    found = profile_of(profile, physics)
    if port is not None:
        if physics or options or real_time or effects or plant or sealed:
            raise BadInput(
                "--physics, --effect, --plant, --sealed and --real-time belong to the virtual valve; "
                "leave them out with --port"
            )
        with _at_port(found, port, acknowledge) as session:
            yield session
        return
    asked = {**(options or {}), **plant_options(effects, plant)}
    if sealed is not None:
        if physics or asked:
            raise BadInput(
                "--sealed draws the valve and what is wrong with it; leave out --physics, --effect and --plant"
            )
        with _sealed(found, sealed, families, real_time) as session:
            yield session
        return
    with _virtual(found, physics, seed, asked, real_time) as session:
        yield session


@contextmanager
def _at_port(profile: Profile, port: str, acknowledge: bool) -> Iterator[Session]:
    from hal.clock import RealClock
    from hal.latch import Latch
    from hal.modbus_bench import ModbusBench
    from hal.reopen import Reopening
    from hal.safety import SafeBench

    clock, latch = RealClock(), Latch.of_port(port)
    if acknowledge:
        latch.acknowledge()
    reopening = Reopening(say=partial(click.echo, err=True))
    inner = ModbusBench(profile, port, clock, acknowledge=acknowledge, reopening=reopening)
    with _said(SafeBench(inner, profile.limits, clock, latch=latch, deadman_s=DEADMAN_S)) as bench:
        yield Session(bench, clock, profile, {})


@contextmanager
def _said(safe_bench: SafeBench) -> Iterator[SafeBench]:
    """A bench that, when something ends the job early, says where it has left the valve: in a note for the roof."""
    try:
        with safe_bench as bench:
            yield bench
    except BaseException as error:
        where = safe_bench.where
        if safe_bench.sent is not None and where.partition(",")[0] not in str(error):
            error.add_note(where)
        raise


@contextmanager
def _sealed(profile: Profile, seed: str, families: Sequence[str], real_time: bool) -> Iterator[Session]:
    from sim_device.sealed import draw

    drawn = draw(seed, families)
    said: dict[str, object] = {"physics": f"{drawn.family}, sealed", "commitment": drawn.commitment}
    with _served(profile, drawn.physics, said, real_time, drawn) as session:
        yield session


@contextmanager
def _virtual(
    profile: Profile, physics: str | None, seed: int, options: dict[str, object], real_time: bool
) -> Iterator[Session]:
    from sim_device.physics.catalog import make_physics

    name = physics or ("positioner" if profile.command_unit == "percent" else "thesis")
    said: dict[str, object] = {"physics": name, "seed": seed, "options": options}
    with _served(profile, make_physics(name, seed, **options), said, real_time) as session:
        yield session


@contextmanager
def _served(
    profile: Profile, plant: ValvePhysics, said: dict[str, object], real_time: bool, sealed: Sealed | None = None
) -> Iterator[Session]:
    """Puts a plant behind Modbus frames on a pseudo-terminal and opens the bench there."""
    from app.slow import STARTING, say_if_slow
    from hal.clock import RealClock, SteppedClock
    from hal.modbus_bench import ModbusBench
    from hal.safety import SafeBench
    from sim_device.server import VirtualDevice

    clock: Clock = RealClock() if real_time else SteppedClock()
    said = {**said, "time": "real" if real_time else "stepped"}
    with say_if_slow(STARTING):
        served = VirtualDevice(profile, plant, clock)
    with served as device:
        # A pseudo-terminal has no bits on a wire, so there is no silence to keep between frames.
        inner = ModbusBench(profile, device.port, clock, pacing="none", margin_s=2.0)
        with _said(SafeBench(inner, profile.limits, clock)) as bench:
            yield Session(bench, clock, profile, said, sealed)
