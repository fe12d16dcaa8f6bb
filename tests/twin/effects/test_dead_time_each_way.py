"""A dead time that is not the same for a rising and for a falling command."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.judged import a_record, judged
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, pressure_response
from twin.model.timegrid import make_grid

DESIGN = DesignModel(ep_tau_s=0.2)


def plant(form: str, *values: float) -> Plant:
    return Plant(DESIGN, (Inserted("dead_time", effect("dead_time").form(form), values),))


def pressure(one: Plant, time_s: FloatArray, command: FloatArray) -> FloatArray:
    grid = make_grid(time_s, 0.01)
    return pressure_response(one.coefficients(20.0), grid, command, 6.0)[grid.offsets]


@pytest.mark.parametrize(("rising_s", "falling_s"), [(0.8, 0.3), (0.3, 0.8), (0.0, 0.5), (0.5, 0.0)])
def test_steps_arrive_when_their_way_does(rising_s: float, falling_s: float) -> None:
    """A pulse of three seconds, against the lag of a step in closed form."""
    time_s = 0.1 * np.arange(200)
    command = np.where((time_s > 5.0) & (time_s <= 8.0), 9.0, 6.0)  # in force over the interval that ends at its row
    got = pressure(plant("each_way", rising_s, falling_s), time_s, command)
    up, down = (np.clip(time_s - at, 0.0, None) for at in (5.0 + rising_s, 8.0 + falling_s))
    want = 6.0 + 3.0 * -np.expm1(-up / 0.2)
    fallen = 6.0 + (3.0 * -np.expm1(-(3.0 + falling_s - rising_s) / 0.2)) * np.exp(-down / 0.2)
    np.testing.assert_allclose(got, np.where(down > 0.0, fallen, want), atol=1e-6)


def test_alike_both_ways_it_is_a_pure_delay() -> None:
    time_s = 0.1 * np.arange(200)
    command = 8.0 + np.sin(time_s)
    both, one = (pressure(plant(*form), time_s, command) for form in (("each_way", 0.4, 0.4), ("pure_delay", 0.4)))
    np.testing.assert_array_equal(both, one)


@pytest.mark.thorough
@pytest.mark.parametrize("delays_s", [(0.5, 0.3), (0.2, 0.6)])
def test_it_is_found_and_needs_no_second_cause(delays_s: tuple[float, float]) -> None:
    """A delay that is the same both ways would leave so much that an asymmetry of the ports is named beside it."""
    result, judgement = judged(a_record(plant("each_way", *delays_s)), DESIGN)
    assert [c.name for c in judgement.causes] == ["dead_time"]
    assert result.decisions[0].accepted.values()[-2:] == pytest.approx(delays_s, abs=0.02)
