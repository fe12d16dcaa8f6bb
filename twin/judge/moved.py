"""Design numbers that the updated model has elsewhere, though nobody accused them.

Beside a named cause, and where nothing explains, numbers follow what the record says. What moved far was not judged by
itself, but whoever takes the updated model takes it, too.
"""

from __future__ import annotations

from collections.abc import Collection

from control.design import DesignModel
from logs.recording import DataNote
from twin.fit.numbers import nominals, reference, unit

#: A move is told from so much of the number on (of a quarter of the span, where the number itself is less).
_FAR = 0.05


def moved_numbers(design: DesignModel, updated: DesignModel, accused: Collection[str]) -> list[DataNote]:
    """One note for what moved far; `accused`: names of causes."""
    given, got = nominals(design), nominals(updated)
    spoken, units = design.spoken, {name: unit(design, name) for name in given}
    words = [
        f"{name} {spoken.value(got[name], units[name]):.4g} instead of {spoken.text(given[name], units[name], 4)}"
        for name in given
        if f"parameter:{name}" not in accused and abs(got[name] - given[name]) > _FAR * reference(design, name)
    ]
    if not words:
        return []
    handled = "re-tuned with the rest and not accused: what the record asks of it beside what is said, and no verdict"
    return [DataNote(f"the updated model has {', '.join(words)}", handled)]
