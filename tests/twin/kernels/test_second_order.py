"""A filter of second order against scipy and its limits, at once and block by block."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lsim

from logs.recording import FloatArray
from tests.twin.trials import DESIGN, trial_of
from twin.kernels.second_order import swinging
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.replay.swing import Swing

TIME_S = np.linspace(0.0, 20.0, 401)
OFFSETS = np.arange(TIME_S.size)
#: Begins at 0.3, at rest.
SIGNAL = 0.3 + np.where(TIME_S > 4.0, 0.2 * np.sin(0.9 * (TIME_S - 4.0)) + 0.01 * (TIME_S - 4.0), 0.0)
LEVELS = np.repeat([8.0, 9.5, 10.6, 7.2, 8.4, 6.9, 10.2], 300)


@given(natural_s=st.floats(0.02, 3.0), damping=st.floats(0.2, 0.98))
def test_it_is_what_scipy_makes_of_it(natural_s: float, damping: float) -> None:
    poles = ([1.0], [natural_s**2, 2.0 * damping * natural_s, 1.0])
    _, wanted, _ = lsim(poles, SIGNAL - 0.3, TIME_S)
    np.testing.assert_allclose(swinging(TIME_S, OFFSETS, SIGNAL, natural_s, damping), 0.3 + wanted, atol=1e-7)


@given(natural_s=st.floats(0.02, 3.0), seed=st.integers(0, 1000))
def test_block_by_block_it_is_the_same(natural_s: float, seed: int) -> None:
    dice = np.random.default_rng(seed)
    swing, got = Swing(natural_s, 0.5), [SIGNAL[0]]
    ends = np.unique(np.concatenate([[0, TIME_S.size - 1], dice.integers(1, TIME_S.size - 1, 60)]))
    for a, b in pairwise(ends):
        # a block is one row: its fine points are evenly spaced
        block = swing.follow(TIME_S[[a, b]], np.array([0, b - a]), SIGNAL[a : b + 1])
        got += block[1:].tolist()
    np.testing.assert_allclose(got, swinging(TIME_S, OFFSETS, SIGNAL, natural_s, 0.5), atol=1e-9)


def test_without_a_filter_the_signal_is_as_it_was() -> None:
    assert swinging(TIME_S, OFFSETS, SIGNAL, 0.0, 0.0) is SIGNAL
    assert Swing(0.0, 0.0).follow(TIME_S, OFFSETS, SIGNAL) is SIGNAL


def reading(name: str, form: str, *values: float) -> FloatArray:
    """What a valve with this effect reads, without noise."""
    return trial_of(Plant(DESIGN, (Inserted(name, effect(name).form(form), values),)), LEVELS)[1]


@pytest.mark.parametrize(
    ("sensor", "stem", "values"),
    [("three_poles", "three_behind", (0.6,)), ("second_order", "mass_on_spring", (0.6, 0.5))],
)
def test_behind_the_stem_it_is_what_it_is_before_the_reading(sensor: str, stem: str, values: tuple[float, ...]) -> None:
    """A linear filter does not care which of two it is; that is why they share the belief."""
    both = reading("sensor_lag", sensor, *values), reading("additional_lag", stem, *values)
    np.testing.assert_allclose(*both, atol=1e-12)


def test_all_filters_are_late_by_the_same_in_the_mean() -> None:
    """`lag` means one thing in every form: what is missing of the area under a rise."""
    plain = trial_of(Plant(DESIGN), LEVELS)[1]
    forms = (("first_order", 0.6), ("two_poles", 0.6), ("three_poles", 0.6), ("second_order", 0.6, 0.4))
    rise = slice(0, 300)
    areas = [np.sum((plain - reading("sensor_lag", *form))[rise]) for form in forms]
    np.testing.assert_allclose(areas, areas[0], rtol=2e-3)
