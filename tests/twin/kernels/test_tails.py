"""A noise with a heavy tail is no drop-out, and drop-outs in such a noise are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO, a_record
from twin.diagnose import diagnose
from twin.events.dropouts import find_dropouts
from twin.events.tails import Tail, together
from twin.model.plant import Plant
from twin.noise.model import estimate_noise
from twin.record.far_readings import heavy_tail
from twin.record.sensing import Sensing, sense

DESIGN = DesignModel()
NOISE_IN = 0.004


def readings(tailed: bool, spikes: int = 0, size: float = 0.2, seed: int = 1) -> Recording:
    """A healthy valve of 15000 rows; `tailed`: its noise is Student's of four degrees of freedom, of the same RMS.

    `spikes`: so many readings are false by up to `size` [in], by half of it at least.
    """
    dice = np.random.default_rng(seed)
    record = a_record(Plant(DESIGN), n=15000)
    noise = dice.standard_t(4, record.n) / np.sqrt(2.0) if tailed else dice.normal(size=record.n)
    position = record.position + NOISE_IN * noise
    at = dice.choice(np.arange(10, record.n - 10), spikes, replace=False)
    position[at] += dice.choice([-1.0, 1.0], spikes) * dice.uniform(0.5, 1.0, spikes) * size
    return replace(record, position=position)


def sensed(record: Recording) -> Sensing:
    return sense([record], estimate_noise([record]), DESIGN)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_a_heavy_tail_is_noise_and_is_said(seed: int) -> None:
    """Without a look at the tail each of these would be drop-outs, and surely."""
    seen = sensed(readings(True, seed=seed))
    assert seen.bad_rows[0].sum() >= 3
    assert "sensor_dropouts" not in seen.accepted
    [note] = heavy_tail(seen)
    assert note.rows == seen.bad_rows[0].sum()


@pytest.mark.parametrize(("tailed", "spikes"), [(True, 30), (False, 5), (False, 30)])
@pytest.mark.parametrize("size", [0.1, 0.4])
def test_what_lies_anywhere_is_false(tailed: bool, spikes: int, size: float) -> None:
    seen = sensed(readings(tailed, spikes, size))
    assert "sensor_dropouts" in seen.accepted
    assert heavy_tail(seen) == []


def test_gaussian_noise_has_nothing_to_say() -> None:
    seen = sensed(readings(False))
    assert seen.events[0].tail.excess.size == 0 and not seen.events[0].tail.heavy
    assert heavy_tail(seen) == []


def test_a_single_reading_is_nothing_to_speak_of() -> None:
    record = readings(False)
    record.position[4000] += 12.0 * NOISE_IN
    seen = sensed(record)
    assert seen.bad_rows[0].sum() == 1 and "sensor_dropouts" not in seen.accepted
    assert heavy_tail(seen) == []


def test_recordings_count_together() -> None:
    """Two of three readings say nothing; of twelve alike hardly one would lie so near."""
    few = Tail(2, np.array([1.3, 1.3]))
    assert few.heavy
    assert not together([few] * 6).heavy


@pytest.mark.parametrize(("near", "far", "heavy"), [(20, 6, True), (20, 18, False), (0, 0, False)])
def test_what_is_found_in_between_decides(near: int, far: int, heavy: bool) -> None:
    assert Tail(near, np.full(far, 1.2)).heavy is heavy


def test_readings_far_beyond_are_no_tail_however_many_are_near() -> None:
    assert not Tail(100, np.full(5, 8.0)).heavy
    assert Tail(100, np.full(5, 1.4)).heavy


def test_what_is_near_is_asked_for_less_in_everything() -> None:
    """A reading that stands out by three quarters of what a false one does is near, and not false."""
    dice = np.random.default_rng(3)
    y = 0.3 + 0.001 * dice.normal(size=500)
    found = find_dropouts(y, 0.001)
    assert (found.tail.near, found.tail.excess.size) == (0, 0)
    y[250] += 0.0062
    found = find_dropouts(y, 0.001)
    assert (found.tail.near, int(found.rows.sum())) == (1, 0)
    y[100] += 0.03
    found = find_dropouts(y, 0.001)
    assert (found.tail.near, found.tail.excess.size, int(found.rows.sum())) == (2, 1, 1)


@pytest.mark.thorough
def test_a_healthy_valve_with_such_a_noise_has_no_gap() -> None:
    found = diagnose([readings(True)], DESIGN, (), UP_TO_TWO).diagnosis
    assert found.verdict == "no_gap"
    assert any("heavy tail" in note.what for note in found.data_quality)
