"""A converter that ignores commands within a band: the band is read from the pressure before anything is fitted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO
from twin.diagnose import diagnose
from twin.effects.ep_deadband import _held
from twin.fit.space import form_starts
from twin.kernels.held import accepted_before, banded
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.held_band import accepted_rows
from twin.model.plant import Inserted, Plant, pressure_response, stem_response
from twin.model.timegrid import make_grid
from twin.record.rows import kept_rows, thinned

HOLD = effect("ep_deadband").form("hold")


def swung(band_psi: float, tau_s: float = 0.3, rows: int = 4000) -> Recording:
    """A sine of the command, of which only what exceeds the band gets through."""
    dice = np.random.default_rng(3)
    time_s = 0.1 * np.arange(float(rows))
    command, grid = 8.0 + 4.0 * np.sin(0.21 * time_s), make_grid(time_s, 0.05)
    plant = Plant(replace(DesignModel(), ep_tau_s=tau_s), (Inserted("ep_deadband", HOLD, (band_psi,)),))
    pressure = pressure_response(plant.coefficients(time_s[-1]), grid, command, 8.0)
    stem = stem_response(plant.coefficients(time_s[-1]), grid, pressure, 0.2, 0.2)[grid.offsets]
    noise = dice.normal(size=(2, rows))
    read = pressure[grid.offsets] + 0.01 * noise[0]
    return Recording("swung", time_s, command, stem + 0.0006 * noise[1], read)


@pytest.mark.parametrize(("band_psi", "tau_s"), [(0.35, 0.15), (0.1234, 0.5), (0.61, 0.3)])
def test_the_band_is_found_to_a_fifth_of_a_percent_whatever_the_lag(band_psi: float, tau_s: float) -> None:
    first = _held([swung(band_psi, tau_s)], Scales())[0][0]
    assert first == pytest.approx(band_psi, rel=2e-3)


def test_without_a_pressure_it_is_looked_for_as_before() -> None:
    record = replace(swung(0.35), pressure=None)
    assert _held([record], Scales()) == []
    assert len(form_starts(HOLD, Scales(), [record])) == 400


def test_readings_that_are_missing_are_left_out() -> None:
    record = swung(0.35)
    assert record.pressure is not None
    holes = np.where(np.arange(record.n) % 7 == 3, np.nan, record.pressure)
    assert _held([replace(record, pressure=holes)], Scales())[0][0] == pytest.approx(0.35, rel=2e-3)


def test_rows_in_which_a_command_is_accepted_stay_where_others_are_left_out() -> None:
    """Between two rows that stay nothing is accepted, so that the mean command there is as good as each."""
    record = swung(0.35)
    rows = accepted_rows(record, 0.01)
    assert rows.size > 200
    assert np.all(np.abs(np.diff(record.command[rows])) > 0.35)
    kept = kept_rows(record.command, record.n // 3, rows)
    assert set(rows) | set(rows - 1) <= set(kept)
    thin = thinned(record, kept)
    goal, still = np.empty(record.n), np.empty(thin.n)
    banded(record.command, 0.35, True, 8.0, goal)
    banded(thin.command, 0.35, True, 8.0, still)
    np.testing.assert_allclose(still, goal[kept], rtol=1e-9)


def test_a_converter_that_follows_every_command_accepts_none_in_particular() -> None:
    record = swung(0.0)
    assert accepted_rows(record, 0.01).size == 0
    assert accepted_rows(replace(record, pressure=None), 0.01).size == 0
    assert accepted_rows(replace(record, command=np.full(record.n, 8.0)), 0.01).size == 0


@pytest.mark.parametrize(("begin_psi", "stands_psi"), [(8.01, 8.0), (8.1, 8.1), (6.0, 6.0)])
def test_a_pressure_near_the_first_command_is_where_that_was_accepted(begin_psi: float, stands_psi: float) -> None:
    assert accepted_before(8.0, 0.35, begin_psi) == stands_psi


@pytest.mark.thorough
def test_a_band_whose_valley_is_a_fifth_of_a_percent_wide_is_named() -> None:
    found = diagnose([swung(0.35)], DesignModel(), (), UP_TO_TWO).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("ep_deadband", "hold")]
    assert found.causes[0].parameters["band"].value == pytest.approx(0.35, rel=5e-3)
