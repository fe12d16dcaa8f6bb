"""Event tests: each finds its effect at the right size, and nothing where nothing is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from logs.recording import Recording
from tests.twin.toy_valve import Toy, record, staircase
from twin.events.dropouts import find_dropouts
from twin.events.scan import Events, scan_events
from twin.events.stale import chance_equal
from twin.noise.lattice import lattice_step, step_doubt
from twin.noise.model import estimate_noise

DT = 0.1
SIGMA = 8e-4
STEP = 0.6 / 4096
COMMAND = staircase(DT, 20.0, [5.0, 9.5, 11.0, 9.0, 7.0, 5.5, 10.5, 4.0, 13.0, 8.0])
RAMP = np.concatenate([np.linspace(5, 12, 1400), np.linspace(12, 4, 1600)])


def quantized(recording: Recording, step: float = STEP) -> Recording:
    return replace(recording, position=np.round(recording.position / step) * step)


def scan(recording: Recording) -> Events:
    return scan_events(recording, estimate_noise([recording]))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("command", [COMMAND, RAMP], ids=["steps", "ramp"])
def test_a_clean_record_shows_nothing(seed: int, command: np.ndarray) -> None:
    events = scan(quantized(record(Toy(), command, DT, seed, SIGMA)))
    assert [name for name, evidence in events.evidence.items() if evidence.found] == []
    assert not events.false_position.any()


def test_stale_samples_and_their_period() -> None:
    fresh = quantized(record(Toy(), COMMAND, DT, 1, SIGMA))
    rows = np.floor(np.arange(fresh.n) / 2.5).astype(int)
    held = replace(fresh, position=fresh.position[np.ceil(rows * 2.5).astype(int)])
    evidence = scan(held).evidence["stale_samples"]
    assert evidence.found
    period = evidence.estimates["refresh_period"]
    assert period.value == pytest.approx(0.25, rel=0.08)
    assert period.ci95[0] < 0.25 < period.ci95[1]
    assert evidence.estimates["regularity"].value > 0.7


def test_lost_replies_hold_at_random_not_evenly() -> None:
    fresh = quantized(record(Toy(), COMMAND, DT, 2, SIGMA))
    lost = np.random.default_rng(0).random(fresh.n) < 0.2
    source = np.maximum.accumulate(np.where(lost, 0, np.arange(fresh.n)))
    evidence = scan(replace(fresh, position=fresh.position[source])).evidence["stale_samples"]
    assert evidence.found
    assert evidence.estimates["hold_fraction"].value == pytest.approx(0.2, abs=0.04)
    assert abs(evidence.estimates["regularity"].value) < 0.4


@pytest.mark.parametrize("hold", [0.6, 0.683, 0.9])
def test_the_share_that_is_held_is_known_to_a_percent(hold: float) -> None:
    recording = record(Toy(), COMMAND, DT, 3, SIGMA)
    dice = np.random.default_rng(6)
    rows = np.maximum.accumulate(np.where(dice.random(recording.n) > hold, np.arange(recording.n), 0))
    found = scan(replace(recording, position=recording.position[rows])).evidence["stale_samples"].estimates
    truly = float(np.mean(np.diff(rows) == 0))
    assert found["hold_fraction"].value == pytest.approx(truly, abs=0.01)
    assert found["refresh_period"].value == pytest.approx(recording.period_s / (1.0 - truly), rel=0.03)


def test_coarse_steps_alone_are_not_stale() -> None:
    coarse = quantized(record(Toy(), COMMAND, DT, 3, SIGMA / 8), 20 * STEP)
    events = scan(coarse)
    assert not events.evidence["stale_samples"].found
    assert events.evidence["sensor_quantization"].found
    assert events.evidence["sensor_quantization"].estimates["step"].value == pytest.approx(20 * STEP, rel=1e-6)


def test_chance_of_equal_readings_against_draws() -> None:
    rng = np.random.default_rng(4)
    start = rng.uniform(0, 50, 200_000)
    moved = start + 0.6 + 0.8 * rng.standard_normal(start.size)
    drawn = np.mean(np.round(start) == np.round(moved))
    assert chance_equal(np.array([0.6]), 0.8, 1.0)[0] == pytest.approx(drawn, abs=0.005)
    assert chance_equal(np.array([0.25]), 0.0, 1.0)[0] == pytest.approx(0.75)


def test_false_readings_are_found_where_they_are() -> None:
    clean = record(Toy(), COMMAND, DT, 5, SIGMA)
    rng = np.random.default_rng(1)
    false = (rng.random(clean.n) < 0.01) & (clean.position > 0.05)
    position = np.where(false, 0.0, clean.position)
    found = find_dropouts(position, SIGMA)
    assert np.mean(found.rows[false]) > 0.9
    assert np.mean(found.rows[~false]) < 2e-3
    assert found.codes == (0.0,)
    rate = found.evidence.estimates["rate"]
    assert rate.ci95[0] < false.mean() < rate.ci95[1]
    assert found.evidence.found


@pytest.mark.parametrize("row", [0, -1])
def test_a_false_reading_at_an_end_of_the_record_is_found(row: int) -> None:
    position = record(Toy(), COMMAND, DT, 5, SIGMA).position.copy()
    position[row] += 0.3
    assert np.flatnonzero(find_dropouts(position, SIGMA).rows).tolist() == [row % position.size]


def test_tips_of_motion_are_no_false_readings() -> None:
    command = np.tile([12.5] * 25 + [4.0] * 25, 30).astype(float)  # the stem turns round in full motion
    moving = record(Toy(tau_s=0.5, rate=1.0), command, DT, 3, SIGMA)
    assert np.ptp(moving.position) > 0.3
    assert not find_dropouts(moving.position, SIGMA).rows.any()
    assert moving.pressure is not None
    assert not find_dropouts(moving.pressure, 0.02).rows.any()


@pytest.mark.parametrize("step", [0.0, 3.0, 10.0])
def test_false_readings_in_a_motion_are_found(step: float) -> None:
    """Steps of several sigmas from reading to reading: the neighbours of a false one are where they should be."""
    ramp = step * SIGMA * np.arange(200.0)
    position = ramp + SIGMA * np.random.default_rng(2).standard_normal(ramp.size)
    rows = [30, 31, 90, 150]
    position[rows] += 100.0 * SIGMA * np.array([1.0, 1.0, -1.0, 1.0])
    assert np.flatnonzero(find_dropouts(position, SIGMA).rows).tolist() == rows


@pytest.mark.parametrize("plain", [3, 0])
def test_small_ones_beside_fast_steps_are_found_where_there_are_false_readings_beyond_doubt(plain: int) -> None:
    """By less than two steps out: no further away than the readings around them, but beside their way."""
    way = np.concatenate(
        [np.zeros(60), 10.0 * np.arange(1, 61.0), np.full(60, 600.0), 600.0 - 8.0 * np.arange(1, 61.0)]
    )
    position = SIGMA * (way + np.random.default_rng(4).standard_normal(way.size))
    sure, small = [20, 140, 150][:plain], [80, 95, 200]
    position[sure] += 100.0 * SIGMA
    position[small] += SIGMA * np.array([17.0, -18.0, 16.0])
    assert np.flatnonzero(find_dropouts(position, SIGMA).rows).tolist() == sorted([*sure, *(small if plain else [])])


def test_corners_of_motion_are_no_false_readings_where_there_are_some() -> None:
    command = np.tile([12.5] * 25 + [4.0] * 25, 30).astype(float)
    moving = record(Toy(tau_s=0.5, rate=1.0), command, DT, 3, SIGMA)
    assert moving.pressure is not None
    for reading, sigma in ((moving.position, SIGMA), (moving.pressure, 0.02)):
        false = np.arange(215, reading.size, 300)
        found = find_dropouts(np.where(np.isin(np.arange(reading.size), false), reading + 50.0, reading), sigma)
        assert np.flatnonzero(found.rows).tolist() == false.tolist()


def test_a_jump_that_stays_is_no_dropout() -> None:
    position = np.where(np.arange(500) < 250, 0.1, 0.3) + SIGMA * np.random.default_rng(0).standard_normal(500)
    assert not find_dropouts(position, SIGMA).rows.any()


def test_lattice_of_converted_counts_and_of_none() -> None:
    rng = np.random.default_rng(8)
    counts = rng.integers(300, 3000, 3000)
    assert lattice_step(counts * STEP + 0.01) == pytest.approx(STEP, rel=1e-6)
    assert lattice_step(np.round(counts * STEP * 8, 4)) == pytest.approx(8 * STEP, rel=1e-3)
    assert lattice_step(rng.standard_normal(3000)) is None
    assert lattice_step(np.array([0.0, 1.0, 2.0])) is None


def test_a_lattice_of_few_levels_is_known_when_each_is_read_often() -> None:
    """A reading that knows six positions on all of the travel is coarse; six values that are held are not."""
    rng = np.random.default_rng(3)
    coarse = np.floor(rng.uniform(0.0, 6.0, 900)) * 0.0672
    assert lattice_step(np.round(coarse, 5)) == pytest.approx(0.0672, rel=1e-3)
    assert lattice_step(coarse[:60]) is None
    held = np.repeat(rng.uniform(0.0, 0.56, 6), 150)
    assert lattice_step(held) is None


@pytest.mark.parametrize("register", [0.0, 3e-6, 4e-5])
def test_the_step_is_known_as_well_as_readings_that_were_rounded_once_more_tell(register: float) -> None:
    rng, step = np.random.default_rng(5), 0.005093
    for _ in range(20):
        reading = np.round(rng.uniform(0.0, 0.56, 4000) / step) * step
        reading = np.round(reading / register) * register if register else reading
        found = lattice_step(reading)
        assert found is not None
        doubt = step_doubt(reading, found)
        assert abs(found - step) <= doubt + 1e-12
        assert doubt < 0.02 * max(register, 1e-6)


def test_false_readings_do_not_blur_a_step() -> None:
    rng, step = np.random.default_rng(6), 0.005
    reading = np.round(rng.uniform(0.0, 0.56, 4000) / step) * step
    reading[rng.choice(4000, 40, replace=False)] = rng.uniform(-3.0, 3.0, 40)
    assert step_doubt(reading, step) < 1e-9


def test_a_reading_that_never_changes_is_not_refreshed_slowly() -> None:
    """One record of several may rest at a stop, whose reading is rounded: nothing is seen of when it was read."""
    rests = Recording("rest", DT * np.arange(400), np.full(400, 15.0), np.full(400, 0.5625))
    noise = estimate_noise([rests, quantized(record(Toy(), COMMAND, DT, 1, SIGMA))])
    assert not scan_events(rests, noise).evidence["stale_samples"].found
    once = replace(rests, position=np.where(np.arange(400) < 200, 0.5625, 0.5624))
    period = scan_events(once, noise).evidence["stale_samples"].estimates["refresh_period"]
    assert np.isfinite([period.value, *period.ci95]).all()
    assert period.value <= once.duration_s
