"""Readings that are reported only when they have changed enough: told from slow and from coarse ones, and replayed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import a_record
from twin.diagnose import Outcome, Settings, diagnose
from twin.events.on_change import on_change
from twin.events.refresh import freshness
from twin.fit.channel import position_channel
from twin.fit.trial import make_trial
from twin.kernels.sensor import report_on_change
from twin.live.twin import LiveTwin
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.noise.model import estimate_noise
from twin.record.held_noise import as_reported
from twin.record.sensing import sense
from twin.replay.simulate import Start, simulate_recording
from twin.search.candidates import effect_causes
from twin.search.search_rules import SearchRules

DESIGN = DesignModel()
BAND_IN = 0.02
REPORTED = Inserted("sensor_quantization", effect("sensor_quantization").form("on_change"), (BAND_IN,))
LATE = Inserted("additional_lag", effect("additional_lag").form("behind_stem"), (0.8,))


def reported(record: Recording, band: float = BAND_IN) -> Recording:
    held = record.position.copy()
    report_on_change(held, band)
    return replace(record, position=held)


def answered(record: Recording) -> Outcome:
    return diagnose([record], DESIGN, settings=Settings(search=SearchRules(most=1)))


def walk(seed: int, size: int = 4000) -> FloatArray:
    """A reading that creeps and turns, with noise."""
    dice = np.random.default_rng(seed)
    return np.asarray(0.1 * np.sin(np.arange(size) / 50.0) + 0.001 * dice.normal(size=size))


@settings(max_examples=25, deadline=None)
@given(st.floats(0.003, 0.02), st.integers(0, 100))
def test_the_band_is_found(band: float, seed: int) -> None:
    y = walk(seed)
    report_on_change(y, band)
    evidence = on_change(y, None, "in")
    assert evidence.found
    assert band <= evidence.estimates["band"].value < 1.05 * band


@settings(max_examples=25)
@given(st.integers(0, 100), st.integers(2, 12))
def test_slow_coarse_and_noisy_readings_are_none(seed: int, every: int) -> None:
    y = walk(seed)
    assert not on_change(y, None, "in").found
    assert not on_change(np.repeat(y[::every], every), None, "in").found
    assert not on_change(0.01 * np.round(y / 0.01), 0.01, "in").found


def test_what_it_needs() -> None:
    steps = np.repeat([0.0, 1.0], 50)
    assert "fewer than 30 changes" in on_change(steps, None, "in").note
    far = np.cumsum(np.concatenate([[0.1], np.geomspace(1.0, 1e6, 60)]))
    assert "far larger" in on_change(far, None, "in").note


def test_it_holds_until_it_has_changed_enough() -> None:
    y = np.array([0.0, 0.5, 1.0, 1.01, 1.5, 0.0, -1.2])
    report_on_change(y, 1.0)
    assert y.tolist() == [0.0, 0.0, 0.0, 1.01, 1.01, 0.0, -1.2]


@pytest.mark.thorough
def test_a_healthy_valve_that_is_reported_on_change_has_this_and_nothing_else() -> None:
    found = answered(reported(a_record(Plant(DESIGN), twice=True))).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("sensor_quantization", "on_change")]
    assert found.causes[0].parameters["step"].value == pytest.approx(BAND_IN, rel=0.05)


@pytest.mark.thorough
def test_what_else_is_wrong_shows_beside_it() -> None:
    found = answered(reported(a_record(Plant(DESIGN, (LATE,)), twice=True))).diagnosis
    names = {c.name for c in found.causes}
    assert "sensor_quantization" in names and names & {"additional_lag", "sensor_lag"} and len(names) == 2


def test_the_model_reports_as_the_valve_did_or_by_its_band() -> None:
    plant = Plant(DESIGN, (REPORTED,))
    record = reported(a_record(Plant(DESIGN)))
    seen = simulate_recording(plant, record)[1]
    assert np.array_equal(np.diff(seen) == 0.0, np.diff(record.position) == 0.0)
    live = LiveTwin(plant, 0.0, 12.0, Start(12.0, 0.0, 0.0), 60.0)
    own = np.array([live.step(0.1 * k, 12.0)[1] for k in range(1, 100)])
    moved = np.abs(np.diff(own))
    assert np.min(moved[moved > 0.0]) > BAND_IN and np.mean(moved == 0.0) > 0.3
    told = LiveTwin(plant, 0.0, 12.0, Start(12.0, 0.0, 0.0), 60.0)
    assert np.ptp([told.step(0.1 * k, 12.0, fresh=False)[1] for k in range(1, 100)]) == 0.0


def test_two_recordings_have_to_agree_about_the_band() -> None:
    plain, held = a_record(Plant(DESIGN), n=2400), reported(a_record(Plant(DESIGN), n=2400))
    noise = estimate_noise([plain])

    def band(*records: Recording) -> float:
        return sense(list(records), noise, DESIGN).band

    assert band(held, held) == pytest.approx(BAND_IN, rel=0.05)
    assert band(held, plain) == band(held, reported(plain, 2.0 * BAND_IN)) == 0.0


def test_what_is_reported_on_change_carries_the_largest_of_many_errors() -> None:
    """Of a stem that creeps past the band it is the largest error that is reported, in the direction of the way."""
    rng = np.random.default_rng(3)
    way = np.arange(40_000) * 0.02  # a fiftieth of a standard deviation from reading to reading
    y = way + rng.standard_normal(way.size)
    report_on_change(y, 20.0)
    new = np.flatnonzero(np.diff(y) != 0.0) + 1
    assert np.mean((y - way)[new]) > 1.5
    noise = estimate_noise([a_record(Plant(DESIGN))])
    assert as_reported(noise).position.sigma == 1.5 * noise.position.sigma


def test_where_it_is_settled_how_readings_are_held_nothing_else_is_tried() -> None:
    record = reported(a_record(Plant(DESIGN)))
    for base, tried in ((Plant(DESIGN), True), (Plant(DESIGN, (REPORTED,)), False)):
        trial = replace(make_trial(record, 0.05), fresh=freshness(record))
        causes = effect_causes(position_channel([trial.with_pressure(np.zeros(trial.grid.n_fine))], 0.001), base)
        assert ("as_seen" in {c.form.name for c in causes if c.form is not None}) is tried
