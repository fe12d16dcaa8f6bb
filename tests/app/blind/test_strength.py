from __future__ import annotations

import numpy as np
import pytest

from app.blind.designs import margin
from app.blind.strength import stratum, strength
from sim_device.sealed import Cause, Label

TIME_S = np.arange(0.0, 60.0, 0.1)
COMMAND = np.where(TIME_S < 30.0, 12.0, 6.0)


def fault(size: float, family: str = "thesis") -> Label:
    return Label("effect", family, 5, (Cause("lvdt_calibration", "sensor", "zero", size, "1", "large"),))


def test_a_known_shift_has_its_own_size() -> None:
    found = strength(fault(0.02), TIME_S, COMMAND)
    assert found.gap_in == pytest.approx(0.02 * 0.5625, rel=1e-3)
    assert 0.0005 < found.noise_in < 0.001
    assert found.floor_in == found.noise_in


def test_a_healthy_valve_is_no_distance_from_itself() -> None:
    assert strength(Label("none", "thesis", 5, ()), TIME_S, COMMAND).ratio == 0.0


def test_of_two_faults_each_has_its_own_size() -> None:
    zero = Cause("lvdt_calibration", "sensor", "zero", 0.02, "1", "large")
    late = Cause("dead_time", "ep", "default", 0.01, "s", "small")
    found = strength(Label("effects", "thesis", 5, (zero, late)), TIME_S, COMMAND)
    assert found.alone_in[0] == pytest.approx(0.02 * 0.5625, rel=1e-3)
    assert 0.0 < found.alone_in[1] < 0.1 * found.alone_in[0] < found.gap_in
    assert found.weakest == found.alone_in[1] / found.floor_in


def test_on_first_principles_the_margin_counts_as_floor() -> None:
    found = strength(fault(0.02, "reference"), TIME_S, COMMAND)
    assert found.floor_in == pytest.approx(np.hypot(found.noise_in, margin("reference").position))


@pytest.mark.parametrize(
    ("ratio", "name"), [(0.0, "below 1"), (1.0, "1 to 3"), (2.9, "1 to 3"), (3.0, "3 to 10"), (10.0, "above 10")]
)
def test_strata(ratio: float, name: str) -> None:
    assert stratum(ratio) == name
