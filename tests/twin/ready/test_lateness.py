"""Commands that take effect a little after their rows: timing of the record, where nothing else does as well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.fit.case import make_case
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.ready.lateness import late_commands
from twin.replay.simulate import simulate_recording

DESIGN = DesignModel()
DELAY_S, NOISE_PSI, ROWS = 0.02, 0.05, 3000


def delay_for(ep_tau_s: float) -> list[float]:
    """What is taken for the delay of commands that are late by 20 ms, by unevenly timed rows of a converter."""
    dice = np.random.default_rng(3)
    even = a_record(Plant(DESIGN), n=ROWS)
    blank = replace(even, time_s=even.time_s + dice.uniform(-0.03, 0.03, ROWS))
    late = Inserted("dead_time", effect("dead_time").form("pure_delay"), (DELAY_S,))
    pressure, position = simulate_recording(Plant(replace(DESIGN, ep_tau_s=ep_tau_s), (late,)), blank)
    read = replace(
        blank, pressure=pressure + dice.normal(0.0, NOISE_PSI, ROWS), position=position + dice.normal(0.0, 4e-4, ROWS)
    )
    found, notes = late_commands(make_case([read], DESIGN))
    assert len(found) == len(notes)
    return [one.values[0] for one in found]


def test_a_small_delay_is_timing() -> None:
    assert delay_for(DESIGN.ep_tau_s) == [pytest.approx(DELAY_S, abs=0.005)]


def test_there_is_none_where_another_lag_alone_does_and_the_delay_alone_does_not() -> None:
    """Put in, it would leave a lag that is too long by as much, and somebody would be blamed for that."""
    assert delay_for(0.25) == []
