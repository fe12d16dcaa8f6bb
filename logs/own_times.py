"""Signals that have times of their own, each in the column before it: brought to the rows of the position.

So write historians, which store a tag when it changes, and recorders with a clock for each channel.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from logs.recording import DataNote, FloatArray
from logs.roles import Column, Role, is_clock, split_header

_NUMBER = re.compile(r"[ ._#]+\d+$")
#: What is commanded holds until it is commanded anew; what is measured goes from one reading to the next.
_HELD: tuple[Role, ...] = ("command", "target")


def clocks(headers: Sequence[str], columns: Mapping[Role, Column]) -> dict[Role, str]:
    """The time column before that of each signal; none where one is missing, or all have the same."""
    found = dict[Role, str]()
    for role, column in columns.items():
        before = [header for header in headers[: headers.index(column.header)] if is_clock(clock(header).label)]
        if role != "time" and before:
            found[role] = before[-1]
    signals = [role for role in columns if role != "time"]
    return found if len(found) == len(signals) and len(set(found.values())) > 1 else {}


def clock(header: str) -> Column:
    """A time's column, of which there may be several by numbers: `Time (s) #2`, `time.1`."""
    column = split_header(_NUMBER.sub("", header), "time")
    return Column(header, _NUMBER.sub("", column.label), column.unit)


def in_step(times: Mapping[Role, FloatArray]) -> bool:
    """Whether the clocks go row by row alike, so that a row is a row."""
    first, *others = times.values()
    rows = np.isfinite(first)
    alike = all(np.array_equal(rows, np.isfinite(one)) for one in others)
    return alike and all(np.unique((first - one)[rows]).size < 2 for one in others)


def at_positions(values: Mapping[Role, FloatArray], times: Mapping[Role, FloatArray]) -> dict[Role, FloatArray]:
    """All signals, and the `time`, in the rows of the position; arrays of shape (rows,), NaN where nothing is known.

    A command is the mean of what was commanded since the row before, a pressure lies between the readings beside it.
    `times` are in any one unit; rows behind the last that has a time are left out.
    """
    rows = int(np.flatnonzero(np.isfinite(times["position"]))[-1:].sum()) + 1
    when = times["position"][:rows]
    found: dict[Role, FloatArray] = {"time": when, "position": values["position"][:rows]}
    for role in values:
        if role != "position":
            at, told = _in_order(times[role], values[role])
            known = np.isfinite(told) if role in _HELD else np.isfinite(at)
            found[role] = (_held if role in _HELD else _between)(when, at[known], told[known])
    return found


def note(columns: Mapping[Role, Column], rows: int) -> DataNote:
    """What was done, for the record."""
    handled = f"brought to the rows of {columns['position'].header}: commands by their mean since the row before"
    handled += ", the pressure between its readings" if "pressure" in columns else ""
    return DataNote("each signal has times of its own", handled, rows)


def _in_order(at: FloatArray, told: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Those with a time, the earliest first."""
    order = np.argsort(at, kind="stable")[: int(np.isfinite(at).sum())]
    return at[order], told[order]


def _between(when: FloatArray, at: FloatArray, told: FloatArray) -> FloatArray:
    return np.interp(when, at, told, left=np.nan, right=np.nan) if at.size else np.full(when.size, np.nan)


def _held(when: FloatArray, at: FloatArray, told: FloatArray) -> FloatArray:
    """The mean since the row before of what holds from each time on; at the first row what holds then."""
    if not at.size:
        return np.full(when.size, np.nan)
    worked = np.concatenate(([0.0], np.cumsum(told[:-1] * np.diff(at))))

    def since(t: FloatArray) -> tuple[FloatArray, FloatArray]:
        last = np.clip(np.searchsorted(at, t, side="right") - 1, 0, None)
        return told[last], worked[last] + told[last] * (t - at[last])

    value, work = since(when)
    begin = np.maximum(when[:-1], at[0])
    span = when[1:] - begin
    later = span > 0.0
    value[1:][later] = (work[1:] - since(begin)[1])[later] / span[later]
    return np.where(when < at[0], np.nan, value)
