"""False readings that are no larger than what a fast stem could do are told by coming singly while it stood."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from logs.recording import FloatArray, Recording
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.events.scan import scan_events
from twin.model.plant import Plant
from twin.noise.model import estimate_noise
from twin.record.held_noise import noise_of_refreshed
from twin.record.sensing import sense
from twin.replay.simulate import simulate_recording

SPIKE_IN = 0.010  # a stem at the rate limit goes 0.012 in between two readings


def recorded() -> Recording:
    return trial_of(Plant(DESIGN), staircase())[0].recording


def found(recording: Recording) -> set[str]:
    return set(sense([recording], estimate_noise([recording]), DESIGN).accepted)


def spiked(position: FloatArray, rows: FloatArray) -> FloatArray:
    moved = position.copy()
    moved[rows.astype(int)] += SPIKE_IN
    return moved


@pytest.mark.parametrize(("count", "named"), [(40, True), (2, False)])
def test_small_spikes_of_a_still_reading(count: int, named: bool) -> None:
    recording = recorded()
    rows = np.random.default_rng(5).choice(recording.n, count, replace=False)
    assert SPIKE_IN > 15.0 * SIGMA
    assert ("sensor_dropouts" in found(replace(recording, position=spiked(recording.position, rows)))) is named


@pytest.mark.parametrize(("swing_psi", "named"), [(0.3, True), (3.0, False)])
def test_a_stem_that_never_stands_does_not_turn_without_crossing_the_deadband(swing_psi: float, named: bool) -> None:
    """One reading a second: a stem could go as far, and it is always on its way."""
    time_s = np.arange(1800.0)
    wave, rng = np.sin(2.0 * np.pi * time_s / 30.0), np.random.default_rng(3)
    position = 0.28 + 0.006 * wave + rng.normal(0.0, 4e-4, time_s.size)
    rows = np.arange(60, 1800, 150)  # where it is fastest
    slow = Recording("loop", time_s, 9.0 + swing_psi * wave, spiked(position, rows))
    assert ("sensor_dropouts" in found(slow)) is named


@pytest.mark.parametrize(("steps_in", "named"), [(0.0, True), (0.002, False)])
def test_a_stem_that_stands_while_the_commands_cross_most_of_the_deadband(steps_in: float, named: bool) -> None:
    """Among readings that lie together it has not gone away and come back; on its way it might have."""
    time_s, rng = np.arange(1800.0), np.random.default_rng(3)
    wave = np.sin(2.0 * np.pi * time_s / 30.0)
    position = 0.28 + steps_in * np.abs((time_s + 15.0) % 30.0 - 15.0) + rng.normal(0.0, 4e-4, time_s.size)
    rows = np.arange(67, 1800, 150)  # half way between two turns
    busy = Recording("loop", time_s, 9.0 + 0.45 * DESIGN.deadband * wave, spiked(position, rows))
    assert ("sensor_dropouts" in found(busy)) is named


def test_a_healthy_reading_is_not_false() -> None:
    assert "sensor_dropouts" not in found(recorded())


def test_one_reading_far_off_is_enough_when_it_outweighs_the_noise_of_all() -> None:
    recording = recorded()
    for size_in, named in ((0.3, True), (0.02, False)):
        position = recording.position.copy()
        position[1500] -= size_in
        assert ("sensor_dropouts" in found(replace(recording, position=position))) is named


@pytest.mark.parametrize("period_rows", [1.07, 1.15, 1.35])
def test_a_refresh_hardly_slower_than_the_polls_never_holds_twice_running(period_rows: float) -> None:
    recording = fast_moving()
    source = np.floor(np.floor(np.arange(recording.n) / period_rows) * period_rows).astype(int)
    assert "stale_samples" in found(replace(recording, position=recording.position[source]))


@pytest.mark.parametrize("share", [0.07, 0.15])
def test_as_many_lost_replies_do_hold_twice_running(share: float) -> None:
    recording = fast_moving()
    lost = np.random.default_rng(7).random(recording.n) < share
    source = np.maximum.accumulate(np.where(lost, 0, np.arange(recording.n)))
    assert "stale_samples" not in found(replace(recording, position=recording.position[source]))


@pytest.mark.parametrize(("rows", "stale"), [(25, True), (6, True), (1, False)])
def test_readings_that_hang_now_and_then_are_stale(rows: int, stale: bool) -> None:
    """As many held readings one by one are lost replies."""
    record, dice = fast_moving(), np.random.default_rng(4)
    reading = record.position.copy()
    for at in dice.choice(record.n // 30 - 1, record.n // (16 * rows), replace=False) if rows > 1 else ():
        reading[30 * at : 30 * at + rows] = reading[30 * at]
    for at in dice.choice(np.arange(1, record.n), record.n // 16, replace=False) if rows == 1 else ():
        reading[at] = reading[at - 1]
    assert ("stale_samples" in found(replace(record, position=reading))) is stale


def fast_moving() -> Recording:
    """Readings so fine that no two are alike by chance."""
    recording = recorded()
    noise = np.random.default_rng(3).normal(0.0, SIGMA, recording.n)
    return replace(recording, position=recording.position + 0.1 * noise)


@pytest.mark.parametrize("codes", range(20, 32))
def test_steps_are_sharp_whatever_the_number_of_codes(codes: int) -> None:
    """The error of rounding is a mean over the codes, which is a twelfth for all of them but for its last bit."""
    fine = recorded()
    step_in = float(np.ptp(fine.position)) / (codes - 1)
    steps = replace(fine, position=step_in * np.round(fine.position / step_in))
    assert sense([steps], estimate_noise([steps]), DESIGN).sharp


def test_coarse_steps_of_a_slow_staircase_are_not_taken_for_held_readings() -> None:
    """Nine steps for the whole travel repeat in most rows, and the next one is no noise of the readings."""
    time_s = 0.04 * np.arange(9000)
    levels = np.concatenate([np.arange(4.0, 13.0, 0.3), np.arange(13.0, 4.0, -0.3)])
    command = levels[(time_s // 10.0).astype(int) % levels.size]
    blank = Recording("staircase", time_s, command, np.zeros(9000), np.zeros(9000))
    pressure, position = simulate_recording(Plant(DESIGN), blank)
    fine = position + np.random.default_rng(1).normal(0.0, 1e-3, 9000)
    coarse = replace(blank, pressure=pressure, position=0.06 * np.round(fine / 0.06))
    noise = estimate_noise([coarse])
    stale = scan_events(coarse, noise).evidence["stale_samples"]
    assert stale.found
    assert stale.estimates["hold_fraction"].value > 0.4
    assert noise_of_refreshed([coarse], noise) is noise
