"""What the registers mean: a profile becomes the units of a line, each with its map, its functions and its watchdog."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version

from hal.clock import Clock, SteppedClock
from hal.device import OBJECT_NAMES, Device
from hal.errors import BadInput
from hal.profile import Profile
from sim_device.diagnostics import Diagnostics
from sim_device.identity import Identity
from sim_device.line import Unit
from sim_device.pdu import Server
from sim_device.registers import BOTH, Cell, RegisterMap
from sim_device.rig import Rig
from sim_device.signals import signal_cells
from sim_device.watchdog import watchdog_cells

VIRTUAL_TIME = 0xF000  # first register of the simulation block; docs/register-map.md


@dataclass(frozen=True)
class Options:
    """What a profile does not say about the device. `refresh_s`: conversion period of the DAQ [s], 0 = every request.

    `simulation_block` adds the registers through which a master in another process moves virtual time.
    """

    refresh_s: float = 0.0
    simulation_block: bool = False


def build_units(profile: Profile, rig: Rig, clock: Clock, options: Options) -> dict[int, Unit]:
    """The units of the line by unit id.

    Raises: `BadInput` when the profile puts two numbers into one register, or virtual time is asked of a real clock.
    """
    units = {}
    for name, device in profile.devices.items():
        drives = profile.device_name(profile.signals.command) == name
        cells = signal_cells(profile, rig, name) + watchdog_cells(profile, rig if drives else None, name)
        cells += _identity_cells(device)
        cells += _neighbour_cells(device, cells)
        if options.simulation_block and drives:
            cells.append(_virtual_time_cell(clock))
        try:
            registers = RegisterMap(cells)
        except ValueError as error:
            raise BadInput(f"profile {profile.name}: device '{name}' cannot be laid out: {error}") from error
        diagnostics = Diagnostics()
        server = Server(registers, diagnostics, _objects(profile, device), max_read=device.max_read)
        for function in _missing_functions(device, cells):
            server.functions.pop(function, None)
        units[device.id] = Unit(server, diagnostics, _hearing(rig, drives))
    return units


def _hearing(rig: Rig, drives: bool) -> Callable[[], None]:
    return lambda: rig.heard(feeds_watchdog=drives)


def _missing_functions(device: Device, cells: list[Cell]) -> set[int]:
    """Real devices lack functions, and an emulated one must lack the same: they answer exception 1."""
    missing = set()
    if not device.fc23:
        missing.add(23)
    if device.write_fc == 6:
        missing |= {16, 22}
    if device.resync.method == "read":
        missing.add(8)
    if device.identity is not None and not device.identity.objects:
        missing.add(43)
    if not any(cell.kind == "bit" for cell in cells):
        missing |= {1, 5, 15}
    return missing


def _identity_cells(device: Device) -> list[Cell]:
    """The constant registers by which a master recognises the module."""
    identity = device.identity
    if identity is None or identity.address is None:
        return []
    first = identity.address - device.address_base
    return [
        Cell(f"identity.{index}", first + index, lambda word=word: float(word), tables=BOTH)  # type: ignore[misc]
        for index, word in enumerate(identity.expect)
    ]


def _neighbour_cells(device: Device, cells: list[Cell]) -> list[Cell]:
    """The other channels of a module, all 0: a master may read across them to find out whether the line is clean."""
    if device.resync.method != "read":
        return []
    taken = {(table, cell.address + i) for cell in cells for table in cell.tables for i in range(cell.size)}
    first = max(0, device.resync.address - device.address_base)
    return [
        Cell(f"neighbour.{at}", at, lambda: 0.0, tables=frozenset({table}))
        for at in range(first, first + device.resync.count)
        for table in BOTH
        if (table, at) not in taken
    ]


def _objects(profile: Profile, device: Device) -> Identity:
    """The profile's objects, and the three that every device must have."""
    objects = {0: "Lost Motion", 1: profile.name.upper(), 2: version("lostmotion")}
    named = device.identity.objects if device.identity is not None else {}
    return Identity(objects | {OBJECT_NAMES[name]: text for name, text in named.items()})


def _virtual_time_cell(clock: Clock) -> Cell:
    """Virtual time [us] in 4 registers, high word first: read it, or write a later one to move the valve on."""
    if not isinstance(clock, SteppedClock):
        raise BadInput("the simulation registers move virtual time, and this device runs in real time: use stepped")
    return Cell(
        "virtual_time_us",
        VIRTUAL_TIME,
        lambda: 1e6 * clock.now_s(),
        lambda raw: clock.sleep_until(1e-6 * raw),
        kind="u64",
    )
