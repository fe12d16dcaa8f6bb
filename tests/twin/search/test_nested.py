"""A form that can do what a plainer one does never leaves more."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.fit.channel import Channel, position_channel
from twin.fit.fitting import Fit, fit
from twin.fit.space import ACCUSED_SPREAD, Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.nested import beyond_retuning, cost, nested


def channel_of(name: str, form: str, *values: float) -> Channel:
    trial, _ = trial_of(Plant(DESIGN, (Inserted(name, effect(name).form(form), values),)), staircase())
    return position_channel([trial], SIGMA)


def ended(channel: Channel, name: str, form: str, start: list[float], rounds: int) -> Fit:
    """A single cause fitted for so many rounds from `start`, in z, with the design's numbers as they are."""
    space = make_space(Plant(DESIGN), (Cause(name, effect(name), effect(name).form(form)),), (), Scales())
    return fit(channel, space, [np.array(start)], rounds=rounds)


def looked_at(channel: Channel, *fits: Fit) -> list[Fit]:
    with ThreadPoolExecutor(1) as pool:
        return nested(channel, fits, 8, pool)


def test_a_form_that_got_stuck_starts_where_the_plainer_one_ended() -> None:
    channel = channel_of("lvdt_nonlinearity", "bow_and_swing", 0.012, -0.004)
    bow = ended(channel, "lvdt_nonlinearity", "bow", [0.5], 8)
    stuck = ended(channel, "lvdt_nonlinearity", "bow_and_swing", [-3.0, 3.0], 0)
    assert stuck.mse > 10.0 * bow.mse > 20.0
    same, again = looked_at(channel, bow, stuck)
    assert same is bow
    assert again.mse < 1.1
    np.testing.assert_allclose(again.values(), (0.012, -0.004), atol=3e-4)


def test_forms_whose_numbers_only_bear_the_same_name_are_left_where_they_ended() -> None:
    """A spot begins nowhere near an end that is raised."""
    channel = channel_of("position_dependent_friction", "open_end", 0.3)
    end = ended(channel, "position_dependent_friction", "open_end", [0.8], 8)
    spot = ended(channel, "position_dependent_friction", "spot", [0.5, -2.4, 0.1], 12)
    assert end.mse < 0.9 * spot.mse
    assert looked_at(channel, end, spot)[1] is spot
    assert looked_at(channel, spot)[0] is spot


def test_an_effect_that_costs_more_than_retuning_got_stuck() -> None:
    """Numbers that went far off at once hide a gain that would explain all with the numbers as they are."""
    channel = channel_of("lvdt_calibration", "gain", 0.03)
    numbers = channel.numbers
    space = make_space(Plant(DESIGN), (), numbers, Scales(), ACCUSED_SPREAD)
    retuned = fit(channel, space, [np.zeros(len(numbers))], rounds=20)
    gain = effect("lvdt_calibration")
    cause = Cause(gain.name, gain, gain.form("gain"))
    within = make_space(Plant(DESIGN), (cause,), numbers, Scales())
    astray = np.array([*(0.1 * (-1.0) ** k for k in range(len(numbers))), 0.0])
    stuck = fit(channel, within, [astray], rounds=0)
    assert cost(channel, stuck) > 2.0 * retuned.mse * channel.rows
    with ThreadPoolExecutor(1) as pool:
        [again] = beyond_retuning(channel, [stuck], retuned, 6, pool)
        [same] = beyond_retuning(channel, [again], retuned, 6, pool)
    assert again.mse < 1.1 and again.values()[-1] == pytest.approx(0.03, abs=5e-4)
    assert again.prior < 0.5  # the numbers are where they were
    assert same is again


def test_a_number_is_never_fitted_again_from_the_retuned_ones() -> None:
    channel = channel_of("lvdt_calibration", "gain", 0.03)
    space = make_space(Plant(DESIGN), (), channel.numbers, Scales(), ACCUSED_SPREAD)
    retuned = fit(channel, space, [np.zeros(len(channel.numbers))], rounds=20)
    number = make_space(Plant(DESIGN), (Cause("parameter:tau"),), ("tau",), Scales())
    one = fit(channel, number, [np.zeros(1)], rounds=0)
    with ThreadPoolExecutor(1) as pool:
        assert beyond_retuning(channel, [one], retuned, 6, pool) == [one]
