"""Whether a plate goes along with the measured pressure, and what is known once it does not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.controller import Seen
from control.design import DesignModel
from control.exact import lag
from control.grip import Grip
from control.play_filter import Belief, PlayFilter

DESIGN = DesignModel()
TICK_S, TARGET_IN = 0.1, 0.28


def edge_psi(side: int, place_in: float = TARGET_IN) -> float:
    return (DESIGN.a1 if side > 0 else DESIGN.a2) + place_in / DESIGN.compliance


def belief(side: int, wrong_psi: float = 0.0) -> Belief:
    """At rest on the target, on the edge of this side, which is thought to be elsewhere by `wrong_psi`."""
    psi = edge_psi(side)
    started = PlayFilter(DESIGN).start(Seen(TARGET_IN, psi, psi))
    inside = replace(started.inside, a1=DESIGN.a1 + wrong_psi, a2=DESIGN.a2 + wrong_psi)
    return replace(started, inside=inside, noise_in=0.0003)


QUIET = belief(-1)


def landed(side: int, lead_in: float = 0.2) -> Grip:
    return Grip().driven(-side, lead_in).driven(0, 0.0)


def pushed(
    side: int, went_psi: float, follows: float, lead_in: float = 0.2, off_in: float = 0.0, wrong_psi: float = 0.0
) -> Grip:
    """After 2 s where it landed and 8 s further by `went_psi`, of which the plate goes along with a share."""
    grip, soon, x = landed(side, lead_in), belief(side, wrong_psi), TARGET_IN + off_in
    for tick in range(100):
        went = went_psi if tick > 20 else 0.0
        psi, plate_in = edge_psi(side) + side * went, TARGET_IN + off_in + side * follows * DESIGN.compliance * went
        grip = grip.read(Seen(x, psi, psi), soon, (TARGET_IN, psi), DESIGN, TICK_S)
        x += lag(TICK_S, DESIGN.tau_s) * (plate_in - x)
    return grip


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("follows", "stays"), [(0.0, True), (0.8, False), (1.0, False)])
def test_a_plate_that_stays_is_told_from_one_that_slides(side: int, follows: float, stays: bool) -> None:
    assert pushed(side, 0.03, follows).stays(QUIET) == stays


@pytest.mark.parametrize("wrong_psi", [-0.2, 0.2])
def test_it_does_not_matter_where_the_edge_is_thought_to_be(wrong_psi: float) -> None:
    assert pushed(-1, 0.03, 0.0, wrong_psi=wrong_psi).stays(QUIET)
    assert not pushed(-1, 0.03, 1.0, wrong_psi=wrong_psi).stays(QUIET)


def test_a_pressure_that_did_not_move_pushed_nothing() -> None:
    """So it is where a converter with hysteresis does not follow its command: the gauge stays, and so does the stem."""
    assert not pushed(-1, 0.0, 0.0, off_in=0.002).stays(QUIET)


def test_where_readings_are_loud_nothing_is_said() -> None:
    loud = replace(QUIET, noise_in=0.0015)
    assert not pushed(-1, 0.03, 0.0).stays(loud)
    assert pushed(-1, 0.03, 0.0).known(loud, TARGET_IN, loud)[0] == loud


def test_a_short_drive_may_have_landed_beside_the_edge() -> None:
    assert not pushed(-1, 0.03, 0.0, lead_in=0.02).stays(QUIET)


def test_a_plate_that_the_other_edge_may_have_moved_is_watched_afresh() -> None:
    """What it was pushed before counts no more: a plate that slides has gone there already."""
    grip, soon = pushed(-1, 0.03, 1.0), belief(-1)
    for psi in (*[edge_psi(-1) + 2.5] * 10, *[edge_psi(-1) - 0.03] * 80):
        grip = grip.read(Seen(TARGET_IN - 0.0057, psi, psi), soon, (TARGET_IN, psi), DESIGN, TICK_S)
    assert not grip.away
    assert grip.pushed_in < 0.001
    assert not grip.stays(QUIET)


@pytest.mark.parametrize("side", [1, -1])
def test_once_it_sticks_the_edge_is_where_it_stopped(side: int) -> None:
    """Whatever pushing in vain had taught: here the edge is thought to be 0.06 psi off."""
    off_in, wrong = 0.002, belief(side, wrong_psi=0.06)
    found, now = pushed(side, 0.03, 0.0, off_in=off_in).known(wrong, TARGET_IN, wrong)
    assert now.inside.w == pytest.approx(TARGET_IN + off_in, abs=0.0003)
    for each in (found, now):
        assert each.edge_psi(TARGET_IN + off_in, side) == pytest.approx(edge_psi(side), abs=0.003)
        assert each.edge_doubt_psi(side) < 0.1 * wrong.edge_doubt_psi(side)
        assert each.edge_psi(0.0, -side) == wrong.edge_psi(0.0, -side)


def test_where_nothing_was_watched_the_numbers_are_those_found_before() -> None:
    wrong = belief(-1, wrong_psi=0.06)
    found, now = Grip().known(wrong, TARGET_IN, wrong)
    assert found == wrong
    assert now.inside.w == wrong.inside.w
