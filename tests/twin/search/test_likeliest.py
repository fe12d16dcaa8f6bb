"""A form whose other numbers do all the work hides no other cause."""

from __future__ import annotations

import numpy as np

from control.design import DesignModel
from twin.fit.fitting import Fit
from twin.fit.space import Cause, Scales, make_space
from twin.model.catalog import effect
from twin.model.plant import Plant
from twin.search.likeliest import likeliest


def found(name: str, form: str, z: float, mse: float) -> Fit:
    """A hypothesis of one effect whose first number, its size, is known to 0.1; the others stand where they began."""
    space = make_space(Plant(DesignModel()), (Cause(name, effect(name), effect(name).form(form)),), (), Scales())
    at = np.full(len(space.unknowns), 1.0)
    at[0] = z
    return Fit(space, at, mse, 0.0, np.full(400, np.sqrt(mse)), 100.0 * np.eye(at.size), 1)


def test_an_effect_without_a_size_is_behind_one_that_has_a_size_and_leaves_more() -> None:
    use = np.ones(400, dtype=bool)
    sized = found("stiction", "held_stem_pressed", 1.0, 3.0)
    for z, first in ((0.15, "stiction"), (0.5, "friction_in_motion")):
        better = found("friction_in_motion", "partial_loaded", z, 1.0)
        assert likeliest([sized, better], use)[0].names == (first,)
    alone = found("friction_in_motion", "partial_loaded", 0.15, 1.0)
    assert likeliest([alone], use) == [alone]  # there is nothing else
