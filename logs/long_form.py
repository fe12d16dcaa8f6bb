"""Tables with one reading a row (which tag, when, what), as historians export them: a column for each tag."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from logs.roles import is_clock, split_header
from logs.table import Table

_TAG = frozenset({"tag", "tagname", "tag name", "tag id", "point", "point name", "signal", "variable", "channel"})
_VALUE = frozenset({"value", "val", "reading"})
#: More tags than a recording would have: names of something else.
_MANY = 200


def by_tag(table: Table) -> Table:
    """The table with each tag's times and values in columns of their own; any other table as it is.

    Columns beside tag, time and value (a quality, a unit) are left out, and so are rows without a tag.
    """
    import pyarrow as pa

    named = {header: split_header(header, "time").label for header in table.headers}
    tag, value, time = (
        [header for header, label in named.items() if fits(label)]
        for fits in (_TAG.__contains__, _VALUE.__contains__, is_clock)
    )
    if not (len(tag) == len(value) == len(time) == 1) or not table.has_header:
        return table
    rows = dict[str, list[int]]()
    for row, cell in enumerate(table.column(tag[0]).to_pylist()):
        if name := str(cell or "").strip():
            rows.setdefault(name, []).append(row)
    if not 1 < len(rows) <= _MANY:
        return table
    most = max(map(len, rows.values()))
    columns = dict[str, Any]()
    for number, (name, at) in enumerate(rows.items(), start=1):
        places = pa.array([*at, *([None] * (most - len(at)))], type=pa.int64())
        columns[time[0] if number == 1 else f"{time[0]} #{number}"] = table.column(time[0]).take(places)
        columns[name] = table.column(value[0]).take(places)
    return replace(
        table,
        headers=tuple(columns),
        rows=most,
        column=columns.__getitem__,
        locate=lambda row: f"value {row + 1} of its tag",
        header_units={time[0]: table.header_units.get(time[0], "")},
    )
