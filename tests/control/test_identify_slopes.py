"""k1 and k2, and what is said when they differ."""

from __future__ import annotations

import pytest

from control.experiments.staircase import Staircase
from control.identify import identify
from control.identify_result import Identified
from logs.recording import Recording
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record


def identified(asymmetry: float) -> Identified:
    schedule = Staircase(step=0.4, dwell_s=10.0).commands()
    valve = make_physics("thesis", 3, effects={"spring_asymmetry": asymmetry})
    pressure, position = record(valve, schedule.time_s, schedule.command)
    return identify([Recording("x", schedule.time_s, schedule.command, position, pressure)])


def test_curves_that_are_not_parallel_are_said_with_where_each_of_them_begins() -> None:
    found = identified(0.06)
    (note,) = (note for note in found.notes if "not parallel" in note)
    k1, k2 = found["k1"].value, found["k2"].value
    assert k1 / k2 - 1.0 == pytest.approx(0.06, abs=0.01)
    assert f"differ by {200.0 * (k1 - k2) / (k1 + k2):.2g} %" in note
    a1, a2 = (float(note.partition(f"{name} = ")[2].split()[0]) for name in ("a1", "a2"))
    assert (a1, a2) == pytest.approx((8.78, 5.82), abs=0.01)
    assert abs(found["a1"].value - 8.78) > 0.02  # the compromise that the note speaks of


def test_parallel_curves_get_no_note() -> None:
    assert not [note for note in identified(0.0).notes if "parallel" in note]
