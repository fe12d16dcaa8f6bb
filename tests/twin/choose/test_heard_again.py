"""The stem is asked about the pressure again when the cause behind it is known: edges that stick turn on a hair."""

from __future__ import annotations

import pytest

from control.design import DesignModel
from tests.twin.straying import straying
from twin.choose.rules import DecisionRules
from twin.choose.stages import driven_about, judge
from twin.choose.witness import driven_by_model, gauge_wanders, left_of_position, still_denied
from twin.fit.case import Case, make_case
from twin.fit.channel import position_channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.search.search_rules import SearchRules

STICTION = effect("stiction")
STICKS = Inserted("stiction", STICTION.form("target_sticks"), (0.3, 0.004))


def sticking(**strays: float) -> Case:
    """A valve that sticks, and whose gauge or whose pressure is restless."""
    return make_case([straying(**strays, plant=Plant(DesignModel(), (STICKS,)))], DesignModel())


def found(case: Case) -> Fit:
    """What its stiction makes of the position when it is driven by what stands out of the reading's noise."""
    channel = position_channel(driven_about(case.base, case), case.sigma_y)
    space = make_space(case.base, (Cause("stiction", STICTION, STICKS.form),), channel.numbers, case.scales)
    return fit(channel, space, starts_of(space, [], channel.recordings), refine=2)


@pytest.mark.parametrize(("where", "gauge"), [({"gauge_psi": 0.01}, True), ({"air_psi": 0.01}, False), ({}, False)])
def test_with_its_cause_the_stem_tells_the_gauge_from_the_air(where: dict[str, float], gauge: bool) -> None:
    """Without it either pressure leaves as much, or rather more by the model's."""
    case = sticking(**where)
    trials = driven_by_model(case.base, case.trials)
    read, modelled = left_of_position(case, driven_about(case.base, case)), left_of_position(case, trials)
    assert not gauge_wanders(read, modelled)
    assert still_denied(case, trials, found(case)) is gauge


@pytest.mark.thorough
def test_a_search_asks_the_stem_again() -> None:
    result = judge(sticking(gauge_psi=0.01), SearchRules(most=1), DecisionRules(), lambda _what, _share: None)
    assert result.astray and result.denied == ()
    assert result.causes == ("stiction",)
    assert result.decisions[-1].accepted.mse < 6.0
