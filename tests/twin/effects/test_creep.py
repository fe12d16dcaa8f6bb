"""Creep of the stem and creep of what pulls it: the same as long as nothing bounds the stem's speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.trials import DESIGN, trial_of
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

LEVELS = np.repeat([8.0, 9.5, 10.6, 7.2, 8.4, 6.9, 10.2], 300)


def reading(design: DesignModel, *inserted: tuple[str, str, tuple[float, ...]]) -> np.ndarray:
    """Noise-free, from rest at the lower stop, and away from both stops afterwards."""
    made = tuple(Inserted(name, effect(name).form(form), values) for name, form, values in inserted)
    return trial_of(Plant(design, made), LEVELS)[1]


@pytest.mark.parametrize(("stem", "pull"), [("one_tail", "pull_tail"), ("two_tails", "pull_tails")])
def test_only_the_rate_limit_tells_them_apart(stem: str, pull: str) -> None:
    free, bound = replace(DESIGN, rate_limit=1e3), replace(DESIGN, rate_limit=0.03)
    late = (0.2, 20.0)
    same = reading(free, ("creep", stem, late)) - reading(free, ("creep", pull, late))
    apart = reading(bound, ("creep", stem, late)) - reading(bound, ("creep", pull, late))
    assert np.abs(same).max() < 1e-6  # they are exchanged within steps of one length only
    assert np.abs(apart).max() > 2e-3
    assert np.abs(reading(free, ("creep", pull, late)) - reading(free)).max() > 0.02


def test_a_pull_that_creeps_moves_no_faster_than_the_stem_can() -> None:
    slow = replace(DESIGN, rate_limit=0.03)
    speeds = np.diff(reading(slow, ("creep", "pull_tail", (0.3, 15.0)))) / 0.1
    assert np.abs(speeds).max() == pytest.approx(0.03, rel=1e-3)
    assert np.abs(np.diff(reading(slow, ("creep", "one_tail", (0.3, 15.0)))) / 0.1).max() < 0.028


@pytest.mark.parametrize(
    ("apart", "long", "like"), [(6.0, 0.5, ("pull_tails", (0.2, 12.0))), (9.0, 0.0, ("pull_tail", (0.2, 12.0)))]
)
def test_two_tails_may_be_any_two(apart: float, long: float, like: tuple[str, tuple[float, ...]]) -> None:
    """Half each and six times as long, or only the one, are two of them."""
    free = reading(DESIGN, ("creep", "pull_tails_apart", (0.2, 12.0, apart, long)))
    np.testing.assert_allclose(free, reading(DESIGN, ("creep", *like)), atol=1e-12)


def test_the_longer_tail_is_still_on_its_way_when_the_shorter_is_over() -> None:
    at = 300 * 2 - 1
    short, both = (reading(DESIGN, ("creep", "pull_tails_apart", (0.2, 3.0, 40.0, long)))[at] for long in (0.0, 1.0))
    between = reading(DESIGN, ("creep", "pull_tails_apart", (0.2, 3.0, 40.0, 0.5)))[at]
    assert both < short - 0.01
    assert between == pytest.approx(0.5 * (both + short), abs=1e-9)
