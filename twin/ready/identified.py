"""What a diagnosis finds about numbers that were identified from the very records: they were not found well enough.

Such numbers cannot be at fault. Nor can a stop that is elsewhere, or a gain of the reading: the travel, and the unit in
which all of them are said, come from the same readings. Whatever else was wrong had bent them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from control.design import DesignModel

#: What the forms of a stop call what is missing at the closed end, which alone is the travel.
_CLOSED = {"upper_stop": "missing", "both_stops": "missing_closed"}


def better_identified(causes: Iterable[str], model: DesignModel) -> DesignModel | None:
    """The numbers of an updated `model` as a design without effects; None where its `causes` say nothing of numbers."""
    tables: Mapping[str, Mapping[str, object]] = model.effects
    stop, reading = tables.get("reduced_travel", {}), tables.get("lvdt_calibration", {})
    missing = _number(stop, _CLOSED.get(str(stop.get("form")), ""))
    gain = 1.0 + (_number(reading, "gain") if reading.get("form") in ("gain", "gain_and_zero") else 0.0)
    accused = any(name.startswith("parameter:") for name in causes)
    if not accused and missing == 0.0 and gain == 1.0:
        return None
    return replace(
        model,
        travel=gain * (1.0 - missing) * model.travel,
        compliance=gain * model.compliance,
        rate_limit=gain * model.rate_limit,
        effects={},
    )


def _number(table: Mapping[str, object], name: str) -> float:
    value = table.get(name, 0.0)
    return float(value) if isinstance(value, int | float) else 0.0
