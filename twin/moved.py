"""Design numbers that the updated model has elsewhere, though nobody accused them.

Beside a named cause, and where nothing explains, numbers follow what the record says. What moved far was not judged by
itself, but whoever takes the updated model takes it, too.
"""

from __future__ import annotations

from collections.abc import Collection

from control.design import DesignModel
from logs.recording import DataNote
from twin.fit.numbers import nominals, reference

#: A move is told from so much of the number on (of a quarter of the span, where the number itself is less).
_FAR = 0.05
_UNITS = {"deadband": "{p}", "offset": "{p}", "compliance": "{x}/{p}", "tau": "s", "rate_limit": "{x}/s", "ep_tau": "s"}


def moved_numbers(design: DesignModel, updated: DesignModel, accused: Collection[str]) -> list[DataNote]:
    """One note for what moved far; `accused`: names of causes."""
    given, got = nominals(design), nominals(updated)
    words = [
        f"{name} {got[name]:.4g} instead of {given[name]:.4g} {_unit(design, name)}"
        for name in given
        if f"parameter:{name}" not in accused and abs(got[name] - given[name]) > _FAR * reference(design, name)
    ]
    if not words:
        return []
    handled = "re-tuned with the rest and not accused: what the record asks of it beside what is said, and no verdict"
    return [DataNote(f"the updated model has {', '.join(words)}", handled)]


def _unit(design: DesignModel, name: str) -> str:
    return _UNITS[name].format(p=design.pressure_unit, x=design.position_unit)
