"""A position that is no 0 at fully open: found where the open stop shows, and left alone where it does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.identify import identify
from control.identify_zero import zero_of, zeroed
from logs.recording import Recording
from tests.control.toy_valve import Toy, random_steps, record, without_pressure

TOY = Toy()


@pytest.fixture(scope="module")
def swept() -> Recording:
    command = random_steps(240.0, 0.2, seed=3)
    return record(TOY, 0.2 * np.arange(command.size), command)


def off(recording: Recording, zero_in: float) -> Recording:
    return replace(recording, position=recording.position + zero_in)


@pytest.mark.parametrize("zero_in", [2.0, 0.2, 0.06, -0.05, -0.28])
@pytest.mark.parametrize("measured", [True, False])
def test_the_reading_at_the_open_stop_is_found(swept: Recording, zero_in: float, measured: bool) -> None:
    moved = off(swept if measured else without_pressure(swept), zero_in)
    assert zero_of([moved]) == pytest.approx(zero_in, abs=3e-4)


def test_with_it_taken_off_the_numbers_are_the_valves(swept: Recording) -> None:
    in_mm = replace(off(swept, 10.0 / 25.4), meta={"written": {"command": "psi", "position": "mm"}})
    (done,) = zeroed([replace(in_mm, target=in_mm.position)])
    found = identify([done])
    assert found.design.travel == pytest.approx(TOY.travel, rel=2e-3)
    assert found.design.a2 == pytest.approx(TOY.a2, abs=0.02)
    assert identify([in_mm]).design.travel > 0.9  # taken for travel
    assert done.target is not None and np.array_equal(done.target, done.position)
    assert done.notes[-1].what == "the position reads 10 mm where the stem is fully open"


def test_a_stem_that_only_stays_away_has_no_zero(swept: Recording) -> None:
    assert zero_of([swept]) is None
    assert zeroed([swept]) == [swept]
    command = random_steps(240.0, 0.2, low=9.2, high=10.4, seed=3)
    away = record(TOY, 0.2 * np.arange(command.size), np.maximum(command, 9.2)).slice(200, 1200)
    assert away.position.min() > 0.25 * np.ptp(away.position)
    assert zero_of([away]) is None


@pytest.mark.parametrize(("low", "high", "seed"), [(6.3, 10.9, 3), (6.3, 10.9, 4), (6.1, 11.5, 4), (7.0, 10.9, 4)])
def test_a_stem_that_stays_away_by_less_has_none_either(low: float, high: float, seed: int) -> None:
    """In the last the free fit ends far off, but what fits with a stop needs none."""
    command = random_steps(240.0, 0.2, low=low, high=high, seed=seed)
    away = record(TOY, 0.2 * np.arange(command.size), np.maximum(command, low)).slice(200, 1200)
    assert away.position.min() > 0.05 * np.ptp(away.position)
    assert zero_of([away]) is None


def test_a_small_zero_is_left_to_the_diagnosis(swept: Recording) -> None:
    assert zero_of([off(swept, 0.02)]) is None


def test_less_than_what_is_asked_for_is_left_to_the_diagnosis(swept: Recording) -> None:
    assert zero_of([off(swept, 0.3)], far=1.0) is None
    assert zero_of([off(swept, 0.7)], far=1.0) == pytest.approx(0.7, abs=3e-4)


def test_what_does_not_move_or_is_too_short_has_none(swept: Recording) -> None:
    assert zero_of([replace(swept, position=np.random.default_rng(1).normal(3.0, 6e-4, swept.n))]) is None
    assert zero_of([replace(swept, command=np.full(swept.n, 5.0))]) is None
    assert zero_of([off(swept.slice(0, 20), 2.0)]) is None
