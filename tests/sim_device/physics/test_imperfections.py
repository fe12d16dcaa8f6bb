"""Every imperfection of both families: without size it is not there, with size it shows, at its limit it is finite."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from sim_device.physics.catalog import imperfections, make_physics, parameters
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.offline import record
from tests.sim_device.physics.excitation import Array, lively

SECONDS = {"thesis": 150, "reference": 150}


@cache
def response(plant: str, key: str = "", size: float = 0.0) -> Array:
    """Pressure and position, shape (2, rows), without noise."""
    effects = {key: size} if key else {}
    return np.stack(record(make_physics(plant, 11, noise=0.0, effects=effects), *lively(SECONDS[plant])))


def cases() -> list[tuple[str, Imperfection, str]]:
    return [
        (plant, item, item.name if form == "default" else f"{item.name}/{form}")
        for plant in SECONDS
        for item in (*imperfections(plant), *parameters(plant))
        for form in item.forms
    ]


@pytest.mark.parametrize(("plant", "item", "key"), cases(), ids=lambda value: value if isinstance(value, str) else "")
def test_size_zero_is_healthy_and_a_large_size_shows(plant: str, item: Imperfection, key: str) -> None:
    healthy = response(plant)
    assert np.array_equal(response(plant, key, 0.0), healthy)
    form = key.partition("/")[2]
    difference = response(plant, key, item.size(2, form)) - healthy
    assert np.max(np.abs(difference[1])) > 0.002  # three times the reading noise, even in this short record
    if item.stage == "sensor":
        assert np.all(difference[0] == 0.0)


@pytest.mark.parametrize("plant", SECONDS)
def test_the_largest_sizes_allowed_still_give_numbers(plant: str) -> None:
    time_s, command = lively(25)
    for item in imperfections(plant):
        for form in item.forms:
            key = item.name if form == "default" else f"{item.name}/{form}"
            for sign in (1.0, -1.0) if item.signed else (1.0,):
                seen = record(make_physics(plant, 2, effects={key: sign * item.limit}), time_s, command)
                assert np.all(np.isfinite(seen)), key
                assert np.max(np.abs(seen[1])) < 5.0, key


@pytest.mark.parametrize("plant", SECONDS)
def test_two_effects_act_together(plant: str) -> None:
    time_s, command = lively(60)
    both = {"dead_time": 0.7, "lvdt_calibration": 0.05}
    together = record(make_physics(plant, 1, noise=0.0, effects=both), time_s, command)
    late = record(make_physics(plant, 1, noise=0.0, effects={"dead_time": 0.7}), time_s, command)
    assert np.array_equal(together[0], late[0])
    assert np.allclose(together[1], 1.05 * late[1], atol=3e-5)
