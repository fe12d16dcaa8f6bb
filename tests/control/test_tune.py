"""Numbers from a design, and the describing function's margins."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.analysis.limit_cycle import predict
from control.analysis.loop import LinearLoop
from control.controller import controller_names, make_controller
from control.design import DesignModel
from control.tune import CAP, hunts, margins, tune
from hal.errors import BadInput

DESIGN = DesignModel()


def test_every_controller_is_tuned() -> None:
    tuned = tune(DESIGN, 0.1)
    assert sorted(t.controller for t in tuned) == sorted(controller_names())
    for t in tuned:
        make_controller(t.controller, DESIGN, **t.settings)


def test_the_reasons_are_what_decided() -> None:
    by_name = {t.controller: t for t in tune(DESIGN, 0.1)}
    capped, limited = by_name["pi"], by_name["p_incremental"]
    assert capped.settings["kp"] == pytest.approx(CAP / DESIGN.compliance, rel=0.01)
    assert "cap" in capped.why
    assert limited.settings["kp"] < CAP / DESIGN.compliance
    assert "2 times" in limited.why and limited.margins is not None
    assert limited.margins.gain == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize("kp", [2.0, 2.6, 2.9, 4.0])
def test_hunting_is_where_an_intersection_is(kp: float) -> None:
    loop = LinearLoop("p_incremental", kp)
    assert hunts(loop, DESIGN) == any(cycle.stable for cycle in predict(loop, DESIGN))


def test_a_delay_costs_an_incremental_law_more_in_its_position_than_in_its_pressure() -> None:
    """For `p` and `pi` the loop does not tell the two apart."""
    incremental, pi = margins(LinearLoop("p_incremental", 1.36), DESIGN), margins(LinearLoop("pi", 26.3, 9.75), DESIGN)
    assert incremental.late_s < 2.0 < incremental.delay_s
    assert pi.late_s == pytest.approx(pi.delay_s, rel=1e-6)


@pytest.mark.parametrize("kp", [86.0, 88.0])
def test_a_margin_below_the_first_look_is_no_larger_than_it_is(kp: float) -> None:
    loop = LinearLoop("p", kp)
    found = margins(loop, DESIGN)
    assert 0.0 < found.delay_s < 0.05
    assert not hunts(replace(loop, dead_time_s=found.delay_s), DESIGN)
    assert hunts(replace(loop, dead_time_s=1.02 * found.delay_s), DESIGN)


def test_a_loop_that_hunts_as_it_is_has_no_margin() -> None:
    found = margins(LinearLoop("p", 95.0), DESIGN)
    assert (found.delay_s, found.late_s) == (0.0, 0.0)
    assert found.gain == pytest.approx(89.4 / 95.0, rel=0.02)


def test_unusable_designs_are_refused() -> None:
    with pytest.raises(BadInput, match="no deadband"):
        tune(replace(DESIGN, a1=5.82), 0.1)
    with pytest.raises(BadInput, match="has no lag"):
        tune(replace(DESIGN, tau_s=0.0), 0.1)
    with pytest.raises(BadInput, match="percent"):
        tune(replace(DESIGN, pressure_unit="percent"), 0.1)
