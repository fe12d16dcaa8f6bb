"""The travel between two stops, where the record shows that the stem has reached them."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from control.identify_stops import travel_between_stops
from logs.recording import Recording

DESIGN = DesignModel()


def pressed(top_s: float, top_psi: float = 14.0, stuck: float = 0.0) -> Recording:
    """60 s against the open stop, then `top_s` at `top_psi`; the stops read 0.01 and 0.56 in. The first share `stuck`
    of the rows that are at the closed stop sticks 0.02 in short of it."""
    time_s = np.arange(0.0, 60.0 + top_s, 0.1)
    at_top = time_s >= 60.0
    position = np.where(at_top, 0.56, 0.01)
    short = at_top & (time_s < 60.0 + 20.0 + stuck * (top_s - 20.0))
    position[short] = 0.54
    return Recording("x", time_s, np.where(at_top, top_psi, 3.0), position)


@pytest.mark.parametrize("stuck", [0.0, 0.5])
def test_the_outermost_plateaus_count(stuck: float) -> None:
    assert travel_between_stops([pressed(60.0, stuck=stuck)], DESIGN) == pytest.approx(0.55)


def test_a_stay_that_is_too_short_to_arrive_tells_nothing() -> None:
    """0.5625 in at 0.12 in/s and five lags are 19.7 s."""
    assert travel_between_stops([pressed(19.0)], DESIGN) is None


def test_a_pressure_that_just_reaches_the_stop_tells_nothing() -> None:
    assert travel_between_stops([pressed(60.0, DESIGN.a1 + 1.05 * DESIGN.travel / DESIGN.compliance)], DESIGN) is None


def test_several_records_may_show_a_stop_each() -> None:
    both = pressed(60.0)
    halves = [
        Recording("half", both.time_s[rows], both.command[rows], both.position[rows])
        for rows in (slice(0, 600), slice(600, None))
    ]
    assert travel_between_stops(halves, DESIGN) == pytest.approx(0.55)
    assert travel_between_stops(halves[:1], DESIGN) is None
