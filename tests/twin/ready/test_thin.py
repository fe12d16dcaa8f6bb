"""The look at a large case: which rows stay, what command they carry, and that the model cannot tell the difference."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.toy_valve import Toy, record, staircase
from twin.fit.case import Case, make_case
from twin.fit.channel import predict_reading
from twin.judge.heldout import predict_heldout
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.ready import thin
from twin.ready.thin import look_at
from twin.record.rows import kept_rows, thinned
from twin.replay.simulate import simulate_recording


@pytest.fixture(scope="module")
def toy() -> Recording:
    levels = np.random.default_rng(1).uniform(5.0, 12.0, 30).tolist()
    return record(Toy(), staircase(0.05, 10.0, levels), 0.05, seed=1, sigma=8e-4)


def look(
    case: Case, monkeypatch: pytest.MonkeyPatch, most_rows: int = 1000, most_s: float = 1e9, coarse_s: float = 0.0
) -> Case:
    monkeypatch.setattr(thin, "MOST_ROWS", most_rows)
    monkeypatch.setattr(thin, "LOOK_ROWS", most_rows)
    monkeypatch.setattr(thin, "MOST_S", most_s)
    monkeypatch.setattr(thin, "MOST_STEPS", 1)
    monkeypatch.setattr(thin, "COARSE_S", coarse_s)
    monkeypatch.setattr(thin, "COARSE_ROWS", most_rows)
    monkeypatch.setattr(thin, "LOOK_S", 100.0)
    monkeypatch.setattr(thin, "_WINDOW_S", 50.0)
    return look_at(case)[0]


def test_ends_and_both_sides_of_every_jump_stay() -> None:
    command = np.repeat([5.0, 9.0, 7.0, 7.0, 11.0], 200)
    rows = kept_rows(command, 100)
    assert {0, 199, 200, 399, 400, 799, 800, 999} <= set(rows.tolist())
    assert 60 < rows.size <= 110


def test_a_command_that_always_moves_is_thinned_all_the_same() -> None:
    rows = kept_rows(np.cumsum(np.random.default_rng(0).standard_normal(10_000)), 500)
    assert rows.size <= 800


def test_a_short_record_is_left_alone(toy: Recording) -> None:
    case = make_case([toy], DesignModel())
    seen, notes = look_at(case)
    assert seen is case
    assert notes == []


def test_the_model_predicts_the_same_at_the_rows_that_stay(toy: Recording) -> None:
    rows = kept_rows(toy.command, 600)
    few = thinned(toy, rows)
    every = simulate_recording(DesignModel(), toy)[1]
    assert few.n < 0.15 * toy.n
    later = few.time_s > 40.0  # the start is told from other readings
    assert simulate_recording(DesignModel(), few)[1][later] == pytest.approx(every[rows][later], abs=5e-5)


def test_a_ramp_keeps_its_mean() -> None:
    time_s = np.arange(0.0, 10.0, 0.1)
    ramp = Recording("ramp", time_s, time_s.copy(), np.zeros(100))
    few = thinned(ramp, np.array([0, 10, 40, 99]))
    assert few.command[1:] == pytest.approx([0.55, 2.55, 7.0])


def test_a_gap_among_the_rows_left_out_is_remembered() -> None:
    gaps = np.zeros(10, dtype=bool)
    gaps[4] = True
    recording = Recording("gap", np.arange(10.0), np.zeros(10), np.zeros(10), gap_before=gaps)
    marked = thinned(recording, np.array([0, 3, 6, 9])).gap_before
    assert marked is not None
    assert marked.tolist() == [False, False, True, False]


def test_false_readings_stay_out(toy: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    bad = np.zeros(toy.n, dtype=bool)
    bad[::2] = True
    seen = look(make_case([toy], DesignModel(), (), [bad]), monkeypatch)
    rows = np.searchsorted(toy.time_s, seen.recordings[0].time_s)
    assert not (seen.trials[0].use_y & bad[rows]).any()


@pytest.mark.parametrize("hole", [False, True])
def test_steps_are_unseen_among_missing_rows_and_not_among_those_left_out(
    toy: Recording, monkeypatch: pytest.MonkeyPatch, hole: bool
) -> None:
    swing = 8.5 + 4.0 * np.sin(2.0 * np.pi * toy.time_s / 8.0)
    lively = replace(toy, command=np.where(toy.time_s % 60.0 < 10.0, swing, toy.command))
    lost = (toy.time_s > 122.0) & (toy.time_s < 123.5) & hole  # within a swing the command moves on
    kept = np.flatnonzero(~lost)
    lively = replace(lively, **{name: getattr(lively, name)[kept] for name in ("time_s", "command", "position")})
    case = make_case([replace(lively, pressure=None)], DesignModel())
    seen = look(case, monkeypatch, most_rows=2000, coarse_s=1e9)
    assert len(seen.spans) == 1 and seen.recordings[0].n < 0.5 * lively.n
    vague_s = seen.recordings[0].time_s[seen.trials[0].vague]
    assert bool(vague_s.size) is hole
    assert ((vague_s > 123.0) & (vague_s < 127.0)).all()


def test_windows_are_spread_and_lively(toy: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    calm = replace(toy, position=np.where(toy.time_s < 100.0, 0.2, toy.position))
    seen = look(make_case([calm], DesignModel()), monkeypatch, most_s=200.0)
    starts = [s.start for s in seen.spans]
    assert len(starts) > 1
    assert starts == sorted(starts)
    assert sum(t.recording.duration_s - t.led_s for t in seen.trials) < 0.95 * calm.duration_s
    assert seen.whole is not None


def test_a_noisy_record_is_looked_at_whole_in_coarse_steps(toy: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    case = make_case([toy], DesignModel())
    seen = look(case, monkeypatch, most_rows=toy.n - 1, most_s=200.0, coarse_s=1e9)
    assert len(seen.spans) == 1 and seen.recordings[0].duration_s == toy.duration_s
    assert seen.trials[0].grid.n_fine < 0.7 * case.trials[0].grid.n_fine
    rather = replace(case, sigma_y=5e-4 * case.travel)
    assert len(look(rather, monkeypatch, most_rows=toy.n - 1, most_s=200.0, coarse_s=1e9).spans) == 1
    quiet = replace(case, sigma_y=1e-5)
    assert len(look(quiet, monkeypatch, most_rows=toy.n - 1, most_s=200.0, coarse_s=1e9).spans) > 1


@pytest.mark.parametrize(("every", "least", "most"), [(1, 0.5, 0.52), (2, 1.0, 1.0)])
def test_in_coarse_steps_rows_that_come_faster_than_these_are_left_out(
    toy: Recording, monkeypatch: pytest.MonkeyPatch, every: int, least: float, most: float
) -> None:
    """At 20 Hz every other row is enough for steps of 0.1 s; at 10 Hz none can be spared."""
    rows = np.arange(0, toy.n, every)
    case = make_case([thinned(toy, rows)], DesignModel())
    look(case, monkeypatch, most_rows=rows.size - 1, most_s=200.0, coarse_s=1e9)
    monkeypatch.setattr(thin, "COARSE_ROWS", rows.size)
    monkeypatch.setattr(thin, "LOOK_ROWS", rows.size // 3)
    seen = look_at(case)[0]
    assert seen is not case
    assert least <= seen.recordings[0].n / rows.size <= most
    monkeypatch.setattr(thin, "LOOK_ROWS", rows.size)
    assert look_at(case)[0].recordings[0].n == rows.size


def test_a_window_is_compared_from_its_first_row_on_and_its_history_is_not(
    toy: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = look(make_case([toy], DesignModel()), monkeypatch, most_s=200.0)
    assert any(span.history == 0 < span.start for span in seen.spans)
    for span, trial in zip(seen.spans, seen.trials, strict=True):
        time_s = trial.recording.time_s
        assert time_s[0] == toy.time_s[span.history]
        assert trial.led_s == toy.time_s[span.start] - time_s[0]
        for use in (trial.use_p, trial.use_y):
            first_s = float(time_s[np.flatnonzero(use)[0]] - time_s[0])
            assert trial.led_s <= first_s < trial.led_s + 5.0


def test_a_window_remembers_what_was_long_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tail of 100 s of a stroke that was over a minute before: from the window alone nobody could know of it."""
    levels = np.random.default_rng(1).uniform(5.0, 12.0, 120).tolist()
    long = record(Toy(), staircase(0.05, 10.0, levels), 0.05, seed=1, sigma=8e-4)
    seen = look(make_case([long], DesignModel()), monkeypatch, most_s=1000.0)
    slow = Plant(DesignModel(), (Inserted("creep", effect("creep").form("one_tail"), (0.3, 100.0)),))
    whole = predict_reading(slow, make_case([long], DesignModel()).trials[0])
    span, trial = seen.spans[-1], seen.trials[-1]
    assert span.history > 0  # the record is longer than what is remembered of it
    rows = np.searchsorted(long.time_s, trial.recording.time_s[trial.use_y])
    apart = (predict_reading(slow, trial)[trial.use_y] - whole[rows]) / DesignModel().travel
    assert float(np.sqrt(np.mean(apart**2))) < 5e-4
    steps_s, began_s = np.diff(trial.grid.fine_time_s), trial.grid.fine_time_s[1:] - trial.recording.time_s[0]
    assert np.median(steps_s[began_s < 0.8 * trial.led_s]) > 3.0 * np.median(steps_s[began_s > trial.led_s])


@pytest.mark.parametrize("most_s", [1e9, 200.0])
def test_held_out_errors_cover_all_rows(toy: Recording, monkeypatch: pytest.MonkeyPatch, most_s: float) -> None:
    case = make_case([toy], DesignModel())
    seen = look(case, monkeypatch, most_s=most_s)
    error = predict_heldout(seen, seen.base, [], [])
    assert error.shape == (toy.n,)
    assert np.isfinite(error[case.trials[0].use_y]).all()
    assert error == pytest.approx(predict_heldout(case, case.base, [], []), nan_ok=True)


def test_what_a_coarse_reading_leaves_open_stays_open_in_a_look(
    toy: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A stem at rest, read in steps of 5 %, may stand anywhere within a code, in a look as in the whole."""
    step = 0.05 * DesignModel().travel
    coarse = replace(toy, position=step * np.round(toy.position / step))
    blurred, sharp = (make_case([coarse], DesignModel(), step=step, sharp=sharp) for sharp in (False, True))
    assert look(blurred, monkeypatch, coarse_s=1e9).trials[0].begun.unsure_s == 0.0
    begun = look(sharp, monkeypatch, coarse_s=1e9).trials[0].begun
    assert begun.unsure_s == pytest.approx(sharp.trials[0].begun.unsure_s, abs=1.0)
    assert begun.unsure_s > 5.0
