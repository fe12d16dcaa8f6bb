"""One sample in words, for the verbs that show readings while they go."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hal.sample import Quality, Reading, Sample


def quality_text(quality: Quality) -> str:
    """`good`, or what is wrong, in lower case."""
    return "good" if not quality else "+".join(str(flag.name).lower() for flag in quality)


def sample_row(sample: Sample, unit: str) -> dict[str, object]:
    """A sample as plain values with units in the names, for a table or for JSON; NaN becomes None."""
    row: dict[str, object] = {
        "time_s": round(sample.time_s, 6),
        f"command_{unit}": _number(sample.commanded_psi),
        "pressure_psi": None if sample.pressure is None else _number(sample.pressure.value),
        "position_in": _number(sample.position.value),
        "latency_ms": round(1e3 * sample.position.latency_s, 3),
    }
    row |= {name: _number(reading.value) for name, reading in sample.aux.items()}
    row["quality"] = quality_text(sample.position.quality | _or_good(sample.pressure))
    return row


def header(unit: str) -> str:
    """The line above `line`."""
    return f"{'time s':>9}  {'command ' + unit:>12}  {'pressure psi':>12}  {'position in':>11}  {'ms':>6}  quality"


def line(sample: Sample, began_s: float) -> str:
    """A sample in one line of fixed columns; '-' for a value that is not known."""
    pressure = math.nan if sample.pressure is None else sample.pressure.value
    quality = quality_text(sample.position.quality | _or_good(sample.pressure))
    return (
        f"{sample.time_s - began_s:9.2f}  {_column(sample.commanded_psi, 12, 3)}  {_column(pressure, 12, 3)}  "
        f"{_column(sample.position.value, 11, 4)}  {1e3 * sample.position.latency_s:6.2f}  {quality}"
    )


def _or_good(reading: Reading | None) -> Quality:
    from hal.sample import Quality

    return Quality.GOOD if reading is None else reading.quality


def _number(value: float) -> float | None:
    return None if math.isnan(value) else round(value, 6)


def _column(value: float, width: int, digits: int) -> str:
    return f"{'-':>{width}}" if math.isnan(value) else f"{value:{width}.{digits}f}"
