"""A design number is off when it is by more than its tolerance, or when what it does shows clearly."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judge.test_hearing import accepted
from tests.twin.judged import a_record
from twin.choose.stages import StageResult
from twin.choose.weigh import Weights
from twin.diagnosis import Cause, Estimate
from twin.fit.case import make_case
from twin.judge.gap import GapParts
from twin.judge.hearing import Hearing
from twin.judge.tolerance import forgiven, needless_number, within_tolerance
from twin.judge.verdict import Judgement
from twin.model.plant import Plant
from twin.record.sensing import Sensing

DESIGN = DesignModel()


def off(name: str, value: float) -> Cause:
    return Cause(f"parameter:{name}", "actuator", 0.97, None, {name: Estimate(value, (value, value), "")})


def parts(before: float, **without: float) -> GapParts:
    named = {f"parameter:{name}": left for name, left in without.items()}
    return GapParts(*(np.full(8, level) for level in (before, 1.0, 1.0)), named, {})


def test_a_number_is_within_its_tolerance_up_to_one_percent() -> None:
    creep = Cause("creep", "actuator", 0.97, None, {})
    causes = [off("tau", 1.009 * DESIGN.tau_s), off("compliance", 1.011 * DESIGN.compliance), creep]
    assert within_tolerance(causes, DESIGN) == ["parameter:tau"]
    assert within_tolerance([off("deadband", 0.991 * DESIGN.deadband)], DESIGN) == ["parameter:deadband"]
    # the curves' place refers to itself, not to the width between them
    assert within_tolerance([off("offset", 0.992 * 0.5 * (DESIGN.a1 + DESIGN.a2))], DESIGN) == ["parameter:offset"]


@pytest.mark.parametrize(
    ("before", "value", "healthy"), [(1.12, 1.002, True), (1.4, 1.002, False), (1.12, 1.05, False)]
)
def test_within_tolerance_and_hardly_more_than_noise_is_no_gap(before: float, value: float, healthy: bool) -> None:
    causes = [off("deadband", value * DESIGN.deadband)]
    assert forgiven(parts(before), causes, within_tolerance(causes, DESIGN), 1.0) is healthy


def test_an_effect_is_not_forgiven_for_the_number_beside_it() -> None:
    causes = [off("tau", DESIGN.tau_s), Cause("creep", "actuator", 0.97, None, {})]
    assert not forgiven(parts(1.12), causes, ["parameter:tau"], 1.0)


@pytest.mark.parametrize(("left", "needless"), [(1.1, "parameter:compliance"), (1.35, "")])
def test_beside_others_such_a_number_is_named_only_where_it_shows(left: float, needless: str) -> None:
    causes = [off("tau", 1.3 * DESIGN.tau_s), off("compliance", 1.002 * DESIGN.compliance)]
    slight = within_tolerance(causes, DESIGN)
    assert needless_number(parts(9.0, tau=9.0, compliance=left), causes, slight, 1.0) == needless
    assert needless_number(parts(9.0, compliance=left), causes[1:], slight, 1.0) == ""  # alone it is judged otherwise


@pytest.mark.parametrize(("value", "verdict"), [(1.002, "no_gap"), (1.05, "parameter")])
def test_the_verdict_forgives(value: float, verdict: str) -> None:
    """Unseen data would uphold it: the design errs 1.2 times the noise, and the number takes all of that."""
    case = make_case([a_record(Plant(DESIGN))], DESIGN)
    decision = accepted("position", "parameter:deadband", 1.25)
    hearing = Hearing(case, decision.findings.none, Sensing((), {}, 0.0), 0.0, Weights(), False)
    named = Judgement("parameter", (off("deadband", value * DESIGN.deadband),), (), ())
    result = StageResult(case, (decision,), case.trials)
    assert hearing._upheld(result, named, parts(1.2), 1.0)[1].verdict == verdict
