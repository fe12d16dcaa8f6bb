"""What a further cause has to be worth: enough of the gap, or nearly all of the rest if it is the second."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from twin.catalog import effect
from twin.choose.decide import DecisionRules, _worth
from twin.fit.space import Cause

NAMES = ("creep", "spring_asymmetry", "stiction")


def fitted(count: int, mse: float) -> Any:
    causes = [Cause(name, effect(name), effect(name).forms[0]) for name in NAMES[:count]]
    return SimpleNamespace(mse=mse, space=SimpleNamespace(causes=causes))


@pytest.mark.parametrize(
    ("count", "mse", "wanted"),
    [
        (2, (2.4, 1.05), True),  # a small second cause beside a large first one
        (3, (2.4, 1.05), False),  # a third one is the rest of a form that is not quite true
        (3, (6.0, 1.05), True),  # ... unless it is worth naming in itself
        (2, (2.4, 1.6), False),
    ],
)
def test_a_third_cause_has_to_explain_part_of_the_gap(count: int, mse: tuple[float, float], wanted: bool) -> None:
    small, large = fitted(count - 1, mse[0]), fitted(count, mse[1])
    findings: Any = SimpleNamespace(none=fitted(0, 101.0), score=lambda one: -100.0 * one.mse)
    assert _worth(findings, small, large, DecisionRules(), 1.0) is wanted
