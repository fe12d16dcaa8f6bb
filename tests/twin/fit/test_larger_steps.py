"""Looks and slopes in larger steps: about the same directions, the same minimum, fewer steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.fit.channel import Channel, position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.larger_steps import in_larger_steps
from twin.fit.least_squares import jacobian, minimise
from twin.fit.space import Cause, Space, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search import search
from twin.search.screen import Prospect
from twin.search.search import Searcher

CREEP = effect("creep").form("one_tail")


@pytest.fixture(scope="module")
def channel() -> Channel:
    plant = Plant(DESIGN, (Inserted("creep", CREEP, (0.1, 60.0)),))
    return position_channel([trial_of(plant, staircase(k), k)[0] for k in (1, 2)], SIGMA)


@pytest.fixture(scope="module")
def space(channel: Channel) -> Space:
    return make_space(Plant(DesignModel()), (Cause("creep", effect("creep"), CREEP),), channel.numbers, Scales())


def steps(channel: Channel) -> int:
    return sum(trial.grid.n_fine - 1 for trial in channel.trials)


def test_few_steps_are_left_as_they_are(channel: Channel) -> None:
    look = in_larger_steps(channel, least=steps(channel))
    assert look.channel is channel
    assert not look.larger
    np.testing.assert_array_equal(look.rows, np.arange(8_000))


@pytest.mark.parametrize(("larger", "fewer"), [(2.0, 2), (4.0, 4)])  # a row has two steps: rows stay, or go
def test_slopes_are_about_those_of_the_channel(channel: Channel, space: Space, larger: float, fewer: int) -> None:
    look = in_larger_steps(channel, larger, least=100)
    assert look.larger
    assert steps(look.channel) == pytest.approx(steps(channel) / fewer, rel=0.03)
    z = starts_of(space)[0]

    def residuals(at: FloatArray) -> FloatArray:
        return np.concatenate([channel.residuals(space.plant(at)), at / space.spreads])

    exact, about = jacobian(residuals, z, residuals(z), space.steps, space.upper), look.slopes(space, z)
    assert about.shape == exact.shape
    missed = np.linalg.norm(about - exact, axis=0) / np.linalg.norm(exact, axis=0)
    assert np.median(missed) < 0.01
    assert missed.max() < 0.2  # of the top speed, which is met for moments only
    assert missed.max() > 0.0


def test_rows_that_do_not_count_have_no_slope(channel: Channel, space: Space) -> None:
    trials = [replace(t, use_y=np.arange(t.recording.n) % 3 > 0) for t in channel.trials]
    some = replace(channel, trials=tuple(trials), use=np.concatenate([t.use_y for t in trials]))
    slopes = in_larger_steps(some, 4.0, least=100).slopes(space, starts_of(space)[0])[: some.use.size]
    assert not slopes[~some.use].any()
    assert slopes[some.use].any(axis=1).mean() > 0.9


def test_a_fit_ends_where_it_does_without(channel: Channel, space: Space, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[int] = []
    residuals = Channel.residuals
    monkeypatch.setattr(Channel, "residuals", lambda c, plant: done.append(steps(c)) or residuals(c, plant))
    plain = fit(channel, space, starts_of(space))
    without = sum(done)
    done.clear()
    found = fit(channel, space, starts_of(space), look=in_larger_steps(channel, 4.0, least=100))
    assert sum(done) < 0.45 * without
    assert plain.mse < 1.05
    assert found.mse == pytest.approx(plain.mse, rel=1e-3)
    np.testing.assert_allclose(found.z, plain.z, atol=0.2 * np.max(plain.deviations() / np.abs(units(space))))


def test_a_search_fits_with_its_look(channel: Channel, space: Space, monkeypatch: pytest.MonkeyPatch) -> None:
    long = replace(
        channel, trials=2 * channel.trials, measured=np.tile(channel.measured, 2), use=np.tile(channel.use, 2)
    )
    searcher = Searcher(long, space.base, Scales())
    assert searcher.look.larger
    used: list[object] = []
    monkeypatch.setattr(search, "fit", lambda *given, **how: used.append(how["look"]) or fit(*given, rounds=1))
    one = searcher._fit(space.causes, [])
    searcher._fit_from(space.causes, one)
    searcher._fit_prospect(Prospect(space.causes, space, one.z, 1.0, 1.0))
    assert used == 3 * [searcher.look]


def units(space: Space) -> FloatArray:
    return np.array([u.unit for u in space.unknowns])


def test_slopes_that_lead_nowhere_are_not_believed() -> None:
    def residuals(z: FloatArray) -> FloatArray:
        return np.array([z[0] - 1.0, 2.0 * (z[1] + 0.5), 0.1])

    asked: list[int] = []

    def wrong(_: FloatArray) -> FloatArray:
        asked.append(1)
        return -np.array([[1.0, 0.0], [0.0, 2.0], [0.0, 0.0]])

    bounds = np.full(2, -5.0), np.full(2, 5.0)
    found = minimise(residuals, np.zeros(2), *bounds, np.full(2, 1e-3), about=wrong)
    np.testing.assert_allclose(found.z, [1.0, -0.5], atol=1e-3)
    assert len(asked) == 1


def test_what_is_known_of_each_row_goes_with_it(channel: Channel) -> None:
    trial = channel.trials[0]
    vague = np.arange(trial.recording.n) > 2_000
    marked = replace(channel, trials=(replace(trial, vague=vague),), measured=channel.measured[:4_000], use=trial.use_y)
    look = in_larger_steps(marked, 4.0, least=100)
    [few] = look.channel.trials
    np.testing.assert_array_equal(few.vague, vague[look.rows])
    np.testing.assert_array_equal(few.recording.position, trial.recording.position[look.rows])
    np.testing.assert_array_equal(look.channel.measured, few.recording.position)
    assert few.pressure is not None
    assert trial.pressure is not None
    np.testing.assert_allclose(few.pressure[few.grid.offsets], trial.pressure[trial.grid.offsets][look.rows])
    jumps = np.flatnonzero(np.diff(trial.recording.command))
    assert set(jumps) <= set(look.rows.tolist())
