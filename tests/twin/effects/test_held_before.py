"""A converter with a band has seen the command that was in force before the first row."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, pressure_response
from twin.model.timegrid import make_grid

RAMP_PSI = 6.0 + 0.15 * np.arange(9)
QUICK = DesignModel(ep_tau_s=1e-3)


def settled(form: str, band_psi: float, begin_psi: float) -> np.ndarray:
    """Where the pressure is in each row of a ramp, behind a converter that follows at once."""
    grid = make_grid(0.5 * np.arange(RAMP_PSI.size), 0.05)
    c = Plant(QUICK, (Inserted("ep_deadband", effect("ep_deadband").form(form), (band_psi,)),)).coefficients(4.0)
    return pressure_response(c, grid, RAMP_PSI, begin_psi)[grid.offsets]


@pytest.mark.parametrize(
    ("begin_psi", "accepted_psi"),
    [
        (9.0, [6.0, 6.0, 6.3, 6.3, 6.6, 6.6, 6.9, 6.9, 7.2]),  # the first command was far away, and accepted
        (6.12, [6.12, 6.12, 6.12, 6.45, 6.45, 6.75, 6.75, 7.05, 7.05]),  # it was near, and ignored
    ],
)
def test_every_second_step_of_a_ramp_counts_and_the_first_command_says_which(
    begin_psi: float, accepted_psi: list[float]
) -> None:
    np.testing.assert_allclose(settled("hold", 0.2, begin_psi)[1:], accepted_psi[1:], atol=1e-6)


def test_a_play_goes_along_with_the_first_command() -> None:
    np.testing.assert_allclose(settled("play", 0.2, 9.0)[1:], np.maximum(RAMP_PSI - 0.2, 6.2)[1:], atol=1e-6)
