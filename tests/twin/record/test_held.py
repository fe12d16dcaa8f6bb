"""Readings that are seen to be held are replayed as they were held; what else is wrong shows beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import a_record
from twin.choose.rules import DecisionRules
from twin.choose.stages import judge
from twin.diagnose import Settings, _prepared, diagnose
from twin.events.refresh import fresh_rows, freshness, new_only, refreshed_together
from twin.fit.case import make_case
from twin.judge.partial import Known
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, reading_response
from twin.model.timegrid import make_grid
from twin.noise.model import estimate_noise
from twin.ready.thin import look_at
from twin.record.held_noise import noise_of_refreshed
from twin.replay.simulate import simulate_recording
from twin.search.candidates import effect_causes
from twin.search.search_rules import SearchRules

AS_SEEN = Inserted("stale_samples", effect("stale_samples").form("as_seen"), ())
_SIGNALS = ("time_s", "command", "position")
CREEP = Inserted("creep", effect("creep").form("one_tail"), (0.05, 40.0))


def held(reading: FloatArray, seed: int = 3) -> FloatArray:
    """The reading refreshed every one to twelve rows, at no rhythm."""
    dice = np.random.default_rng(seed)
    new = np.zeros(reading.size, dtype=bool)
    new[np.cumsum(dice.integers(1, 13, reading.size)) % reading.size] = True
    rows = np.maximum.accumulate(np.where(new, np.arange(reading.size), 0))
    return np.asarray(reading[rows])


@pytest.fixture(scope="module")
def stale() -> Recording:
    """A creeping valve whose reading is held."""
    record = a_record(Plant(DesignModel(), (CREEP,)), twice=True, n=2400)
    return replace(record, position=held(record.position))


def test_a_row_is_as_fresh_as_the_last_change() -> None:
    reading = np.array([1.0, 1.0, 2.0, 2.0, 2.0, np.nan, 3.0, 1.0])
    assert fresh_rows(reading).tolist() == [0, 0, 2, 2, 2, 5, 6, 7]


def test_held_readings_are_measured_without_repeats_where_it_is_known_why_these_differ() -> None:
    """Two strokes that were not refreshed at the same instants differ while the stem moves: that is no noise."""
    record, new = a_record(Plant(DesignModel(), (CREEP,)), twice=True, n=2400), np.zeros(2400, dtype=bool)
    new[np.minimum(np.cumsum(np.random.default_rng(3).integers(1, 4, 2400)), 2399)] = True
    rows = np.maximum.accumulate(np.where(new, np.arange(2400), 0))
    readings = [replace(record, position=record.position[rows])]
    noise = estimate_noise(readings, repeats=False)
    by_repeats, calm = (noise_of_refreshed(readings, noise, repeats).position for repeats in (True, False))
    assert by_repeats.source == "repeats" != calm.source
    assert "repeats" not in calm.by_source and by_repeats.sigma > 1.4 * calm.by_source["still"]
    known, quiet = Known((readings[0],), Plant(DesignModel())), lambda _what, _share: None
    searched = (_prepared(known, Settings(), quiet, repeats)[0].noise.position for repeats in (True, False))
    assert [noise.source == "repeats" for noise in searched] == [True, False]


def test_a_replay_holds_what_the_record_held(stale: Recording) -> None:
    model = Plant(DesignModel(), (CREEP,))
    _, plain = simulate_recording(model, stale)
    _, again = simulate_recording(Plant(model.design, (CREEP, AS_SEEN)), stale)
    np.testing.assert_array_equal(again, plain[fresh_rows(stale.position)])
    assert np.std(stale.position - again) < 0.5 * np.std(stale.position - plain)


@pytest.mark.thorough
def test_held_readings_are_a_candidate_only_where_they_are_seen(stale: Recording) -> None:
    for seen in (False, True):
        case = make_case([stale], DesignModel(), held=seen)
        channel = judge(case, SearchRules(most=1), DecisionRules(), lambda _w, _s: None).decisions[-1].findings.channel
        assert ("as_seen" in {c.form.name for c in effect_causes(channel) if c.form}) is seen


@pytest.mark.thorough
def test_what_else_is_wrong_shows_beside_held_readings(stale: Recording) -> None:
    case = make_case([stale], DesignModel(), held=True)
    result = judge(case, SearchRules(most=2), DecisionRules(), lambda _w, _s: None)
    assert set(result.causes) == {"creep", "stale_samples"}
    [creep] = [one for one in result.plant().inserted if one.effect == "creep"]
    assert creep.values[0] == pytest.approx(0.05, abs=0.01)


@pytest.mark.thorough
def test_the_updated_model_holds_the_readings_of_another_record() -> None:
    """What is seen in events and fitted as well is in the model: a record that it has not met has its own refreshes."""
    healthy = a_record(Plant(DesignModel()))
    met, fresh = (replace(healthy, position=held(healthy.position, seed)) for seed in (3, 4))
    outcome = diagnose([met], DesignModel(), (), Settings(search=SearchRules(most=1)))
    assert [c.name for c in outcome.diagnosis.causes] == ["stale_samples"]
    before, after = (simulate_recording(model, fresh)[1] for model in (DesignModel(), outcome.model))
    assert np.std(fresh.position - after) < 0.1 * np.std(fresh.position - before)


@pytest.mark.thorough
def test_a_look_at_part_of_the_rows_knows_when_they_were_fresh(stale: Recording) -> None:
    parts = [replace(stale, time_s=stale.time_s + k * (stale.time_s[-1] + 0.2)) for k in range(12)]
    time_s, command, position = (np.concatenate([getattr(p, n) for p in parts]) for n in _SIGNALS)
    long = Recording("long", time_s, command, position, None)
    case = make_case([long], DesignModel(), held=True)
    look, _ = look_at(case)
    [trial] = look.trials
    assert look is not case and trial.fresh is not None
    rows = np.searchsorted(long.time_s, trial.recording.time_s)
    whole = fresh_rows(long.position)
    for k in range(0, rows.size, 97):
        assert trial.fresh.rows[k] == max(j for j in range(k + 1) if rows[j] <= max(whole[rows[k]], rows[0]))


def test_one_slow_converter_for_both_signals_is_told_from_a_slow_position(stale: Recording) -> None:
    assert stale.pressure is not None
    coarse = replace(stale, pressure=np.round(stale.pressure / 0.05) * 0.05)
    both = replace(stale, pressure=stale.pressure[fresh_rows(stale.position)])
    told = [refreshed_together(r) for r in (stale, coarse, both, replace(stale, pressure=None))]
    assert told == [False, False, True, False]


def test_a_buffered_reading_is_the_one_before() -> None:
    """A stem that goes evenly is read where it was a refresh before; of rows that are left out the refreshes count."""
    time_s, period_s = 0.1 * np.arange(400), 0.5
    c = Plant(DesignModel(), (Inserted("stale_samples", effect("stale_samples").form("buffered"), (0.0,)),))
    grid, stem = make_grid(time_s, 0.02), 0.01 * np.linspace(0.0, 39.9, 1996)
    fresh = freshness(Recording("r", time_s, np.zeros(400), np.repeat(0.01 * time_s[::5], 5)))
    reading = reading_response(c.coefficients(40.0), grid, stem, np.zeros_like(stem), fresh)
    assert (0.01 * fresh.taken_s - reading)[5:] / 0.01 == pytest.approx(np.full(395, period_s), abs=1e-5)
    some = np.arange(100, 400, 7)
    np.testing.assert_allclose(
        fresh.kept(some, time_s).before_s + time_s[100], fresh.taken_s[some] - period_s, atol=1e-5
    )


def through_one_converter() -> Recording:
    """A creeping valve whose pressure and position are refreshed in the same rows, every six or so."""
    record = a_record(Plant(DesignModel(), (CREEP,)), twice=True, n=2400)
    assert record.pressure is not None
    together = fresh_rows(held(record.position))
    return replace(record, position=record.position[together], pressure=record.pressure[together])


def test_of_what_one_slow_converter_repeats_only_the_new_counts() -> None:
    recording = through_one_converter()
    new = new_only(recording)
    said = fresh_rows(recording.position) == np.arange(recording.n)
    assert new.pressure is not None
    assert np.isfinite(new.position).tolist() == said.tolist() == np.isfinite(new.pressure).tolist()
    np.testing.assert_array_equal(new.position[said], recording.position[said])


@pytest.mark.thorough
def test_a_pressure_held_with_the_position_is_no_gap_and_hides_no_cause() -> None:
    found = diagnose([through_one_converter()], DesignModel(), (), Settings(search=SearchRules(most=1))).diagnosis
    assert {c.name for c in found.causes} == {"stale_samples", "creep"}
