"""What only the measured pressure shows is named, though the stem never feels it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from twin.diagnosis import Cause as Named
from twin.diagnosis import Diagnosis, Gap, Share
from twin.judge.gap import GapParts
from twin.judge.upheld import shown_by_pressure, upheld
from twin.judge.verdict import Judgement
from twin.record.sensing import Sensing
from twin.report.statement import statement

CREEP = Named("creep", "actuator", 0.9, None, {})
NOTHING_SEEN = Sensing((), {}, 0.0)


def parts(level: float) -> GapParts:
    return GapParts(*(np.full(8, level) for _ in range(3)), {}, {})


@pytest.mark.parametrize(
    ("shown", "sure", "verdict", "names"),
    [
        (("supply_saturation",), 0.9, "effect", ["supply_saturation"]),
        (("supply_saturation",), 0.1, "no_gap", []),
        ((), 0.9, "no_gap", []),
    ],
)
def test_what_the_pressure_shows_is_named_though_the_stem_never_feels_it(
    shown: tuple[str, ...], sure: float, verdict: str, names: list[str]
) -> None:
    """A supply that gives too little where the stem has long been at its stop; what is behind it goes."""
    supply = Named("supply_saturation", "ep", sure, None, {})
    both = Judgement("effects", (supply, CREEP), (), (("creep", "stiction"),))
    judgement = upheld(parts(1.0), both, 1.0, NOTHING_SEEN, True, shown=shown)[1]
    assert (judgement.verdict, [c.name for c in judgement.causes]) == (verdict, names)
    assert judgement.confusable == ()


def test_it_is_named_beside_what_the_readings_showed_too() -> None:
    seen = Sensing((), {"sensor_quantization": {}}, 0.06)
    supply = Named("supply_saturation", "ep", 0.9, None, {})
    coarse = Named("sensor_quantization", "sensor", 0.97, None, {})
    every = Judgement("effects", (supply, coarse, CREEP), (), ())
    for shown, names in ((("supply_saturation",), (supply, coarse)), ((), (coarse,))):
        assert upheld(parts(0.9), every, 1.0, seen, True, shown=shown)[1].causes == names


@pytest.mark.parametrize(
    ("before", "shown", "verdict"),
    [(1.8, ("supply_saturation",), "effect"), (1.8, (), "unexplained"), (2.6, ("supply_saturation",), "unexplained")],
)
def test_it_need_not_help_to_predict_a_stem_that_is_hardly_off(
    before: float, shown: tuple[str, ...], verdict: str
) -> None:
    supply = Judgement("effect", (Named("supply_saturation", "ep", 0.9, None, {}),), (), ())
    assert upheld(parts(before), supply, 1.0, NOTHING_SEEN, True, shown=shown)[1].verdict == verdict


def test_the_pressure_shows_what_is_accepted_for_far_more_than_its_noise() -> None:
    def decision(name: str, level: float, explained: bool = True, exact: bool = False) -> Any:
        none = SimpleNamespace(mse=level)
        findings = SimpleNamespace(channel=SimpleNamespace(name=name), none=none)
        return SimpleNamespace(findings=findings, explained=explained, floor=1.0, names=("ep_deadband",), exact=exact)

    def shown(*decisions: Any) -> tuple[str, ...]:
        return shown_by_pressure(SimpleNamespace(decisions=decisions))  # type: ignore[arg-type]

    assert shown(decision("pressure", 9.0), decision("position", 90.0)) == ("ep_deadband",)
    assert shown(decision("pressure", 5.5)) == ()
    assert shown(decision("pressure", 5.5, exact=True)) == ("ep_deadband",)  # nothing is left of it
    assert shown(decision("pressure", 3.5, exact=True)) == ()
    assert shown(decision("pressure", 9.0, explained=False)) == ()
    assert shown(decision("chain", 9.0)) == ()


@pytest.mark.parametrize(
    ("stage", "closed", "said"),
    [("ep", None, True), ("actuator", None, False), ("ep", Share(0.9, (0.8, 0.95)), False)],
)
def test_the_sentence_says_where_it_shows(stage: Any, closed: Share | None, said: bool) -> None:
    gap = Gap(0.067, 0.067, 0.066, 0.067, closed)
    found = Diagnosis("effect", "", (Named("supply_saturation", stage, 0.9, None, {}),), (), gap)
    assert ("The measured pressure shows it" in statement(found)) is said
