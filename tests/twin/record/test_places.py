"""Recordings that share a clock: what drifts goes on from one to the next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import staircase, trial_of
from twin.diagnose import diagnose
from twin.fit.case import make_case
from twin.fit.channel import chain_channel, predict_reading
from twin.kernels.valve_slots import V_DRIFT_RATE
from twin.model.catalog import effect
from twin.model.place import Place
from twin.model.plant import Inserted, Plant
from twin.ready.thin import look_at
from twin.record.places import places
from twin.replay.simulate import Start, simulate_recording
from twin.search.candidates import effect_causes

DESIGN = DesignModel()
DRIFTS = [
    ("lvdt_drift", "linear", (4e-5,)),
    ("lvdt_drift", "warm_up", (0.01, 150.0)),
    ("lvdt_drift", "cycle", (0.004, -0.003, 210.0)),
    ("lvdt_drift", "swing", (0.004, -0.003, 210.0)),
    ("friction_drift", "linear", (6e-4,)),
    ("friction_drift", "warm_up", (0.3, 150.0)),
    ("friction_drift", "from_cold", (0.3, 150.0)),
    ("friction_drift", "sudden", (0.3, 0.2)),
    ("friction_drift", "sudden", (0.3, 0.8)),
]


def blank(begin_s: float, rows: int = 100) -> Recording:
    return Recording("r", begin_s + 0.1 * np.arange(rows), np.full(rows, 8.0), np.zeros(rows))


def test_recordings_one_after_the_other_share_a_clock_in_any_order() -> None:
    found = places([blank(50.0), blank(0.0), blank(20.0)])
    assert [(p.number, p.of, p.since_s) for p in found] == [(0, 3, 50.0), (1, 3, 0.0), (2, 3, 20.0)]
    assert found[0].span_s == pytest.approx(59.9)


@pytest.mark.parametrize("begins", [(0.0, 0.0), (0.0, 5.0), (0.0, 5000.0), (3.0,)])
def test_recordings_with_clocks_of_their_own(begins: tuple[float, ...]) -> None:
    found = places([blank(begin_s) for begin_s in begins])
    assert [replace(p, before_s=0.0, all_s=0.0) for p in found] == [Place(k, len(begins)) for k in range(len(begins))]
    assert [p.before_s for p in found] == pytest.approx([9.9 * k for k in range(len(begins))])


def test_friction_may_go_on_drifting_though_each_has_a_clock_of_its_own() -> None:
    rate = Inserted("friction_drift", effect("friction_drift").form("goes_on"), (1e-3,))
    first, second = (Plant(DESIGN, (rate,)).coefficients(100.0, p) for p in (Place(0, 2), Place(1, 2, before_s=300.0)))
    assert np.allclose(second.close_shift - first.close_shift, 0.3)
    assert np.allclose(first.open_shift - second.open_shift, 0.3)
    assert first.valve[V_DRIFT_RATE] == second.valve[V_DRIFT_RATE] == 1e-3


@pytest.mark.parametrize(("name", "form", "values"), DRIFTS)
def test_a_drift_goes_on_where_the_recording_before_ended(name: str, form: str, values: tuple[float, ...]) -> None:
    plant = Plant(DESIGN, (Inserted(name, effect(name).form(form), values),))
    n, cut = 3000, 1700
    time_s = 0.1 * np.arange(n)
    command = staircase()[:n]
    record = Recording("whole", time_s, command, np.zeros(n))
    pressure, position = simulate_recording(plant, record, start=Start(command[0], 0.0, 0.0))
    whole = replace(record, pressure=pressure, position=position)
    moved = position - simulate_recording(Plant(DESIGN), whole, start=Start(command[0], 0.0, 0.0))[1]
    late = make_case([whole.slice(0, cut), whole.slice(cut, n)], DESIGN).trials[1]
    assert np.abs(moved[cut:]).max() > 0.002
    assert np.abs(predict_reading(plant, late) - late.recording.position)[50:].max() < 1e-3


def test_the_parts_of_a_large_record_share_its_clock() -> None:
    recording = trial_of(Plant(DESIGN), np.tile(staircase(), 30))[0].recording
    look, _notes = look_at(make_case([recording], DESIGN))
    assert len(look.trials) > 1
    assert [t.place.since_s for t in look.trials] == pytest.approx([t.recording.time_s[0] for t in look.trials])
    assert {t.place.span_s for t in look.trials} == {t.place.whole_s for t in look.trials} == {recording.duration_s}
    assert [t.place.within_s for t in look.trials] == [t.place.since_s for t in look.trials]


@pytest.mark.thorough
def test_a_friction_that_drifts_through_two_recordings_is_told() -> None:
    plant = Plant(DESIGN, (Inserted("friction_drift", effect("friction_drift").form("linear"), (4e-4,)),))
    recording = trial_of(plant, staircase())[0].recording
    parts = [recording.slice(0, 1500), recording.slice(1800, 4000)]
    outcome = diagnose(parts, DESIGN, (), UP_TO_TWO)
    (cause,) = outcome.diagnosis.causes
    assert cause.name == "friction_drift"
    assert cause.parameters["rate"].value == pytest.approx(4e-4, rel=0.1)


ANEW = [(name, form, values) for name, form, values in DRIFTS if form in ("linear", "warm_up", "from_cold")]


@pytest.mark.parametrize(("begins", "broken"), [((0.0, 10.0), False), ((0.0, 60.0), True), ((0.0, 0.0), False)])
def test_what_may_begin_anew_stands_trial_where_a_clock_has_breaks(begins: tuple[float, ...], broken: bool) -> None:
    trials = make_case([blank(begin_s) for begin_s in begins], DESIGN).trials
    assert [t.place.broken for t in trials] == [broken, broken]
    forms = {cause.form.name for cause in effect_causes(chain_channel(trials, 0.001)) if cause.form is not None}
    assert ({"linear_anew", "warm_up_anew", "from_cold_anew"} & forms != set()) == broken
    assert "linear" in forms


@pytest.mark.parametrize(("name", "form", "values"), ANEW)
def test_what_begins_anew_does_so_in_each_recording_and_not_in_its_parts(
    name: str, form: str, values: tuple[float, ...]
) -> None:
    as_before = Plant(DESIGN, (Inserted(name, effect(name).form(form), values),))
    begun_anew = Plant(DESIGN, (Inserted(name, effect(name).form(f"{form}_anew"), values),))
    part = Place(1, 2, since_s=940.0, span_s=1000.0, within_s=40.0, whole_s=100.0, broken=True)
    for place, like in ((None, None), (Place(1, 2, 900.0, 1000.0, broken=True), None), (part, Place(since_s=40.0))):
        found, expected = begun_anew.coefficients(60.0, place), as_before.coefficients(60.0, like)
        for what in ("valve", "sensor", "close_shift", "open_shift"):
            np.testing.assert_array_equal(getattr(found, what), getattr(expected, what))


@pytest.mark.thorough
def test_friction_whose_drift_began_anew_on_a_shared_clock_is_told() -> None:
    plant = Plant(DESIGN, (Inserted("friction_drift", effect("friction_drift").form("linear"), (8e-4,)),))
    first, second = (trial_of(plant, staircase(k), k)[0].recording for k in (1, 2))
    later = replace(second, time_s=second.time_s + 3600.0)
    (cause,) = diagnose([first, later], DESIGN, (), UP_TO_TWO).diagnosis.causes
    assert cause.name == "friction_drift"
    assert cause.parameters["rate"].value == pytest.approx(8e-4, rel=0.1)
