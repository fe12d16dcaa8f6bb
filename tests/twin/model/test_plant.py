"""What is true of the chain whatever the command: curves, stops, order, memory, repeatability."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, curve_tables, effect_tables, pressure_response, stem_response
from twin.model.timegrid import make_grid

DESIGN = DesignModel()
LEVELS = st.lists(st.floats(3.0, 15.0), min_size=2, max_size=12)
QUICK = settings(max_examples=40, deadline=None)


def stem(plant: Plant, levels: list[float], tau_s: float | None = None) -> tuple[FloatArray, FloatArray]:
    """Pressure and stem on the fine grid, 3 s on each level."""
    if tau_s is not None:
        plant = replace(plant, design=replace(plant.design, tau_s=tau_s, rate_limit=1e6))
    command = np.repeat(np.asarray(levels), 15)
    grid = make_grid(np.arange(command.size) * 0.2, 0.05)
    c = plant.coefficients(grid.time_s[-1])
    pressure = pressure_response(c, grid, command, float(command[0]))
    return pressure, stem_response(c, grid, pressure, 0.0, 0.0)


@QUICK
@given(LEVELS)
def test_play_stays_between_its_curves_and_the_stops(levels: list[float]) -> None:
    p, w = stem(Plant(DESIGN), levels, tau_s=0.0)  # without the lag the stem is the play output
    closing = np.clip(DESIGN.compliance * (p - DESIGN.a1), 0.0, DESIGN.travel)
    opening = np.clip(DESIGN.compliance * (p - DESIGN.a2), 0.0, DESIGN.travel)
    assert (w >= closing - 1e-12)[1:].all()  # the first point is where the stem was put
    assert (w <= opening + 1e-12)[1:].all()


@QUICK
@given(LEVELS)
def test_stem_stays_within_the_stops_and_the_rate(levels: list[float]) -> None:
    _, x = stem(Plant(DESIGN), levels)
    assert x.min() >= 0.0
    assert x.max() <= DESIGN.travel
    assert np.abs(np.diff(x)).max() <= DESIGN.rate_limit * 0.05 * (1.0 + 1e-9)


@QUICK
@given(LEVELS, st.floats(0.0, 2.0))
def test_more_pressure_never_opens_the_valve(levels: list[float], more: float) -> None:
    spread = Inserted("distributed_hysteresis", effect("distributed_hysteresis").form("uniform"), (0.6,))
    for plant in (Plant(DESIGN), Plant(DESIGN, (spread,))):
        _, x = stem(plant, levels)
        _, higher = stem(plant, [level + more for level in levels])
        assert (higher >= x - 1e-12).all()


@QUICK
@given(LEVELS)
def test_replay_is_bit_for_bit(levels: list[float]) -> None:
    one_jump = Inserted("stiction", effect("stiction").form("one_jump"), (0.4,))
    plant = Plant(DESIGN, (one_jump,))
    assert np.array_equal(stem(plant, levels)[1], stem(plant, levels)[1])


@QUICK
@given(LEVELS, st.floats(0.02, 0.98))
def test_partial_friction_lies_between_none_and_full(levels: list[float], share: float) -> None:
    """After any steps the stem with friction in the balance has not gone further than without."""
    form = effect("friction_in_motion").form("partial")
    _, none = stem(Plant(DESIGN), [3.0, *levels[:1]])
    _, some = stem(Plant(DESIGN, (Inserted("friction_in_motion", form, (share,)),)), [3.0, *levels[:1]])
    assert np.abs(some - none).max() < 1e-9  # one way there is nothing to tell: they differ after a reversal


def test_full_friction_stops_at_the_reversal_and_none_coasts_on() -> None:
    form = effect("friction_in_motion").form("full")
    full = Plant(DESIGN, (Inserted("friction_in_motion", form, ()),))
    _, coasting = stem(Plant(DESIGN), [4.0, 11.5, 9.0, 9.0])
    _, stopped = stem(full, [4.0, 11.5, 9.0, 9.0])
    assert coasting[-1] > stopped[-1] + 0.05


def test_bent_curves_go_through_the_bend() -> None:
    plant = Plant(DESIGN, (Inserted("nonlinear_spring", effect("nonlinear_spring").form("bow"), (0.4,)),))
    first, step, closing, opening = curve_tables(plant.coefficients(1.0))
    grid = first + step * np.arange(closing.size)
    middle = 0.5 * DESIGN.travel
    assert np.isclose(np.interp(middle, closing, grid), DESIGN.a1 + middle / DESIGN.compliance + 0.4, atol=0.01)
    assert np.isclose(np.interp(middle, opening, grid), DESIGN.a2 + middle / DESIGN.compliance + 0.4, atol=0.01)


def test_prints_like_a_sentence_and_writes_tables() -> None:
    one = Inserted("stiction", effect("stiction").form("one_jump"), (0.25,))
    assert str(Plant(DESIGN, (one,))).endswith("with stiction (breakaway 0.25)")
    assert effect_tables([one]) == {"stiction": {"form": "one_jump", "breakaway": 0.25}}
