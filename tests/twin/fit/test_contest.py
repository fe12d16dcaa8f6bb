"""Of many starts the one that leads to the least is found, and not only the one that leaves the least."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from tests.twin.judged import a_record
from tests.twin.loops import D
from twin.choose.stages import driven_about
from twin.fit.case import make_case
from twin.fit.channel import Channel, position_channel
from twin.fit.contest import followed
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.larger_steps import in_larger_steps
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.search.polish import polished


def found(name: str, form: str, truth: tuple[float, ...], seed: int) -> Fit:
    """The true form fitted from its own starts to five minutes of random steps, as the search does."""
    return searched(name, form, truth, seed)[1]


def searched(name: str, form: str, truth: tuple[float, ...], seed: int) -> tuple[Channel, Fit]:
    """Likewise, with what it was fitted to."""
    cause = Cause(name, effect(name), effect(name).form(form))
    record = a_record(Plant(D, (Inserted(name, effect(name).form(form), truth),)), seed=seed)
    case = make_case([record], D)
    channel = position_channel(driven_about(case.base, case), case.sigma_y)
    space = make_space(case.base, (cause,), channel.numbers, case.scales)
    starts = starts_of(space, [], [record])
    return channel, fit(channel, space, starts, rounds=12, look=in_larger_steps(channel))


@pytest.mark.parametrize(
    ("name", "form", "truth", "seed"),
    [
        ("position_dependent_friction", "band", (0.209, 0.247, 0.189), 4),
        ("position_dependent_friction", "band", (0.42, 0.358, 0.141), 6),
        ("position_dependent_friction", "spot", (0.391, 0.792, 0.197), 10),
        ("nonlinear_spring", "step", (0.651, 0.739, 0.298), 14),
        ("lvdt_drift", "jump", (0.002, 0.307), 0),
    ],
)
def test_a_form_with_a_place_or_a_moment_is_found_there(
    name: str, form: str, truth: tuple[float, ...], seed: int
) -> None:
    """Each from the start that leaves least ends elsewhere, with 5 to 1,500 times the noise variance."""
    fitted = found(name, form, truth, seed)
    assert fitted.mse < 1.2
    assert fitted.values()[-len(truth) :] == pytest.approx(truth, rel=0.05)


def test_a_band_that_no_start_led_to_is_found_about_where_the_best_ended() -> None:
    """Its response is smooth, and its valleys are narrow all the same."""
    channel, beside = searched("position_dependent_friction", "band", (0.538, 0.404, 0.097), 4)
    assert beside.mse > 100.0
    with ThreadPoolExecutor(2) as pool:
        (better,) = polished(channel, [beside], 1, pool)
    assert better.mse < 3.0  # it ends a little beside it
    assert better.values()[-2] == pytest.approx(0.404, abs=0.03)


@pytest.mark.thorough
def test_bands_drawn_at_random_are_found() -> None:
    """Ten of these twenty are not, from the start that leaves least."""
    left = []
    for seed in range(20):
        dice = np.random.default_rng(1000 + seed)
        sign = dice.choice([-1, 1])
        band = (sign * dice.uniform(0.15, 0.6), dice.uniform(0.15, 0.85), dice.uniform(0.06, 0.4))
        left.append(found("position_dependent_friction", "band", band, seed).mse)
    assert sum(mse < 1.3 for mse in left) >= 17, np.round(left, 2)


def test_a_start_is_followed_into_the_deeper_valley() -> None:
    """Two valleys side by side; what starts higher up is above the deeper one."""
    cause = Cause("lvdt_calibration", effect("lvdt_calibration"), effect("lvdt_calibration").forms[0])
    case = make_case([a_record(Plant(D))], D)
    space = make_space(case.base, (cause,), (), case.scales)

    def residuals(z: np.ndarray) -> np.ndarray:
        shallow, deep = 2.0 + (z[0] - 1.0) ** 2, 0.1 + 5.0 * (z[0] + 1.0) ** 2
        return np.array([np.sqrt(min(shallow, deep))])

    first, second = np.zeros(len(space.unknowns)), np.zeros(len(space.unknowns))
    first[0], second[0] = 1.1, -1.7
    assert followed(residuals, space, [first, second], 1)[0][0] == pytest.approx(-1.0, abs=0.1)
