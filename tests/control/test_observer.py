"""What the observer learns on a virtual valve that is not as designed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from app.physics_bench import open_virtual
from control.controller import Seen, controller_names, make_controller
from control.design import DesignModel
from control.observer import Inside, Observer, follow
from control.prediction import predict_positions
from hal.sample import Reading, Sample

DESIGN = DesignModel()
TICK_S = 0.1


def watch(
    commands: np.ndarray, numbers: Mapping[str, float] | None = None, effects: Mapping[str, float] | None = None
) -> tuple[Inside, float]:
    """The estimate after these commands, and where the stem really is."""
    opened = open_virtual(2, numbers=numbers, effects=effects)
    assert opened.truth_in is not None
    observer = Observer(DESIGN)
    inside: Inside | None = None
    for tick, command in enumerate(commands):
        opened.clock.sleep_until(tick * TICK_S)
        sample = opened.bench.exchange(float(command))
        assert sample.pressure is not None
        seen = Seen(sample.position.value, sample.pressure.value, sample.commanded_psi)
        inside = observer.start(seen) if inside is None else observer.track(inside, seen, TICK_S, 1.0)[0]
    assert inside is not None
    return inside, opened.truth_in()


UP_AND_DOWN = np.repeat([5.0, 10.0, 10.6, 7.4, 7.0, 10.3, 7.2], 150)


def test_on_the_valve_as_designed_it_stays_with_the_design() -> None:
    inside, stem_in = watch(UP_AND_DOWN)
    assert inside.a1 == pytest.approx(8.78, abs=0.05)
    assert inside.a2 == pytest.approx(5.82, abs=0.05)
    assert inside.x == pytest.approx(stem_in, abs=0.002)
    assert inside.line.ticks == 0


def test_it_learns_both_edges_of_a_wider_deadband() -> None:
    inside, _ = watch(UP_AND_DOWN, {"a1": 9.076, "a2": 5.524})
    assert inside.a1 == pytest.approx(9.076, abs=0.06)
    assert inside.a2 == pytest.approx(5.524, abs=0.06)


def test_it_learns_a_span_error() -> None:
    inside, _ = watch(UP_AND_DOWN, effects={"ep_calibration/zero": 0.3})
    assert inside.settles(7.2) == pytest.approx(7.5, abs=0.03)
    assert inside.command_for(inside.settles(7.2)) == pytest.approx(7.2, abs=0.02)


def test_it_learns_a_dead_time() -> None:
    inside, _ = watch(UP_AND_DOWN, effects={"dead_time": 0.3})
    assert inside.line.ticks == 3


def test_the_lag_is_exact_with_and_without_the_rate_limit() -> None:
    assert follow(0.0, 0.1, 2.7, 0.12, 1.0) == pytest.approx(0.1 * (1.0 - np.exp(-1.0 / 2.7)))
    x = 0.0
    for _ in range(100_000):
        x += min(max((0.5 - x) / 2.7, -0.12), 0.12) * 4.0 / 100_000
    assert follow(0.0, 0.5, 2.7, 0.12, 4.0) == pytest.approx(x, abs=1e-5)


def test_many_plans_at_once_are_the_same_plans_one_by_one() -> None:
    observer = Observer(DESIGN)
    inside = observer.start(Seen(0.2, 9.0, 9.0))
    plans = np.array([[12.0] * 15, [4.0] * 15, [9.0] * 15])
    together = predict_positions(observer, inside, plans, TICK_S)
    for plan, positions in zip(plans, together, strict=True):
        one = inside
        for command in plan:
            one = observer.ahead(one, float(command), TICK_S)
        assert positions[-1] == pytest.approx(one.x, abs=0.003)


@pytest.mark.parametrize("name", controller_names())
def test_a_stem_without_a_lag_breaks_no_controller(name: str) -> None:
    """The model file allows it, and so does a record in which none is seen."""
    law = make_controller(name, DesignModel(tau_s=0.0))
    state, command_psi = law.initial(_sample(0.0, 5.0), 0.3), 5.0
    for tick in range(1, 60):
        state, command_psi = law.step(state, _sample(0.1 * tick, command_psi), 0.3, 0.1)
        assert np.isfinite(command_psi)


def _sample(time_s: float, command_psi: float) -> Sample:
    position_in = min(max(0.19 * (command_psi - 8.0), 0.0), 0.5625)
    return Sample(time_s, command_psi, Reading(position_in, time_s, 0.0), Reading(command_psi, time_s, 0.0))
