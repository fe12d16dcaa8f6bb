"""Stiction's forms that act on the target: sticking, reversing, growing at rest, and nothing beyond the stops."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid

DESIGN = DesignModel()
K = DESIGN.compliance
MIDDLE = DESIGN.a1 + 0.25 / K  # closes to 0.25 in


def stem(form: str, values: tuple[float, ...], pressure: FloatArray, x0: float) -> FloatArray:
    """The stem at 0.05 s under a pressure given there."""
    plant = Plant(DESIGN, (Inserted("stiction", effect("stiction").form(form), values),))
    grid = make_grid(np.arange(pressure.size) * 0.05, 0.05)
    return stem_response(plant.coefficients(float(grid.time_s[-1])), grid, pressure, x0, x0)


def levels(*each: tuple[float, float]) -> FloatArray:
    """(pressure, seconds) held one after the other."""
    return np.concatenate([np.full(round(seconds / 0.05), pressure) for pressure, seconds in each])


def test_a_further_step_short_of_the_breakaway_moves_nothing() -> None:
    held = stem("target_sticks", (0.3, 4e-3), levels((MIDDLE, 40.0), (MIDDLE + 0.25, 40.0)), 0.0)
    assert abs(held[-1] - 0.25) < 1e-4
    moved = stem("target_sticks", (0.3, 4e-3), levels((MIDDLE, 40.0), (MIDDLE + 0.35, 40.0)), 0.0)
    assert abs(moved[-1] - (0.25 + 0.35 * K)) < 1e-4


@pytest.mark.parametrize(
    ("form", "sticks"), [("target_sticks", True), ("target_sticks_pressed", True), ("slip_until_slow", False)]
)
def test_the_target_sticks_while_the_stem_is_still_on_its_way(form: str, sticks: bool) -> None:
    pressure = levels((MIDDLE - 1.0, 5.0), (MIDDLE, 1.0), (MIDDLE + 0.25, 60.0))
    assert abs(stem(form, (0.3, 4e-3), pressure, 0.0)[-1] - (0.25 if sticks else 0.25 + 0.25 * K)) < 2e-3


def test_a_moving_stem_breaks_away_again_before_it_reverses() -> None:
    """While the stem is still on its way open the pressure asks for a little closing: too little to turn it round."""
    opened = DESIGN.a2 + 0.1 / K
    back = DESIGN.a1 + 0.12 / K
    pressure = levels((opened, 3.0), (back, 60.0))
    for form, values in (("slip_until_slow", (0.3, 2e-4)), ("target_sticks", (0.3, 4e-3))):
        assert abs(stem(form, values, pressure, 0.4)[-1] - 0.1) < 1e-3
        weaker = (0.05, *values[1:])
        assert abs(stem(form, weaker, pressure, 0.4)[-1] - 0.12) < 1e-3


def test_what_the_stops_keep_it_from_does_not_pull() -> None:
    near = DESIGN.a2 + 0.02 / K
    pressure = levels((near, 40.0), (DESIGN.a2 - 2.0, 40.0))
    assert abs(stem("target_sticks", (0.3, 4e-3), pressure, 0.3)[-1] - 0.02) < 1e-3
    for form, values in (("slip_until_slow", (0.3, 2e-4)), ("target_sticks_pressed", (0.3, 4e-3))):
        assert stem(form, values, pressure, 0.3)[-1] < 1e-3


def test_a_slow_ramp_goes_in_jumps_of_the_target_and_a_fast_one_slides() -> None:
    """On its way it is behind sliding by up to the breakaway, where the target is slower than it takes to stick."""
    up = np.arange(0.0, 40.0, 0.05)
    for rate, jumps in ((0.02 / K, True), (0.06 / K, False)):
        pressure = DESIGN.a1 + np.clip(rate * up - 0.5, -0.5, 0.4 / K)
        slides = stem("target_sticks_pressed", (0.0, 4e-2), pressure, 0.0)
        found = stem("target_sticks_pressed", (0.3, 4e-2), pressure, 0.0)
        moving = (slides > 0.15) & (slides < 0.3)
        behind = (slides - found)[moving] / K
        assert bool(behind.max() > 0.15) is jumps
        assert behind.min() > -1e-3 and behind.max() < 0.3


def test_the_breakaway_grows_at_rest() -> None:
    def after(rest_s: float) -> float:
        pressure = levels((MIDDLE, rest_s), (MIDDLE + 0.2, 40.0))
        return float(stem("grows_at_rest", (0.3, 10.0), pressure, 0.25)[-1])

    first = levels((MIDDLE - 1.0, 5.0))
    assert first.size == 100
    assert abs(after(60.0) - 0.25) < 1e-4  # at rest since ever: all of 0.3 psi is there
    pressure = levels((MIDDLE - 1.0, 0.5), (MIDDLE, 3.0), (MIDDLE + 0.2, 40.0))
    young = float(stem("grows_at_rest", (0.3, 10.0), pressure, 0.05)[-1])
    assert abs(young - (0.25 + 0.2 * K)) < 2e-3  # after 3 s only 0.08 psi


@pytest.mark.parametrize("rate", [4e-4, 4e-3])
def test_what_creeps_does_not_rest(rate: float) -> None:
    """However slow the pressure goes, of a stem that it takes along no friction has the time to grow."""
    at_s = np.arange(0.0, 40.0, 0.05)
    creeps = np.concatenate([levels((MIDDLE, 1.0)), MIDDLE + 0.4 + rate / K * at_s])
    slides = stem("grows_at_rest", (0.0, 10.0), creeps, 0.25)
    np.testing.assert_allclose(stem("grows_at_rest", (0.3, 10.0), creeps, 0.25)[-200:], slides[-200:], atol=1e-5)


def test_friction_that_grows_as_the_stem_slows_down_keeps_it_short_of_its_target() -> None:
    up = stem("short_of_target", (0.06, 1e-2, 0.0), levels((MIDDLE, 90.0)), 0.0)
    assert abs(up[-1] - (0.25 - 0.06 * K)) < 1e-4
    further = levels((MIDDLE, 90.0), (MIDDLE + 0.05, 30.0), (MIDDLE + 0.2, 90.0))
    path = stem("short_of_target", (0.06, 1e-2, 0.0), further, 0.0)
    assert abs(path[2390] - (path[1790] + 0.05 * K)) < 1e-4  # it hangs at its friction, and follows what exceeds it
    assert abs(path[-1] - (0.25 + (0.2 - 0.06) * K)) < 1e-4
    back = stem("short_of_target", (0.06, 1e-2, 0.0), levels((MIDDLE, 90.0), (DESIGN.a2 + 0.1 / K, 90.0)), 0.0)
    assert abs(back[-1] - (0.1 + 0.06 * K)) < 1e-4


def test_friction_that_falls_at_once_leaves_a_fast_stem_alone() -> None:
    pressure = levels((MIDDLE, 1.0))
    free = stem("short_of_target", (0.0, 1e-3, 0.0), pressure, 0.0)
    fast = stem("short_of_target", (0.06, 1e-3, 0.0), pressure, 0.0)
    assert np.abs(fast - free).max() < 0.06 * K
    assert np.abs(np.diff(fast[10:]) - np.diff(free[10:])).max() < 1e-4


@pytest.mark.parametrize(
    ("form", "values"), [("one_jump", (0.3,)), ("slip_until_slow", (0.3, 2e-4)), ("target_sticks", (0.3, 4e-3))]
)
def test_a_stem_at_rest_may_have_been_left_where_the_breakaway_holds_it(form: str, values: tuple[float, ...]) -> None:
    """Beyond where sliding friction alone would let it go, both ways, and not beyond the breakaway."""
    closing, opening = DESIGN.a1 + 0.25 / K, DESIGN.a2 + 0.25 / K
    for held, slides in ((closing + 0.28, closing + 0.32), (opening - 0.28, opening - 0.32)):
        assert stem(form, values, levels((held, 20.0)), 0.25)[-1] == 0.25
        assert abs(stem(form, values, levels((slides, 40.0)), 0.25)[-1] - 0.25) > 0.3 * K


def test_what_a_stop_holds_takes_no_part_in_where_a_stem_was_left() -> None:
    """The play has a stop at 0: of what would take it further the breakaway needs nothing where only the rest pulls."""
    near = DESIGN.a2 - 0.05 / K
    for form, still in (("target_sticks", True), ("target_sticks_pressed", False)):
        assert bool(stem(form, (0.3, 4e-3), levels((near - 1.0, 60.0)), 0.02)[-1] == 0.02) is still


def test_one_jump_is_its_law_from_where_the_stem_was_left() -> None:
    """In small steps: out of the band of the breakaway the target goes onto its curve, and sticks there again."""
    time_s = np.arange(0.0, 200.0, 0.05)
    pressure = 7.0 + 3.0 * np.sin(time_s / 13.0) + 0.6 * np.sin(time_s / 2.9)
    x = target = 0.1
    expected = [x]
    for p in pressure[1:]:
        if p > DESIGN.a1 + target / K + 0.5:
            target = min(K * (p - DESIGN.a1), DESIGN.travel)
        elif p < DESIGN.a2 + target / K - 0.5:
            target = max(K * (p - DESIGN.a2), 0.0)
        speed = np.clip((target - x) / DESIGN.tau_s, -DESIGN.rate_limit, DESIGN.rate_limit)
        x = x + 0.05 * speed
        expected.append(x)
    found = stem("one_jump", (0.5,), pressure, 0.1)
    assert np.sqrt(np.mean((found - np.array(expected)) ** 2)) < 0.004 * DESIGN.travel
