"""Creep of what pulls the stem, which excess pressure presses on to the stop: against small steps of its law."""

from __future__ import annotations

import numpy as np
import pytest

from logs.recording import FloatArray
from tests.twin.kernels.test_relaxing import PRESSURE, TIME_S, D, K, creeping, stem
from twin.kernels.tails import held_by_tails
from twin.kernels.valve_slots import V_REMEMBERS
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, curve_tables


def stepped(share: float, tail_s: float, high: float, per: int = 100) -> FloatArray:
    """By explicit steps of a millisecond: a plate between friction and the stops, and its tail, pull the stem."""
    y, z, x, h, rows = 0.0, 0.0, 0.0, 0.1 / per, [0.0]
    for k in range(1, TIME_S.size):
        for n in range(per):
            p = PRESSURE[k - 1] + (PRESSURE[k] - PRESSURE[k - 1]) * (n + 1) / per
            y = max(K * (1.0 - share) * (p - D.a1), min(K * (1.0 - share) * (p - D.a2), y))
            y = min(high, max(0.0, y))
            z += h / tail_s * (share / (1.0 - share) * y - z)
            x += h * max(-D.rate_limit, min(D.rate_limit, (min(y + z, high) - x) / D.tau_s))
        rows.append(x)
    return np.array(rows)


def missing(share: float) -> tuple[Inserted, ...]:
    return (Inserted("reduced_travel", effect("reduced_travel").form("upper_stop"), (share,)),) if share else ()


@pytest.mark.parametrize("lost", [0.0, 0.1])
def test_it_is_the_law_in_small_steps(lost: float) -> None:
    law = stepped(0.2, 20.0, (1.0 - lost) * D.travel)
    for plant in (
        Plant(D, (*missing(lost), creeping("pressed_tail", 0.2, 20.0))),
        Plant(D, (*missing(lost), creeping("pressed_tails_apart", 0.2, 20.0, 5.0, 0.0))),
    ):
        assert np.abs(stem(plant) - law).max() < 1e-3 * D.travel


def test_what_is_pressed_on_the_stop_does_not_creep_there() -> None:
    """At 12.5 psi, 0.76 beyond the stop, a tail of a tenth is at the stop at once; without excess it stays short."""
    pressed, pulled = (stem(Plant(D, (creeping(form, 0.05, 40.0),))) for form in ("pressed_tail", "pull_tail"))
    at_stop = np.flatnonzero(TIME_S == 120.0)[0]
    assert pressed[at_stop] == pytest.approx(D.travel, abs=0.01 * D.travel)
    assert pulled[at_stop] < 0.975 * D.travel
    resting = np.flatnonzero(TIME_S == 30.0)[0]  # away from the stops they are the same
    assert pressed[resting] == pytest.approx(pulled[resting], abs=1e-6)


def test_what_was_pressed_on_before_the_record_may_hold_the_stem_by_more() -> None:
    """A tail has been beyond the stop, where what it is of had been pressed on to."""
    held = []
    for form in ("pressed_tail", "pull_tail"):
        c = Plant(D, (creeping(form, 0.2, 30.0),)).coefficients(100.0)
        c.valve[V_REMEMBERS] = 1.0
        force = np.array([0.5 * (D.a1 + D.a2) + 0.3 / K])
        what = (c.valve, curve_tables(c), (c.spreads, c.weights))
        held.append(held_by_tails(force, np.zeros(1), *what, (0.3 + 0.07, 0.3)))
    assert held[0] == pytest.approx(0.07)
    assert held[1] == pytest.approx(0.2 * (D.travel - 0.3))
