"""The registers of a tick, as a profile places them: the inverse of how the HAL reads them."""

from __future__ import annotations

import math
from collections.abc import Callable

from hal.profile import Profile
from hal.register import Register
from sim_device.pdu import COIL, DEVICE_FAILURE, HOLDING, INPUT, Refused
from sim_device.registers import Cell
from sim_device.rig import Rig

TABLES = {"coil": COIL, "holding": HOLDING, "input": INPUT}


def make_cell(
    profile: Profile,
    name: str,
    register: Register,
    read: Callable[[], float],
    write: Callable[[float], None] | None = None,
    accepts: Callable[[float], bool] = math.isfinite,
) -> Cell:
    """A cell that holds the quantity of `register` in its unit; the profile's scaling stands between it and the wire.

    What can be written is a holding register (or a coil), also where the device reads with function 4.
    """
    gain, offset = register.gain_offset()
    table = TABLES[profile.table_of(register)]
    tables = {table} if table == COIL or write is None else {table, HOLDING}

    def read_raw() -> float:
        try:
            return (read() - offset) / gain
        except (ArithmeticError, ValueError) as error:
            raise Refused(DEVICE_FAILURE) from error

    return Cell(
        name=name,
        address=profile.wire_address(register),
        read=read_raw,
        write=None if write is None else lambda raw: write(gain * raw + offset),
        accepts=lambda raw: accepts(gain * raw + offset),
        kind="bit" if table == COIL else register.type,
        order=register.word_order or profile.device_of(register).word_order,
        tables=frozenset(tables),
    )


def signal_cells(profile: Profile, rig: Rig, device: str) -> list[Cell]:
    """The cells of the signals that `device` has."""
    sources = _sources(profile, rig)
    cells = []
    for name, register in profile.signals.named().items():
        if profile.device_name(register) != device or _is_the_command_itself(profile, name, register):
            continue
        if name == "command":
            cells.append(_command_cell(profile, rig, register))
        else:
            cells.append(make_cell(profile, name, register, sources.get(name) or _no_value(register)))
    return cells


def _is_the_command_itself(profile: Profile, name: str, register: Register) -> bool:
    """Many modules are read back at the register that is written: one cell serves both."""
    command = profile.signals.command
    same_place = profile.wire_address(register) == profile.wire_address(command)
    same_device = profile.device_name(register) == profile.device_name(command)
    return name == "readback" and same_device and same_place and profile.table_of(register) == "holding"


def _command_cell(profile: Profile, rig: Rig, register: Register) -> Cell:
    """The transducer refuses (exception 3) what is outside its range; half a count of rounding is not outside."""
    limits, slack = profile.limits, 0.5 * register.resolution() + 1e-6
    return make_cell(
        profile,
        "command",
        register,
        lambda: rig.command,
        rig.request_command,
        lambda value: limits.command_min - slack <= value <= limits.command_max + slack,
    )


def _sources(profile: Profile, rig: Rig) -> dict[str, Callable[[], float]]:
    def sequence() -> float:
        rig.sample()  # a sequence number belongs to the sample of its own transaction
        kind = profile.signals.sequence.type if profile.signals.sequence else "u16"
        return float(rig.sequence & (0x7FFF if kind == "i16" else 0xFFFF))

    return {
        "readback": lambda: rig.command,
        "sequence": sequence,
        "pressure": lambda: rig.sample().pressure_psi,
        "position": lambda: profile.position_signal(rig.sample().position_in),
        "supply_psi": lambda: rig.sample().supply_psi,
        "temperature_c": lambda: rig.sample().temperature_c,
    }


def _no_value(register: Register) -> Callable[[], float]:
    """A channel that the virtual valve does not have says so: NaN, or the first sentinel, or 0 where there is none."""
    gain, offset = register.gain_offset()
    if register.type == "f32":
        return lambda: math.nan
    return lambda: gain * (register.sentinels[0] if register.sentinels else 0) + offset
