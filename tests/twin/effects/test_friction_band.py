"""A zone of the travel in which friction is another, and few readings of slow moves through it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.trials import DESIGN, SIGMA, trial_of
from twin.fit.channel import position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant

BAND = effect("position_dependent_friction").form("band")


@pytest.mark.parametrize("centre", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("height_psi", [0.384, -0.3])
def test_it_is_found_in_every_part_of_the_travel(centre: float, height_psi: float) -> None:
    """In a slow closed loop seen through every 35th row the way from the nearest of three places led astray."""
    levels = 8.8 + 1.7 * np.sin(0.11 * np.arange(90)) + 0.5 * np.sin(0.9 * np.arange(90))
    plant = Plant(DESIGN, (Inserted("position_dependent_friction", BAND, (height_psi, centre, 0.22)),))
    trial, _ = trial_of(plant, np.repeat(levels, 120))
    channel = position_channel([trial], SIGMA)
    channel = replace(channel, use=channel.use & (np.arange(channel.use.size) % 35 == 0))
    cause = Cause("position_dependent_friction", effect("position_dependent_friction"), BAND)
    space = make_space(Plant(DESIGN), (cause,), channel.numbers, Scales())
    found = fit(channel, space, starts_of(space))
    assert found.mse < 1.2  # of 1,300 to 8,700 without
    assert found.values()[-3:] == pytest.approx([height_psi, centre, 0.22], abs=0.03)
