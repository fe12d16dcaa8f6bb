"""Free curves are at nothing where the record says nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.trials import DESIGN, SIGMA, trial_of
from twin.fit.channel import Channel, position_channel
from twin.fit.fitting import Fit, fit
from twin.fit.space import Cause, make_space
from twin.fit.unfelt import without_unfelt
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant

PROFILE = effect("position_dependent_friction").form("profile")
COUNT = len(PROFILE.parameters)


@pytest.fixture(scope="module")
def fitted() -> tuple[Channel, Fit]:
    """A profile fitted to a valve with a tight place, that stays below two thirds of its travel."""
    true = np.zeros(COUNT)
    true[4] = 0.15
    plant = Plant(DESIGN, (Inserted("position_dependent_friction", PROFILE, tuple(true)),))
    top_psi = DESIGN.a1 + 0.6 * DESIGN.travel / DESIGN.compliance
    levels = np.random.default_rng(3).uniform(6.0, top_psi, 16)
    trial, _ = trial_of(plant, np.repeat(levels, 250))
    channel = position_channel([trial], SIGMA)
    cause = Cause("position_dependent_friction", effect("position_dependent_friction"), PROFILE)
    space = make_space(Plant(DESIGN), (cause,), (), Scales())
    found = fit(channel, space, [np.zeros(COUNT)], rounds=8)
    z = np.concatenate([found.z[:-2], [1.0, -1.0]])  # what a search may come by, where the stem has never been
    return channel, replace(found, z=z, prior=float(np.sum((z / space.spreads) ** 2)))


def test_where_the_stem_has_never_been_nothing_is_left(fitted: tuple[Channel, Fit]) -> None:
    channel, one = fitted
    plain = without_unfelt(channel, one, 1.0)
    assert np.all(plain.z[-2:] == 0.0)
    assert plain.values()[4] == one.values()[4] == pytest.approx(0.15, abs=0.02)
    assert plain.mse < one.mse + 12.0 * COUNT / one.residuals.size
    assert plain.prior < one.prior
    assert without_unfelt(channel, plain, 1.0) is plain


def test_the_fewer_samples_are_worth_the_less_is_felt(fitted: tuple[Channel, Fit]) -> None:
    channel, one = fitted
    much, little = (without_unfelt(channel, one, phi) for phi in (1.0, 1e9))
    assert np.count_nonzero(little.z) == 0 < np.count_nonzero(much.z)


def test_a_law_of_few_numbers_stays_as_it_is(fitted: tuple[Channel, Fit]) -> None:
    channel, one = fitted
    spot = effect("position_dependent_friction").form("spot")
    cause = Cause("position_dependent_friction", effect("position_dependent_friction"), spot)
    space = make_space(Plant(DESIGN), (cause,), (), Scales())
    law = replace(one, space=space, z=np.full(len(space.unknowns), 0.01))
    assert without_unfelt(channel, law, 1e9) is law
