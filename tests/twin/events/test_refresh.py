"""The refresh period of a reading, from the reading alone."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.events.refresh import refreshes
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant, pressure_response, reading_response, stem_response
from twin.model.timegrid import make_grid


def held_reading(period_s: float, phase: float, noise: float) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(4)
    time_s = np.arange(4000) * 0.1
    command = np.repeat(rng.uniform(4.5, 12.5, 50), 80)
    values = (period_s, phase)
    plant = Plant(DesignModel(), (Inserted("stale_samples", effect("stale_samples").forms[0], values),))
    grid, c = make_grid(time_s, 0.05), plant.coefficients(400.0)
    pressure = pressure_response(c, grid, command, float(command[0]))
    reading = reading_response(c, grid, stem_response(c, grid, pressure, 0.0, 0.0), pressure)
    return time_s, reading + rng.normal(0.0, noise, reading.size)


@pytest.mark.parametrize("noise", [0.0, 5e-4])
@pytest.mark.parametrize(("period_s", "phase"), [(0.5, 0.1), (0.37, 0.6), (1.1, 0.3), (0.15, 0.5)])
def test_period_is_known_well_enough_to_keep_step(period_s: float, phase: float, noise: float) -> None:
    found = refreshes(*held_reading(period_s, phase, noise))
    best = min(found, key=lambda one: abs(one.period_s - period_s))
    slip_s = abs(best.period_s - period_s) / period_s * 400.0
    assert slip_s < 0.4 * period_s  # over the whole record


def test_starts_of_the_effect_hold_the_period_and_the_phase() -> None:
    form = effect("stale_samples").forms[0]
    assert form.starts_for is not None
    time_s, reading = held_reading(0.37, 0.6, 2e-4)
    starts = form.starts_for([Recording("valve", time_s, np.zeros(time_s.size), reading)], Scales())
    near = [p for period, p in starts if abs(period - 0.37) < 1e-3]
    assert min(abs((p - 0.6 + 0.5) % 1.0 - 0.5) for p in near) < 0.1
    assert all(0.0 <= p < 1.0 for _, p in starts)


def test_short_record_says_nothing() -> None:
    assert refreshes(np.arange(20) * 0.1, np.zeros(20)) == []
