"""Scanning for the first value that hunts, and what is recommended."""

from __future__ import annotations

import numpy as np
import pytest

from control import robustness
from control.design import DesignModel
from control.robustness import AXES, Margin, Nominal, Plant, Subject, bears, nominal, recommended, scan
from control.trial import Opened

DESIGN = DesignModel()
SUBJECT = Subject("p", {}, DESIGN)


def no_bench(plant: Plant, seed: int) -> Opened:
    raise AssertionError("not asked for here")


def test_the_first_failure_counts_even_where_more_is_good_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def at_three_tenths(_: Subject, plant: Plant, seed: int, __: object) -> float:
        return float(seed) if abs(plant.dead_time_s - 0.3) < 1e-9 else 0.0

    monkeypatch.setattr(robustness, "largest_cycle", at_three_tenths)
    assert scan(SUBJECT, AXES["dead_time"], Plant(DESIGN), (0, 1), no_bench) == Margin(0.2, 0.3, 1.0)
    assert scan(SUBJECT, AXES["dead_time"], Plant(DESIGN), (0,), no_bench) == Margin(3.0, None)
    assert scan(SUBJECT, AXES["dead_time"], Plant(DESIGN, 0.2), (1,), no_bench) == Margin(None, 0.1, 1.0)


def test_every_axis_goes_outwards_and_passes_what_is_wanted() -> None:
    for axis in AXES.values():
        assert axis.wanted in axis.values
        away = [abs(np.log(v)) if "x," in axis.heading else abs(v) for v in axis.values]
        assert away == sorted(away)
        assert axis.change(Plant(DESIGN), axis.values[0]) != Plant(DESIGN)


def test_a_deadband_grows_around_its_middle() -> None:
    wider = AXES["wider"].change(Plant(DESIGN), 20.0).design
    assert wider.deadband == pytest.approx(1.2 * DESIGN.deadband)
    assert wider.offset == pytest.approx(DESIGN.offset)


def test_what_a_bench_should_bear() -> None:
    axis = AXES["dead_time"]
    assert [bears(m, axis) for m in (Margin(None, 0.1), Margin(0.1, 0.2), Margin(0.2, 0.3), Margin(3.0, None))] == [
        False,
        False,
        True,
        True,
    ]


def test_the_recommendation() -> None:
    designed = {"quick": Nominal(0.2, 0.0, 3.0), "slow": Nominal(0.1, 0.0, 9.0), "off": Nominal(0.5, 0.0, 1.0)}
    assert recommended(designed)[0] == "quick"
    wide = {key: Margin(axis.values[-1], None) for key, axis in AXES.items()}
    narrow = {**wide, "late": Margin(0.1, 0.2)}
    assert recommended(designed, {"quick": narrow, "slow": wide, "off": wide})[0] == "slow"
    assert recommended(designed, {"quick": narrow, "slow": narrow, "off": wide})[0] is None
    assert recommended({"quick": Nominal(0.2, 1.0, 3.0)})[0] is None


def test_nominal_is_the_worst_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    t = np.arange(600)
    holds = np.array([np.where(t < 30, 5.0, 0.1), np.where(t < 90, -5.0, -0.2), 0.05 + np.sin(t / 20.0)])
    monkeypatch.setattr(robustness, "hold_errors", lambda *_: holds)
    found = nominal(SUBJECT, Plant(DESIGN), (0,), no_bench)
    assert found.error == pytest.approx(0.2, abs=0.15)
    assert found.cycle == pytest.approx(2.0, rel=0.01)
    assert found.settling_s == float("inf")
    monkeypatch.setattr(robustness, "hold_errors", lambda *_: holds[:2])
    assert nominal(SUBJECT, Plant(DESIGN), (0,), no_bench) == Nominal(pytest.approx(0.2), 0.0, pytest.approx(9.0))
