"""What readings say of a stem at rest, and which way a stroke goes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.controller import Seen
from control.design import DesignModel
from control.play_filter import Belief, PlayFilter
from control.resting import Resting, in_vain, way_of_stroke

DESIGN = DesignModel()


def belief(position_in: float = 0.28, **psi: float) -> Belief:
    """At rest there, in the middle of the gap, both edges known to some 0.3 psi."""
    middle_psi = DESIGN.offset + position_in / DESIGN.compliance
    started = PlayFilter(DESIGN).start(Seen(position_in, middle_psi, middle_psi))
    return replace(started, inside=replace(started.inside, **psi))  # type: ignore[arg-type]


def read(readings_in: list[float], goes_in: float = 0.0) -> Resting:
    rest = Resting()
    for reading_in in readings_in:
        rest = rest.read(reading_in, reading_in, goes_in)
    return rest


def test_the_mean_is_of_what_was_read_at_rest() -> None:
    assert read([0.001, 0.0012, 0.0014]).off_in == pytest.approx(0.0012)
    assert read([0.1, 0.05, 0.001, 0.0012]).off_in == pytest.approx(0.0011)  # the first two were still on their way


def test_only_a_long_swing_through_the_target_is_one() -> None:
    assert read([-0.008, 0.0, 0.009]).swung(0.0006)
    assert not read([-0.008, 0.0, 0.009]).swung(0.0024)
    assert not read([-0.002, 0.001, 0.02]).swung(0.0006)  # it came from there
    assert not read([-0.005, 0.005]).swung(0.0006)


@pytest.mark.parametrize(("beyond_psi", "readings", "stays"), [(0.05, 30, True), (0.05, 10, False), (0.01, 30, False)])
def test_a_plate_that_slides_does_not_stay_beyond_an_edge(beyond_psi: float, readings: int, stays: bool) -> None:
    found = belief()
    found = replace(found, spread=tuple(0.0 for _ in found.spread))
    now = replace(found, inside=replace(found.inside, p=found.edge_psi(0.28, 1) + beyond_psi))
    assert read([0.0] * readings).stays(now, found, 0.28, 2.5) == stays


def test_an_edge_that_is_not_known_says_nothing_of_staying() -> None:
    found = belief()
    now = replace(found, inside=replace(found.inside, p=found.edge_psi(0.28, 1) + 0.05))
    assert not read([0.0] * 30).stays(now, found, 0.28, 2.5)


@pytest.mark.parametrize("off_in", [-0.003, 0.003])
def test_a_stroke_goes_to_the_target_and_beyond(off_in: float) -> None:
    assert way_of_stroke(belief(), off_in, 0.08) == (1 if off_in > 0.0 else -1)


@pytest.mark.parametrize(("known", "way"), [(4, -1), (5, 1)])
def test_a_stroke_ends_on_the_edge_that_is_known_better(known: int, way: int) -> None:
    """Places 4 and 5 of the covariance are the closing and the opening edge."""
    spread = list(belief().spread)
    spread[8 * known] = 1e-6
    sure = replace(belief(), spread=tuple(spread), inside=replace(belief().inside, p=DESIGN.offset))
    assert {way_of_stroke(sure, off_in, 0.08) for off_in in (-0.003, 0.003)} == {way}


@pytest.mark.parametrize(("position_in", "way"), [(0.03, 1), (0.53, -1)])
def test_a_stroke_has_room_before_the_end_stop(position_in: float, way: int) -> None:
    """Where a stop ends it early, the plate does not let go on the way back."""
    assert {way_of_stroke(belief(position_in), off_in, 0.08) for off_in in (-0.003, 0.003)} == {way}


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(
    ("pushes", "went_psi", "doubt_psi", "vain"),
    [
        (4, 0.03, 0.0, True),
        (3, 0.03, 0.0, False),
        (4, 0.02, 0.0, False),
        (4, 0.03, 0.004, False),
        (4, 0.04, 0.004, True),
    ],
)
def test_pushes_that_move_nothing_are_in_vain(
    pushes: int, went_psi: float, doubt_psi: float, vain: bool, way: int
) -> None:
    now = belief()
    mark = (now.inside.p - way * went_psi, now.inside.w, doubt_psi)
    assert in_vain(now, mark, way * pushes, late=False) == vain
    assert not in_vain(now, mark, way * pushes, late=True)


def test_pushes_that_the_plate_follows_are_not_in_vain() -> None:
    now = belief()
    assert not in_vain(now, (now.inside.p - 0.04, now.inside.w - 0.04 * now.compliance, 0.0), 4, late=False)
