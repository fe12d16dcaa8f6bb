"""What the parts of a profile have to do with each other. Raises (all functions): `ValueError`, one sentence each."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from hal.register import Register
from hal.words import RANGE

if TYPE_CHECKING:
    from hal.profile import Profile

_HIGHEST = 65535  # on the wire
_FAR = 10.0  # so many times what is there to see: a travel in mm is 25 times that in inches
_COMMAND_UNITS = ("", "psi", "percent")
#: What a record has under these names is no further channel's (`control/row.py`).
RESERVED = frozenset(
    (
        *("time_s", "command_psi", "command_percent", "next_command_psi", "next_command_percent", "pressure_psi"),
        *("position_in", "target_in", "lateness_s", "latency_s", "quality", "pressure_quality", "sequence", "step"),
        *("command", "readback", "pressure", "position"),
    )
)
_BESIDE = "twin_"  # columns of a model that runs beside the bench begin so


def check_registers(profile: Profile) -> None:
    """Every register is on a device that there is, at an address that there is, and at no other's."""
    taken: dict[tuple[str, str, int], str] = {}
    for place, register in profile.every_register().items():
        _check_register(profile, place, register)
        for key in _keys(profile, place, register):
            other = taken.setdefault(key, place)
            # Many modules are read back at the register that is written.
            if other != place and {other, place} != {"signals.command", "signals.readback"}:
                raise ValueError(
                    f"{place} and {other} share the register at address {register.address}; give each its own"
                )


def _keys(profile: Profile, place: str, register: Register) -> Iterator[tuple[str, str, int]]:
    """Where the register is, word by word. What is written is a holding register, or a coil, whatever is read."""
    written = place == "signals.command" or place.startswith("devices.")
    table = (register.table or "holding") if written else profile.table_of(register)
    for offset in range(register.words):
        yield profile.device_name(register), table, profile.wire_address(register) + offset


def _check_register(profile: Profile, place: str, register: Register) -> None:
    if register.device not in profile.devices and (register.device or len(profile.devices) > 1):
        raise ValueError(f"{place}.device '{register.device}' is not one of {', '.join(profile.devices)}")
    _check_table(place, register)
    base = profile.device_of(register).address_base
    if register.address < base:
        raise ValueError(f"{place}.address 0 does not exist on a device with address_base = 1")
    highest = _HIGHEST + base - register.words + 1
    if register.address > highest:
        raise ValueError(
            f"{place}.address {register.address} does not exist: with address_base = {base} a {register.type} ends at "
            f"{highest} at the latest"
        )


def _check_table(place: str, register: Register) -> None:
    """An input register cannot be written, and one bit is no measurement. A watchdog's status may be read only."""
    signal = place.startswith("signals.")
    only_read = place.endswith(".watchdog.status") or (signal and place != "signals.command")
    if register.table == "input" and not only_read:
        raise ValueError(f"{place}.table is 'input', which nobody can write to; give a register in table = \"holding\"")
    if register.table == "coil" and signal:
        raise ValueError(f"{place}.table is 'coil', which holds one bit; a signal needs a register, holding or input")


def check_command(profile: Profile) -> None:
    """The command comes in a unit that the program knows, and its register carries the whole range of the limits."""
    command, limits = profile.signals.command, profile.limits
    readback = profile.signals.readback
    if command.unit not in _COMMAND_UNITS:
        raise ValueError(f"signals.command.unit is '{command.unit}': it must be psi or percent; let eng say those")
    if readback is not None and readback.unit and readback.unit != profile.command_unit:
        raise ValueError(f"signals.readback.unit is '{readback.unit}', the command is in {profile.command_unit}")
    for name, end in (("command_min", limits.command_min), ("command_max", limits.command_max)):
        _check_within(profile, name, end)
        try:
            command.to_words(end, "ABCD")
        except ValueError as error:
            raise ValueError(f"signals.command cannot carry the command limit {end:g}: {error}") from error


def _check_within(profile: Profile, name: str, limit: float) -> None:
    """A converter's raw values end where its range ends; a float's two points only say how units are converted."""
    command, unit = profile.signals.command, profile.command_unit
    if not math.isnan(limit) and (ends := _ends_before(command, limit)) is not None:
        low, high = ends
        raise ValueError(
            f"limits.{name} {limit:g} {unit} is beyond signals.command, {low:g} to {high:g} {unit}; change the limit, "
            "or give raw and eng at the ends of the range"
        )


def check_watchdogs(profile: Profile) -> None:
    """A watchdog that is told less time than its register can say would be off, and nobody would know."""
    for name, device in profile.devices.items():
        watchdog = device.watchdog
        if watchdog is None:
            continue
        place = f"devices.{name}.watchdog"
        if watchdog.timeout is not None:
            _check_carried(watchdog.timeout, watchdog.timeout_s, f"{place}.timeout_s {watchdog.timeout_s:g} s")
            if watchdog.timeout_s < watchdog.timeout.resolution():
                raise ValueError(
                    f"{place}.timeout_s {watchdog.timeout_s:g} s is less than a count of its register, "
                    f"{watchdog.timeout.resolution():g} s, which may switch the watchdog off; give at least that"
                )
        if watchdog.safe_value is not None:
            _check_carried(watchdog.safe_value, profile.safe_command, f"safe_command {profile.safe_command:g}")


def _check_carried(register: Register, value: float, what: str) -> None:
    """Raises: `ValueError` where the register cannot hold a value, or its raw and eng end before that."""
    try:
        register.to_words(value, "ABCD")
    except ValueError as error:
        raise ValueError(f"{what} does not go into its register: {error}") from error
    if (ends := _ends_before(register, value)) is not None:
        raise ValueError(f"{what} is beyond its register, {ends[0]:g} to {ends[1]:g}; change it, or raw and eng")


def _ends_before(register: Register, value: float) -> tuple[float, float] | None:
    """The range of a register whose raw and eng end before a value; None where they do not, or are no ends."""
    if register.raw is None or register.type == "f32":
        return None
    low, high = sorted(register.value(raw) for raw in register.raw)
    slack = 0.5 * register.resolution()
    return None if low - slack <= value <= high + slack else (low, high)


def check_pressure(profile: Profile) -> None:
    """Where the command is a pressure, a bench at its safe command must be below the limit of pressure."""
    most, safe = profile.limits.pressure_max_psi, profile.safe_command
    if most is not None and profile.command_unit == "psi" and most < safe:
        raise ValueError(
            f"limits.pressure_max_psi {most:g} is below safe_command {safe:g} psi, at which a run would be stopped; "
            "raise it, or lower that"
        )


def check_travel(profile: Profile) -> None:
    """Nothing sees or allows the tenth part of the travel: it is in another unit."""
    for place, low, high in _seen(profile):
        times = profile.travel_in / abs(high - low)
        if times > _FAR:
            raise ValueError(
                f"travel_in {profile.travel_in:g} is {times:.3g} times the range of {place}, {min(low, high):g} to "
                f"{max(low, high):g} in; give it in inches, or correct that range"
            )


def _seen(profile: Profile) -> Iterator[tuple[str, float, float]]:
    """What a profile says of positions [in], and where. Two points of a register are no ends: its type has those."""
    limits, register = profile.limits, profile.signals.position
    if limits.position_min_in is not None and limits.position_max_in is not None:
        yield "limits.position_min_in to position_max_in", limits.position_min_in, limits.position_max_in
    if profile.calibration is not None:
        points = profile.calibration.points
        yield "calibration.points", points[0][1], points[-1][1]
    if register.type != "f32":
        low, high = (profile.position_in(register.value(raw)) for raw in RANGE[register.type])
        yield "signals.position", low, high


def check_channels(profile: Profile) -> None:
    """Further channels have names of their own in a record."""
    for name in profile.signals.aux:
        if name in RESERVED or name.startswith(_BESIDE):
            raise ValueError(f"signals.aux.{name}: a record has a column of that name already; choose another name")
