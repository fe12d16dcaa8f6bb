"""When a correction goes by way of the far edge, and how far beyond the near one."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.controller import Seen
from control.design import DesignModel
from control.detour import gains, hardly_known, over_psi
from control.play_filter import Belief, PlayFilter
from control.play_points import A1, A2, SIZE

DESIGN = DesignModel()
AT_IN = 0.2


def belief(closing_psi: float, opening_psi: float) -> Belief:
    """At rest, nothing in doubt but the two edges, by so much."""
    rest_psi = DESIGN.offset + AT_IN / DESIGN.compliance
    spread = [0.0] * (SIZE * SIZE)
    for place, sd in ((A1, closing_psi), (A2, opening_psi)):
        spread[SIZE * place + place] = sd * sd
    return replace(PlayFilter(DESIGN).start(Seen(AT_IN, rest_psi, rest_psi)), spread=tuple(spread))


@pytest.mark.parametrize(
    ("closing_psi", "opening_psi", "miss_in", "detour"),
    [
        (0.13, 0.003, 0.0024, True),
        (0.13, 0.003, -0.0024, False),  # the edge that pushes there is the one that is known
        (0.13, 0.1, 0.0024, False),  # neither is
        (0.03, 0.003, 0.0024, False),  # it has ended a move before
        (0.13, 0.003, 0.03, False),  # a push leaves less than that
    ],
)
def test_only_an_edge_that_was_never_met_is_avoided(
    closing_psi: float, opening_psi: float, miss_in: float, detour: bool
) -> None:
    assert hardly_known(belief(closing_psi, opening_psi), miss_in) == detour
    assert hardly_known(belief(opening_psi, closing_psi), -miss_in) == detour


def test_what_is_known_of_an_edge_does_not_depend_on_where_the_pressure_is() -> None:
    here = belief(0.13, 0.003)
    there = replace(here, inside=replace(here.inside, p=here.inside.p + 1.0))
    assert there.landing_doubt_in(-1) == here.landing_doubt_in(-1) == pytest.approx(0.003 * DESIGN.compliance)


def test_coming_back_has_to_leave_less_than_the_miss() -> None:
    assert gains(belief(0.13, 0.003), 0.0024)
    assert not gains(belief(0.3, 0.02), 0.0024)


def test_it_goes_surely_beyond_but_not_without_end() -> None:
    assert over_psi(belief(0.13, 0.003), 0.0024) == pytest.approx(0.05 + 2.0 * 0.13)
    assert over_psi(belief(0.4, 0.003), 0.0024) == 0.5
