"""Every experiment of the library is safe: within the limits, checked by its kind, and no longer than allowed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from control.experiment_catalog import experiment_kinds
from logs.recording import Recording
from twin.next.candidates import LONGEST_S, library, neighbours, repeated
from twin.next.limits import Limits, limits_of

PERCENT = DesignModel(a1=60.0, a2=40.0, compliance=2.5, travel=100.0, rate_limit=20.0, pressure_unit="percent")
KPA = DesignModel(a1=60.5, a2=40.1, compliance=0.0276, pressure_unit="kPa")


def limits(design: DesignModel, low: float, high: float, **meta: object) -> Limits:
    n = 1000
    command = np.where(np.arange(n) % 100 < 50, low, high)
    record = Recording("r", 0.1 * np.arange(n), command, np.zeros(n), pressure_unit=design.pressure_unit, meta=meta)
    return limits_of(design, [record])


@pytest.mark.parametrize(
    ("design", "low", "high"), [(DesignModel(), 4.0, 13.0), (PERCENT, 5.0, 95.0), (KPA, 30.0, 90.0)]
)
def test_library_stays_within_the_limits(design: DesignModel, low: float, high: float) -> None:
    bounds = limits(design, low, high)
    found = library(bounds)
    assert len(found) >= 20
    assert {one.kind for one in found} == set(experiment_kinds())
    for one in [*found, *(n for each in found for n in neighbours(each, bounds))]:
        assert one.range[0] >= bounds.low - 1e-9
        assert one.range[1] <= bounds.high + 1e-9
        assert one.duration_s <= LONGEST_S
        assert one.unit == bounds.unit


def test_limits_are_those_of_the_records_and_of_the_full_stroke() -> None:
    stroke = 0.5625 / 0.19
    narrow = limits(DesignModel(), 8.0, 9.0)
    assert narrow.low == pytest.approx(5.82 - 0.1 * stroke)
    assert narrow.high == pytest.approx(8.78 + 1.1 * stroke)
    wide = limits(DesignModel(), 4.0, 14.0)
    assert (wide.low, wide.high) == (4.0, 14.0)


def test_limits_never_leave_what_the_bench_allows() -> None:
    bounds = limits(DesignModel(), 4.0, 11.0, run={"bench": {"command_min": 4.5, "command_max": 11.5}})
    assert (bounds.low, bounds.high) == (4.5, 11.5)


def test_a_design_in_kilopascals_gives_commands_in_psi() -> None:
    bounds = limits(KPA, 30.0, 90.0)
    assert bounds.unit == "psi"
    assert bounds.scale == pytest.approx(6.894757)
    assert bounds.low == pytest.approx(30.0 / 6.894757, rel=1e-6)


def test_neighbours_differ_and_repeats_take_longer() -> None:
    bounds = limits(DesignModel(), 4.0, 13.0)
    for one in library(bounds):
        assert one not in neighbours(one, bounds)
        twice = repeated(one, 2)
        assert twice == replace(one, repeats=2)
        once_s = one.duration_s - sum(step.duration_s for step in one.conditioning_steps())
        assert twice.duration_s == pytest.approx(one.duration_s + once_s)
