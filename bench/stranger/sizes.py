"""Where a case's size and a parameter of the answer are the same quantity, and whether its interval has the size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

#: (cause, form) -> the parameter's name in diagnosis.json, in the unit of the form's size.
SAME: dict[tuple[str, str], str] = {}


def size_covered(label: Mapping[str, Any], answer: Mapping[str, Any]) -> bool | None:
    """Whether the 95 % interval holds the true size; None where the two are not the same quantity."""
    verdicts = []
    for cause in label["causes"]:
        name = SAME.get((cause["name"], cause["form"]))
        for named in answer["causes"]:
            if named["name"] == cause["name"] and name in named["parameters"]:
                low, high = named["parameters"][name]["ci95"]
                verdicts.append(low <= cause["size"] <= high)
    return all(verdicts) if verdicts else None
