"""Several effects at once: finite, within the stops, and the same in whatever order they stand in the file."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray
from twin.model.catalog import effects
from twin.model.plant import Inserted, Plant, pressure_response, reading_response, stem_response
from twin.model.timegrid import make_grid

DESIGN = DesignModel()
TIME_S = np.arange(400) * 0.2
COMMAND = np.repeat(np.random.default_rng(2).uniform(4.5, 13.0, 20), 20)


@st.composite
def several(draw: st.DrawFn) -> list[Inserted]:
    """Two to four different effects, each in any form at any of its starts."""
    names = draw(st.lists(st.sampled_from(sorted(effects())), min_size=2, max_size=4, unique=True))
    found = []
    for name in names:
        form = draw(st.sampled_from(effects()[name].forms))
        found.append(Inserted(name, form, tuple(draw(st.sampled_from(p.starts)) for p in form.parameters)))
    return found


def chain(inserted: list[Inserted]) -> tuple[FloatArray, FloatArray]:
    """Stem on the fine grid and reading at the rows."""
    plant = Plant(DESIGN, tuple(inserted))
    grid = make_grid(TIME_S, 0.05)
    c = plant.coefficients(float(TIME_S[-1]))
    pressure = pressure_response(c, grid, COMMAND, float(COMMAND[0]))
    stem = stem_response(c, grid, pressure, 0.2, 0.2)
    return stem, reading_response(c, grid, stem, pressure)


@settings(max_examples=60, deadline=None)
@given(several())
def test_any_effects_together(inserted: list[Inserted]) -> None:
    stem, reading = chain(inserted)
    assert np.isfinite(reading).all()
    beyond = 0.011 * DESIGN.travel  # a stop may be up to 1 % further out in the starts of reduced_travel
    assert stem.min() >= -beyond
    assert stem.max() <= DESIGN.travel + beyond


@settings(max_examples=30, deadline=None)
@given(several())
def test_order_does_not_matter(inserted: list[Inserted]) -> None:
    np.testing.assert_allclose(chain(inserted)[1], chain(inserted[::-1])[1], atol=1e-9)


@pytest.mark.parametrize("end", ["upper_stop_hit", "lower_stop_hit"])
def test_a_stop_further_out_and_friction_pressed_against_it_add_up(end: str) -> None:
    stop = Inserted("reduced_travel", effects()["reduced_travel"].form(end), (-0.01,))
    held = Inserted("stiction", effects()["stiction"].form("held_stem_pressed"), (0.03, 3e-4))
    one, other = (Plant(DESIGN, both).coefficients(100.0).valve for both in ((stop, held), (held, stop)))
    np.testing.assert_allclose(one, other, atol=1e-12)


FORMS = [(name, form) for name, one in effects().items() for form in one.forms]


@pytest.mark.thorough
@pytest.mark.parametrize("loaded", [False, True])
def test_any_two_forms_do_the_same_in_either_order(loaded: bool) -> None:
    """Alone, and beside friction in the force balance, where other coefficients count: chance draws few of them."""
    friction = [Inserted("friction_in_motion", effects()["friction_in_motion"].form("full"), ())] if loaded else []
    found = [Inserted(name, form, tuple(p.starts[-1] for p in form.parameters)) for name, form in FORMS]
    for one, other in combinations(found, 2):
        if one.effect == other.effect or (loaded and "friction_in_motion" in (one.effect, other.effect)):
            continue
        forth, back = chain([one, other, *friction])[1], chain([*friction, other, one])[1]
        np.testing.assert_allclose(forth, back, atol=1e-9, err_msg=f"{one.effect} {other.effect}")


def test_a_lag_of_the_stem_beside_a_filter_of_two_poles_keeps_its_own() -> None:
    """They share a place; neither may take the other's."""
    behind = Inserted("additional_lag", effects()["additional_lag"].form("behind_stem"), (0.9,))
    poles = Inserted("sensor_lag", effects()["sensor_lag"].form("two_poles"), (0.4,))
    one, other = chain([behind, poles])[1], chain([poles, behind])[1]
    np.testing.assert_allclose(one, other, atol=1e-12)
    assert np.abs(one - chain([behind])[1]).max() > 0.01 * DESIGN.travel
    assert np.abs(one - chain([poles])[1]).max() > 0.01 * DESIGN.travel
