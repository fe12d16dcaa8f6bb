"""Numbers that are a little off beside a law that leaves nothing but the noise."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.twin.choose.test_numbers_and_others import a_fit, caused, real
from twin.choose.decide import decide
from twin.choose.rules import DecisionRules
from twin.fit.fitting import Fit
from twin.judge.hearing import _missed
from twin.search.claims import nudged, suspected
from twin.search.findings import Findings


def plainly(none: float, *fits: tuple[Fit, float]) -> Findings:
    """Findings about a reading without coarse steps."""
    findings = real(none, *fits)
    channel: Any = findings.channel
    channel.half = 0.0
    return findings


def sure(mse: float, name: str, form: str, moved: dict[str, float], accused: str = "") -> Fit:
    """A hypothesis whose unknowns are all known well."""
    others = (caused(f"parameter:{accused}"),) if accused else ()
    one = a_fit(mse, caused(name, form), *others, moved=moved)
    return replace(one, z=one.z + 1e-3, normal=1e9 * np.eye(one.z.size))


@pytest.mark.parametrize(
    ("name", "form", "moved", "mse", "off"),
    [
        ("position_dependent_friction", "spot", {"tau": 0.05}, 1.02, ["tau"]),
        ("position_dependent_friction", "spot", {"tau": -0.05, "offset": 0.04}, 1.02, ["offset", "tau"]),
        ("position_dependent_friction", "spot", {"tau": 0.02}, 1.02, []),  # no number is known to the last percent
        ("position_dependent_friction", "spot", {"tau": 0.05}, 1.2, []),  # a wrong form, and what it leaves
        ("position_dependent_friction", "profile", {"tau": 0.05}, 1.02, []),  # a curve takes any shape
        ("lvdt_nonlinearity", "bow", {"offset": 0.05}, 1.02, []),  # the bend says where the curve begins
        ("flow_force", "jet", {"tau": 0.05}, 1.02, []),  # a spring in its place may bend nothing
        ("stiction", "one_jump", {"compliance": 0.05}, 1.02, []),  # slips come when they come
    ],
)
def test_a_number_is_suspected_where_a_law_leaves_nothing_else(
    name: str, form: str, moved: dict[str, float], mse: float, off: list[str]
) -> None:
    fit = a_fit(mse, caused(name, form), moved=moved)
    assert nudged(fit) == off
    asked = {cause.name for some in suspected(fit) for cause in some}
    assert asked == {f"parameter:{n}" for n in off}


def test_it_is_accused_where_the_evidence_is_for_it_and_not_where_the_healthy_machine_is_off_itself() -> None:
    alone = sure(1.02, "position_dependent_friction", "spot", {"tau": 0.05})
    both = sure(1.02, "position_dependent_friction", "spot", {"tau": 0.05}, "tau")
    for ahead, within, names in ((8.0, 0.0, both.names), (2.0, 0.0, alone.names), (8.0, 1.0, alone.names)):
        decision = decide(real(80.0, (alone, 0.0), (both, ahead)), DecisionRules(within=within))
        assert decision.accepted.names == names


def test_unseen_data_that_do_without_the_accusation_do_not_without_the_number() -> None:
    alone = sure(1.02, "position_dependent_friction", "spot", {"tau": 0.05})
    both = sure(1.02, "position_dependent_friction", "spot", {"tau": 0.05}, "tau")
    with_it, without = (
        decide(plainly(80.0, *fits), DecisionRules()) for fits in (((alone, 0.0), (both, 8.0)), ((alone, 0.0),))
    )
    assert _missed(without, with_it)
    as_designed = sure(1.02, "position_dependent_friction", "spot", {})
    assert not _missed(decide(plainly(80.0, (as_designed, 0.0)), DecisionRules()), with_it)
