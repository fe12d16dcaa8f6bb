"""What changes with time goes on from recording to recording, in the play and in the spring."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.in_time import as_unbroken, widening_at
from twin.model.catalog import effect
from twin.model.coefficients import Coefficients
from twin.model.place import Place

T = np.linspace(0.0, 99.0, 100)


def coefficients(name: str, form: str, values: tuple[float, ...], place: Place | None, duration_s: float) -> FloatArray:
    c = Coefficients(DesignModel(), duration_s, place)
    effect(name).form(form).apply(c, values)
    return c.valve


@pytest.mark.parametrize(
    ("name", "form", "values"),
    [
        ("friction_drift", "sudden_easing", (0.4, 0.3, 0.6, 40.0)),
        ("friction_drift", "sudden_easing", (0.4, 0.7, 0.6, 40.0)),
        ("nonlinear_spring", "breaks", (-0.6, 0.2, 0.3)),
        ("nonlinear_spring", "breaks", (-0.6, 0.2, 0.7)),
    ],
)
def test_two_halves_are_the_whole(name: str, form: str, values: tuple[float, ...]) -> None:
    """Before and after the change: a second recording has what the first has left of it."""
    whole = coefficients(name, form, values, None, 200.0)
    times = np.concatenate([T, 100.0 + T])
    halves = [coefficients(name, form, values, Place(k, 2, before_s=100.0 * k, all_s=200.0), 100.0) for k in range(2)]
    for law in (widening_at, lambda t, c: as_unbroken(np.full(t.size, 8.0), t, c)):
        together = np.concatenate([law(T, half) for half in halves])
        assert together == pytest.approx(law(times, whole), abs=1e-12)
    changed = (widening_at(times, whole) != 0.0) | (as_unbroken(np.full(200, 8.0), times, whole) != 8.0)
    assert changed.any() and not changed.all()


def test_what_comes_gradually_goes_on_by_the_clock_that_recordings_share() -> None:
    values = (0.4, 100.0, 10.0)
    whole = widening_at(np.concatenate([T, 100.0 + T]), coefficients("friction_drift", "gradual", values, None, 200.0))
    places = (Place(k, 2, since_s=100.0 * k, span_s=200.0) for k in range(2))
    halves = [widening_at(T, coefficients("friction_drift", "gradual", values, place, 100.0)) for place in places]
    assert np.concatenate(halves) == pytest.approx(whole, abs=1e-12)
    assert whole[0] < 1e-4
    assert whole[100] == pytest.approx(0.2)
    assert whole[110] == pytest.approx(0.4 / (1.0 + np.exp(-1.0)))
    assert whole[-1] > 0.4 - 1e-4
    own = widening_at(T, coefficients("friction_drift", "gradual", values, Place(1, 2, before_s=100.0), 100.0))
    assert own == pytest.approx(whole[:100])  # with a clock of its own it begins anew, as all that drifts
