"""The closed loop in figures, as recorded and as a model predicts it."""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np
import pytest

from control.controller import make_controller
from control.design import DesignModel
from hal.sample import Reading, Sample
from logs.recording import Recording
from twin.judge.closed_loop import closed_loop, holds, judge_loop
from twin.live.twin import LiveTwin
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

TARGETS = (0.1, 0.4, 0.25)
STICKY = Plant(DesignModel(), (Inserted("stiction", effect("stiction").forms[0], (0.5, 2e-3)),))


def recorded(plant: Plant, name: str = "pi", hold_s: float = 60.0) -> Recording:
    """A loop around `plant` at 10 Hz, tick by tick as the bench does it: write, read, decide."""
    controller = make_controller(name, DesignModel())
    rows, n = [], round(hold_s / 0.1)
    twin = LiveTwin.at_rest(plant, 0.0, 0.0, 0.0, 0.0, 180.0)
    before = sent = 0.0
    state = None
    for k in range(n * len(TARGETS)):
        p, y = twin.step(0.1 * k, before)
        rows.append((0.1 * k, before, p, y, TARGETS[k // n]))
        sample = Sample(0.1 * k, sent, Reading(y, 0.0, 0.0), Reading(p, 0.0, 0.0))
        state = controller.initial(sample, TARGETS[0]) if state is None else state
        before = sent
        state, sent = controller.step(state, sample, TARGETS[k // n], 0.1)
    t, u, p, y, target = np.array(rows).T
    named = {"name": name, "settings": dict(controller.settings)}
    meta = {"run": {"controller": named, "design": asdict(DesignModel())}}
    return Recording("loop", t, u, y, p, target, meta=meta)


def table(document: dict[str, object], key: str) -> dict[str, float]:
    found = document[key]
    assert isinstance(found, dict)
    return found


def test_nothing_to_say_about_an_open_loop() -> None:
    record = recorded(Plant(DesignModel()), hold_s=10.0)
    assert closed_loop([replace(record, target=None)], Plant(DesignModel())) == {}


def test_the_model_that_is_the_valve_predicts_its_loop() -> None:
    record = recorded(STICKY)
    said = closed_loop([record], STICKY)
    assert said["predicted_from"] == "the record's own controller around the model"
    assert said["holds"] == 3
    for key in ("steady_error_percent_of_travel", "limit_cycle_percent_of_travel", "never_settled"):
        assert table(said, key)["predicted"] == pytest.approx(table(said, key)["recorded"], abs=1e-6)


def test_the_model_without_the_effect_misses_what_the_loop_does() -> None:
    errors = table(
        closed_loop([recorded(STICKY, "if_then_pi")], Plant(DesignModel())), "steady_error_percent_of_travel"
    )
    assert errors["recorded"] - errors["predicted"] > 1.0


def test_all_records_with_targets_count_and_settling_is_compared_where_both_settle() -> None:
    calm, sticky = recorded(Plant(DesignModel())), recorded(STICKY)
    one, both = closed_loop([sticky], Plant(DesignModel())), closed_loop([calm, sticky], Plant(DesignModel()))
    assert (one["holds"], both["holds"]) == (3, 6)
    assert both["records"] == ["loop", "loop"]
    errors = [table(said, "steady_error_percent_of_travel")["recorded"] for said in (one, both)]
    assert errors[0] == errors[1]  # the worst is the sticky one's
    assert table(one, "never_settled")["recorded"] > 0
    unsettled = max(table(both, "never_settled").values())
    assert both["settled_in_both"] == 6 - unsettled
    [alone] = [closed_loop([calm], Plant(DesignModel()))]
    times = table(alone, "settling_s")
    assert times["predicted"] == pytest.approx(times["recorded"], abs=0.2)


def test_a_strangers_record_is_judged_on_its_own_command() -> None:
    record = replace(recorded(Plant(DesignModel())), meta={})
    said = closed_loop([record], Plant(DesignModel()))
    assert said["predicted_from"] == "the recorded command replayed"
    errors = table(said, "steady_error_percent_of_travel")
    assert errors["predicted"] == pytest.approx(errors["recorded"], abs=0.02)


@pytest.mark.parametrize("unknown", [slice(0, 600), slice(600, 1200), slice(300, 301)])
def test_where_no_target_is_known_the_recorded_command_goes_on(unknown: slice) -> None:
    record = recorded(Plant(DesignModel()))
    assert record.target is not None
    target = record.target.copy()
    target[unknown] = np.nan
    said = closed_loop([replace(record, target=target)], Plant(DesignModel()))
    errors = table(said, "steady_error_percent_of_travel")
    assert errors["predicted"] == pytest.approx(errors["recorded"], abs=1.0)


def test_holds_are_stretches_with_one_target() -> None:
    record = recorded(Plant(DesignModel()), hold_s=10.0)
    assert [(part.start, part.stop) for part in holds(record)] == [(0, 100), (100, 200), (200, 300)]
    assert record.target is not None
    short = record.target.copy()
    short[100:200] = np.nan
    assert [part.start for part in holds(replace(record, target=short))] == [0, 200]


def test_a_swing_is_a_limit_cycle_and_a_constant_error_is_none() -> None:
    record = recorded(Plant(DesignModel()), hold_s=60.0)
    assert record.target is not None
    off = record.target + 0.02 * 0.5625
    swing = off + 0.01 * 0.5625 * np.sin(2 * np.pi * record.time_s / 8.0)
    calm, restless = (judge_loop(record, x, 0.5625) for x in (off, swing))
    assert calm.steady_error == pytest.approx(2.0)
    assert calm.limit_cycle == 0.0
    assert restless.limit_cycle == pytest.approx(2.0, rel=0.1)
    assert restless.never_settled >= 2
    noise = 0.0006 * 0.5625 * np.random.default_rng(2).standard_normal(off.size)
    noisy, smooth = judge_loop(record, off + noise, 0.5625), judge_loop(record, swing + noise, 0.5625)
    assert noisy.limit_cycle == 0.0 and smooth.limit_cycle == pytest.approx(restless.limit_cycle, rel=0.2)
