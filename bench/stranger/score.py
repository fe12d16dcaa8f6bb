"""Holds an answer against the truth of its case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

#: What the verdict should be.
VERDICTS = {
    "none": "no_gap",
    "effect": "effect",
    "parameter": "parameter",
    "effects": "effects",
    "outsider": "unexplained",
}


def _alike(one: str, other: str, sets: Sequence[Sequence[str]]) -> bool:
    """Whether two names are the same, or said to be indistinguishable."""
    return one == other or any(one in names and other in names for names in sets)


def score(label: Mapping[str, Any], answer: Mapping[str, Any]) -> dict[str, Any]:
    """What is right and wrong about diagnosis.json; an outsider has no right name, only the honest verdict."""
    truth = [] if label["kind"] == "outsider" else [cause["name"] for cause in label["causes"]]
    stages = {cause["stage"] for cause in label["causes"]}
    named = [cause["name"] for cause in answer["causes"]]
    sets = answer["confusable"]
    verdict = answer["verdict"] == VERDICTS[label["kind"]]
    exact = set(named) == set(truth)
    found = all(any(_alike(name, one, sets) for one in named) for name in truth)
    clean = all(any(_alike(name, one, sets) for name in truth) for one in named)
    return {
        "right": verdict and exact,
        "right_or_confusable": found and clean and (verdict or bool(truth)),
        "first_right": (named[0] in truth if named else not truth) if label["kind"] != "outsider" else None,
        "stage_right": answer["causes"][0]["stage"] in stages if named and stages else None,
        "false": [name for name in named if not any(_alike(true, name, sets) for true in truth)],
        "missed": [name for name in truth if not any(_alike(name, one, sets) for one in named)],
        "in_confusion_set": None if not truth or exact else found,
        "named": [
            {"name": cause["name"], "probability": cause["probability"], "right": cause["name"] in truth}
            | {"right_or_confusable": any(_alike(true, cause["name"], sets) for true in truth)}
            for cause in answer["causes"]
        ],
    }
