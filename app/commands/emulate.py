"""Run the virtual Modbus device on a pseudo-terminal or a socket, until stopped."""

from __future__ import annotations

import json
import signal
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

import click

from app.options import plant_options
from hal.errors import BadInput

if TYPE_CHECKING:
    from hal.clock import Clock
    from sim_device.device import Options
    from sim_device.server import VirtualDevice
    from sim_device.valve import ValvePhysics


@click.command()
@click.option("--port-link", type=click.Path(path_type=Path), help="Stable name for the pseudo-terminal.")
@click.option("--tcp", metavar="HOST:PORT", help="Listen with Modbus TCP, or with rtu+tcp://HOST:PORT for RTU frames.")
@click.option("--profile", "profile_name", default="virtual", show_default=True, help="Profile name or .toml file.")
@click.option("--physics", metavar="NAME", help="The valve behind the registers.  [default: what the profile commands]")
@click.option("--effect", "effects", multiple=True, metavar="NAME=SIZE", help="Something wrong with the valve.")
@click.option("--plant", multiple=True, metavar="NAME=VALUE", help="Design number of the valve, compliance=0.18.")
@click.option("--time", "time_kind", type=click.Choice(["real", "stepped"]), default="real", show_default=True,
              help="Stepped: virtual time, moved by the master through the simulation registers.")  # fmt: skip
@click.option("--fault", "faults", multiple=True, metavar="NAME=FRACTION",
              help="Bad line: late=0.05:0.9-3.5, noise_before=0.05, bit_flip=0.03, drop, truncate, wrong_unit, "
              "wrong_function, exception=0.01:6x20, noise_after, local_echo. Modbus TCP: wrong_transaction too, and "
              "no noise, flips or echo.")  # fmt: skip
@click.option("--fault-timeout", type=click.FloatRange(min=0, min_open=True), default=0.1, show_default=True,
              help="The timeout [s] that late replies are measured in.")  # fmt: skip
@click.option("--pace", type=click.IntRange(min=300), metavar="BAUD", help="Let every byte take its time on the wire.")
@click.option("--refresh", type=click.FloatRange(min=0), default=0.0, show_default=True,
              help="Conversion period of the DAQ [s]; 0 converts for every request.")  # fmt: skip
@click.option("--seed", type=int, default=0, show_default=True, help="Of the sensor noise and of the faults.")
@click.option("--sealed", metavar="SEED", help="A valve with something, or nothing, wrong with it: drawn, not told.")
@click.option("--commitment", type=click.Path(path_type=Path), help="Where to write the hash of what was drawn.")
@click.option("--json", "as_json", is_flag=True, help="Print where it listens as one line of JSON.")
def command(
    port_link: Path | None,
    tcp: str | None,
    profile_name: str,
    physics: str | None,
    effects: tuple[str, ...],
    plant: tuple[str, ...],
    time_kind: str,
    faults: tuple[str, ...],
    fault_timeout: float,
    pace: int | None,
    refresh: float,
    seed: int,
    sealed: str | None,
    commitment: Path | None,
    as_json: bool,
) -> None:
    """Run the virtual Modbus device on a pseudo-terminal or a socket, until stopped.

    It prints the port that a master opens; the registers lie where the profile puts them (docs/register-map.md).
    """
    from app.slow import STARTING, say_if_slow
    from hal.profile import load_profile
    from sim_device.faults import parse_faults
    from sim_device.server import VirtualDevice

    profile = load_profile(profile_name)
    if sealed is not None:
        valve, said = _sealed(sealed, commitment, bool(physics or effects or plant))
    else:
        valve, said = _open(physics or _usual(profile.command_unit), plant_options(effects, plant), seed)
    bad, options = parse_faults(faults, seed=seed, timeout_s=fault_timeout), _options(refresh, time_kind)
    with say_if_slow(STARTING):
        device = VirtualDevice(
            profile, valve, _clock(time_kind), link=port_link, tcp=tcp, faults=bad, pace_baud=pace, options=options
        )
    _serve(device, said | {"profile": profile_name, "units": sorted(device.units)}, as_json)


def _sealed(seed: str, commitment: Path | None, chosen: bool) -> tuple[ValvePhysics, dict[str, str]]:
    """The valve, and what may be said about it; the commitment is written before anything listens.

    Raises: `BadInput` when the operator has `chosen` a plant or an effect besides.
    """
    from app.targets import check_file
    from sim_device.sealed import FILE_NAME, draw, write

    if chosen:
        raise BadInput("--sealed draws the valve and what is wrong with it; leave out --physics, --effect and --plant")
    drawn = draw(seed)
    if commitment is not None:
        check_file("--commitment", commitment / FILE_NAME if commitment.is_dir() else commitment)
        write(commitment, drawn)
    return drawn.physics, {"physics": f"{drawn.family}, sealed", "commitment": drawn.commitment}


def _clock(time_kind: str) -> Clock:
    from hal.clock import RealClock, SteppedClock

    return SteppedClock() if time_kind == "stepped" else RealClock()


def _options(refresh_s: float, time_kind: str) -> Options:
    from sim_device.device import Options

    return Options(refresh_s=refresh_s, simulation_block=time_kind == "stepped")


def _usual(command_unit: str) -> str:
    return "positioner" if command_unit == "percent" else "thesis"


def _open(physics: str, options: Mapping[str, object], seed: int) -> tuple[ValvePhysics, dict[str, str]]:
    """The valve as the operator wants it, and its name.

    Raises: `BadInput` for a plant, an effect or a size that does not exist.
    """
    from sim_device.physics.catalog import make_physics

    return make_physics(physics, seed, **options), {"physics": physics}


def _serve(device: VirtualDevice, said: Mapping[str, object], as_json: bool) -> None:
    stop = threading.Event()

    def end(_number: int, _frame: FrameType | None) -> None:
        stop.set()

    before = {number: signal.signal(number, end) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        with device:
            _announce(device, said, as_json)
            while not stop.wait(timeout=0.5):  # wakes, so that a signal is seen on every platform
                pass
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _announce(device: VirtualDevice, said: Mapping[str, object], as_json: bool) -> None:
    port, url = device.port, device.tcp_url
    if as_json:
        click.echo(json.dumps({"port": port, "tcp": url or None, **said}))
    else:
        places = " and ".join(dict.fromkeys(place for place in (port, url) if place))
        units = ", ".join(str(unit) for unit in device.units)
        click.echo(f"virtual valve ({said['physics']}) with profile {said['profile']}, unit {units}, on {places}")
        if "commitment" in said:
            click.echo(f"commitment: {said['commitment']}")
        click.echo(f"try: lostmotion check --port {port} --profile {said['profile']}    (Ctrl-C stops it)")
    sys.stdout.flush()
