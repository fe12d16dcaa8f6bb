"""From raw columns to a checked `Recording`: times first, then each signal, then what they say together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from hal.errors import BadInput
from logs import quality, times
from logs.recording import CommandTiming, DataNote, FloatArray, Recording
from logs.roles import Role
from logs.units import Conversion


def row_name(row: int) -> str:
    """How people call row `row` (from 0) of an array."""
    return f"row {row + 1}"


@dataclass(frozen=True, slots=True)
class Signals:
    """Raw columns of one length, how each becomes house units, and how the file calls it.

    `unsaid` are the roles whose unit the file does not state; `quality` holds flag columns of our own records.
    """

    values: Mapping[Role, FloatArray]
    conversions: Mapping[Role, Conversion]
    headers: Mapping[Role, str]
    unsaid: tuple[Role, ...] = ()
    notes: tuple[DataNote, ...] = ()
    locate: Callable[[int], str] = row_name
    quality: Mapping[str, FloatArray] = field(default_factory=dict)


def assemble(
    signals: Signals, *, name: str, where: str, command_timing: CommandTiming, meta: Mapping[str, object]
) -> Recording:
    """Raises: `BadInput` for times that go backward, a signal without a value, or units that do not go together."""
    _check_units(signals, where)
    notes = [*signals.notes, *_unit_notes(signals)]
    when = _times(signals, where, notes)
    cut = _Cutter(signals, when)
    for column, values in signals.quality.items():
        notes += quality.flags(column, values[when.keep], when.keep)
    command = _command(cut, where, notes)
    position = _position(cut, where, notes)
    pressure = _pressure(cut, quality.constant(command), notes)
    target = cut("target") if "target" in signals.values else None
    time_s = times.merge_doubles(when.time_s, when.time_s, average=False) if when.doubled else when.time_s
    gap_before = times.gaps(time_s)
    notes += times.timing_notes(time_s, gap_before)
    if command_timing == "after":
        command = np.concatenate((command[:1], command[:-1]))
        notes.append(DataNote("commands take effect after their row", "moved to the row after", command.size))
    return Recording(
        name=name,
        time_s=time_s,
        command=command,
        position=position,
        pressure=pressure,
        target=None if target is None or not np.isfinite(target).any() else target,
        pressure_unit=signals.conversions["command"].unit,
        position_unit=signals.conversions["position"].unit,
        command_timing="unknown" if command_timing == "unknown" else "before",
        gap_before=gap_before,
        notes=tuple(notes),
        meta=meta,
    )


class _Cutter:
    """Hands out a signal in house units for the rows that have a time."""

    def __init__(self, signals: Signals, when: times.Times) -> None:
        self.signals = signals
        self.when = when
        starts = np.concatenate(([True], np.diff(when.time_s) > 0)) if when.doubled else slice(None)
        self.rows = when.keep[starts]

    def __call__(self, role: Role) -> FloatArray:
        values = self.signals.values[role][self.when.keep]
        if self.when.doubled:
            values = times.merge_doubles(self.when.time_s, values, average=role in ("pressure", "position"))
        how = self.signals.conversions[role]
        return np.asarray(values * how.scale + how.shift, dtype=np.float64)

    def header(self, role: Role) -> str:
        return self.signals.headers[role]

    def raw(self, role: Role) -> Callable[[float], float]:
        """How a value in house units stands in the file, under the role's header."""
        how = self.signals.conversions[role]
        return lambda value: float(value if how.scale == 1.0 and how.shift == 0.0 else (value - how.shift) / how.scale)


def _times(signals: Signals, where: str, notes: list[DataNote]) -> times.Times:
    how = signals.conversions["time"]
    raw, wraps = times.unwrap(signals.values["time"], how.scale)
    when = times.ascending(np.asarray(raw * how.scale + how.shift, dtype=np.float64), where, signals.locate)
    notes += [*wraps, *when.notes]
    return when


def _command(cut: _Cutter, where: str, notes: list[DataNote]) -> FloatArray:
    name = cut.header("command")
    values = cut("command")
    if not np.isfinite(values).any():
        raise BadInput(f"{where}: column '{name}' (command) holds no number; name the right one with --map")
    values, found = quality.held(name, values, cut.rows)
    notes += found
    if quality.constant(values):
        what = f"{name}: constant at {cut.raw('command')(values[0]):.6g}"
        notes.append(DataNote(what, "kept; nothing can be learned of the curves"))
    return values


def _position(cut: _Cutter, where: str, notes: list[DataNote]) -> FloatArray:
    name = cut.header("position")
    values = cut("position")
    if not np.isfinite(values).any():
        raise BadInput(f"{where}: column '{name}' (position) holds no number; name the right one with --map")
    values, found = quality.finite(name, values, cut.rows)
    notes += [*found, *quality.clipped(name, values, cut.rows, cut.raw("position"))]
    if quality.constant(values):
        at = cut.raw("position")(values[np.isfinite(values)][0])
        notes.append(DataNote(f"{name}: constant at {at:.6g}", "kept; the valve never moved, or the LVDT is not read"))
    return values


def _pressure(cut: _Cutter, still: bool, notes: list[DataNote]) -> FloatArray | None:
    """The measured pressure; None where there is none, or where it is no measurement (`still`: so is the command)."""
    if "pressure" not in cut.signals.values:
        notes.append(DataNote("no pressure column", "the E/P and actuator stages cannot be separated"))
        return None
    name = cut.header("pressure")
    values = cut("pressure")
    good = np.isfinite(values)
    if not good.any():
        notes.append(DataNote(f"{name}: no number in it", "treated as not measured", values.size, 1))
        return None
    if quality.constant(values) and not still:
        what = f"{name}: constant at {cut.raw('pressure')(values[good][0]):.6g} while the command moves"
        notes.append(DataNote(what, "treated as not measured", values.size, 1))
        return None
    values, found = quality.finite(name, values, cut.rows)
    notes += [*found, *quality.clipped(name, values, cut.rows, cut.raw("pressure"))]
    return values


def _check_units(signals: Signals, where: str) -> None:
    """Command and pressure must come out in one unit, position and target too; percent of what is not for guessing."""
    pairs: tuple[tuple[Role, Role, str], ...] = (
        ("command", "pressure", "3..15 psi"),
        ("position", "target", "0..0.5625 in"),
    )
    for one, other, span in pairs:
        units = {role: signals.conversions[role].unit for role in (one, other) if role in signals.conversions}
        if len(set(units.values())) < 2:
            continue
        percent = one if units[one] == "percent" else other
        raise BadInput(
            f"{where}: {one} has [{units[one]}] and {other} [{units[other]}]; say which range the percent belong to, "
            f"as in --units '{percent}=percent({span})', or leave one out with --map {other}="
        )


def _unit_notes(signals: Signals) -> list[DataNote]:
    notes = []
    for role, how in signals.conversions.items():
        header = signals.headers[role]
        if how.said:
            notes.append(DataNote(f"{header}: {how.said}", "used so"))
        if role in signals.unsaid:
            notes.append(DataNote(f"{header}: no unit stated", f"taken as {how.unit}; --units {role}=... says else"))
    return notes
