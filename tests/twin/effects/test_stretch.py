"""What gives way behind the stem adds to its motion, up to the stops: against small steps of that law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from logs.recording import FloatArray
from tests.twin.judged import a_record
from tests.twin.loops import FRICTIONS, PRESSURE, SMALL_S, TIME_S, D, at_once, plant, row_by_row
from twin.diagnose import Settings, diagnose
from twin.model.plant import Plant
from twin.replay.simulate import Start, simulate_recording
from twin.search.search_rules import SearchRules

FORMS = {
    "stretch": ((0.05, 20.0, 0.4), (0.05,), (20.0,)),
    "stretch_twice": ((0.06, 5.0, 0.0), (0.03, 0.03), (5.0, 30.0)),
}


def in_small_steps(shares: tuple[float, ...], tails_s: tuple[float, ...]) -> FloatArray:
    """A play, a stem that lags behind it, elements in series with it that give way slowly, and stops for the whole."""
    time_s = np.arange(0.0, TIME_S[-1] + SMALL_S, SMALL_S)
    x, w, late, found = 0.0, 0.0, np.zeros(len(shares)), np.empty(time_s.size)
    for k, p in enumerate(np.interp(time_s, TIME_S, PRESSURE)):
        found[k] = min(D.travel, x + float(np.dot(shares, late)))
        w = min(D.travel, max(0.0, D.compliance * (p - D.a1), min(D.compliance * (p - D.a2), w)))
        late += SMALL_S * (x - late) / np.array(tails_s)
        x += SMALL_S * max(-D.rate_limit, min(D.rate_limit, (w - x) / D.tau_s))
    return np.interp(TIME_S, time_s, found)


@pytest.mark.parametrize("form", FORMS)
def test_like_small_steps(form: str) -> None:
    values, shares, tails_s = FORMS[form]
    want = in_small_steps(shares, tails_s)
    assert np.max(np.abs(at_once(plant("before the lag", "creep", form, values)) - want)) < 0.002 * D.travel
    late = "one_tail" if form == "stretch" else "two_tails"
    other = at_once(plant("before the lag", "creep", late, values[:2])) * (1.0 + values[0])
    assert np.max(np.abs(other - want)) > 0.025 * D.travel  # which leaves a stop as slowly as it came


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("form", FORMS)
def test_row_by_row_as_at_once(friction: str, form: str) -> None:
    one = plant(friction, "creep", form, FORMS[form][0])
    np.testing.assert_allclose(row_by_row(one), at_once(one), atol=1e-9)


@pytest.mark.parametrize("begun", [0.0, 0.5, 1.0])
def test_it_begins_where_it_was_read_with_what_has_given_way_by_then(begun: float) -> None:
    still = replace(a_record(Plant(D), n=300), command=np.full(300, 9.0), pressure=np.full(300, 9.0))
    held = Start(9.0, 0.3, 0.3)  # the friction holds the stem there: what moves is what gives way
    position = simulate_recording(plant("before the lag", "creep", "stretch", (0.1, 10.0, begun)), still, start=held)[1]
    assert position[0] == pytest.approx(0.3)
    assert position[-1] == pytest.approx(0.3 * 1.1 / (1.0 + 0.1 * begun), rel=2e-3)


@pytest.mark.thorough
def test_it_is_told_from_a_motion_part_of_which_comes_late() -> None:
    record = a_record(plant("before the lag", "creep", "stretch", (0.05, 30.0, 1.0)), seed=5)
    found = diagnose([record], D, (), Settings(search=SearchRules(most=2))).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("creep", "stretch")]
    assert found.causes[0].parameters["share"].value == pytest.approx(0.05, abs=0.005)
    assert found.causes[0].parameters["tail"].value == pytest.approx(30.0, rel=0.15)
