"""A design fitted to the records: numbers near the truth even from far off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from tests.twin.toy_valve import Toy, record, staircase
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.ready.tuned import tuned_to


def test_numbers_come_back_from_a_design_that_never_moves() -> None:
    levels = np.random.default_rng(1).uniform(5.0, 12.0, 25).tolist()
    toy = replace(record(Toy(), staircase(0.05, 8.0, levels), 0.05, seed=1, sigma=8e-4), pressure=None)
    found = tuned_to([toy], replace(DesignModel(), a1=13.78))
    assert (found.a1, found.a2, found.compliance) == pytest.approx((8.78, 5.82, 0.19), rel=0.01)
    assert found.tau_s == pytest.approx(2.7, rel=0.03)


def test_a_late_sensor_does_not_bend_the_converter_whose_pressure_was_measured() -> None:
    late = Inserted("sensor_lag", effect("sensor_lag").form("first_order"), (0.5,))
    found = tuned_to([a_record(Plant(DesignModel(), (late,)))], DesignModel(ep_tau_s=0.45, compliance=0.21))
    assert found.ep_tau_s == pytest.approx(0.30, rel=0.01)
    assert found.compliance == pytest.approx(0.19, rel=0.03)


def test_a_record_that_rests_at_both_stops_gives_the_travel() -> None:
    found = tuned_to([a_record(Plant(DesignModel()), n=2400)], DesignModel(travel=0.6))
    assert found.travel == pytest.approx(0.5625, rel=0.003)


def test_a_valve_with_hardly_any_backlash_is_found_from_a_design_with_one() -> None:
    plain = replace(DesignModel(), a1=7.31, a2=7.29, compliance=0.1)
    found = tuned_to([a_record(Plant(plain))], DesignModel())
    assert found.deadband == pytest.approx(0.02, abs=0.006)
    assert found.compliance == pytest.approx(0.1, rel=0.01)
