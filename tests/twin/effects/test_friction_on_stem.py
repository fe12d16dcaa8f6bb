"""Friction that grows and holds the stem itself off its target, against small steps of that law."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from logs.recording import FloatArray
from tests.twin.loops import PRESSURE, SMALL_S, TIME_S, D, at_once, plant, row_by_row
from twin.kernels.coupled_start import coupled_start
from twin.kernels.valve import _widening
from twin.kernels.valve_slots import stem_stops
from twin.model.coefficients import Coefficients
from twin.model.place import Place
from twin.model.plant import Plant, curve_tables

GROWTH: dict[str, tuple[tuple[float, ...], Callable[[float, float], float]]] = {
    "wear_on_stem": ((0.25,), lambda _t, way: 0.25 * way),
    "linear_on_stem": ((4e-3,), lambda t, _way: 4e-3 * t),
    "warm_up_on_stem": ((0.4, 40.0), lambda t, _way: 0.4 * (1.0 - np.exp(-t / 40.0))),
}


def in_small_steps(grown: Callable[[float, float], float]) -> FloatArray:
    """A play of the design's width; behind it the stem is pulled by what is left of the way to its target."""
    time_s = np.arange(0.0, TIME_S[-1] + SMALL_S, SMALL_S)
    x, w, way, found = 0.0, 0.0, 0.0, np.empty(time_s.size)
    for k, p in enumerate(np.interp(time_s, TIME_S, PRESSURE)):
        found[k] = x
        w = min(D.travel, max(0.0, D.compliance * (p - D.a1), min(D.compliance * (p - D.a2), w)))
        rubs = D.compliance * grown(float(time_s[k]), way)
        pull = np.sign(w - x) * max(0.0, abs(w - x) - rubs)
        step = SMALL_S * max(-D.rate_limit, min(D.rate_limit, pull / D.tau_s))
        x, way = x + step, way + abs(step)
    return np.interp(TIME_S, time_s, found)


@pytest.mark.parametrize("form", GROWTH)
def test_like_small_steps_at_once_and_row_by_row(form: str) -> None:
    values, grown = GROWTH[form]
    one = plant("before the lag", "friction_drift", form, values)
    want = in_small_steps(grown)
    assert np.max(np.abs(at_once(one) - want)) < 0.002 * D.travel
    np.testing.assert_allclose(row_by_row(one), at_once(one), atol=1e-9)
    widens = plant("before the lag", "friction_drift", form.removesuffix("_on_stem"), values)
    assert np.max(np.abs(at_once(widens) - want)) > 0.02 * D.travel  # at the stops, where a wider play pulls on


def coefficients(form: str, values: tuple[float, ...], since_s: float) -> Coefficients:
    one: Plant = plant("before the lag", "friction_drift", form, values)
    return one.coefficients(90.0, Place(1, 2, since_s, 200.0))


@pytest.mark.parametrize("form", ["linear_on_stem", "warm_up_on_stem"])
def test_a_later_recording_begins_with_what_has_grown_before(form: str) -> None:
    values, grown = GROWTH[form]
    offsets = np.arange(TIME_S.size, dtype=np.int64)
    later = _widening(TIME_S, offsets, coefficients(form, values, 100.0).valve)
    np.testing.assert_allclose(later, [grown(100.0 + t, 0.0) for t in TIME_S], atol=1e-12)


def test_friction_that_shrinks_narrows_the_play() -> None:
    """There is none on the stem to take away: it is the play that has less."""
    falls = plant("before the lag", "friction_drift", "linear_on_stem", (-4e-3,))
    np.testing.assert_allclose(at_once(falls), at_once(plant("before the lag", "friction_drift", "linear", (-4e-3,))))


def test_what_pulls_the_stem_begins_within_the_play_as_it_was_designed() -> None:
    c = coefficients("linear_on_stem", (4e-3,), 100.0)
    first, step, closing, opening = curve_tables(c)
    what = (np.array([0.0, D.travel, *stem_stops(c.valve)]), (float(first), float(step), closing, opening))
    state, _ = coupled_start(7.0, 0.4, c.valve, *what, (c.spreads, c.weights), c.stem_bends, (0.25, 0.25))
    assert state[0] == pytest.approx(0.25)  # friction holds it
    assert state[1] == pytest.approx(D.compliance * (7.0 - D.a2))
