"""Where the pressure goes when the valve is to rest."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.aims import parked_psi, stop_psi
from control.controller import Seen
from control.design import DesignModel
from control.play_filter import Belief, PlayFilter

DESIGN = DesignModel()


def at(position_in: float, pressure_psi: float) -> Belief:
    started = PlayFilter(DESIGN).start(Seen(position_in, DESIGN.offset + position_in / 0.19, 8.0))
    return replace(started, inside=replace(started.inside, p=pressure_psi))


@pytest.mark.parametrize(("off_psi", "parked"), [(0.0, 0.4), (0.1, 0.4), (1.0, None)])
def test_it_is_parked_off_the_edge_and_left_in_the_middle(off_psi: float, parked: float | None) -> None:
    for side in (1, -1):
        edge_psi = at(0.2, 8.0).edge_psi(0.2, side)
        aim_psi = parked_psi(at(0.2, edge_psi - side * off_psi), 7.0, 0.4)
        assert aim_psi == pytest.approx(7.0 if parked is None else edge_psi - side * parked)


@pytest.mark.parametrize(("stop_in", "side"), [(0.0, -1), (DESIGN.travel, 1)])
def test_a_stop_is_pressed_on_until_the_stem_is_there(stop_in: float, side: int) -> None:
    edge_psi = at(stop_in, 8.0).edge_psi(stop_in, side)
    assert side * (stop_psi(at(0.2, 8.0), stop_in, 8.0, 0.005, 0.3) - edge_psi) == pytest.approx(
        0.3 / DESIGN.compliance
    )
    assert stop_psi(at(stop_in, 8.0), stop_in, edge_psi + side, 0.005, 0.3) == edge_psi + side
