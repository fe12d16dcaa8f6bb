"""A converter that looks at its command in fixed cycles: its law, its clock in a record, and that it is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from logs.recording import FloatArray, Recording
from tests.twin.judged import UP_TO_TWO
from tests.twin.loops import D, plant
from twin.diagnose import diagnose
from twin.events.onsets import clocks, onsets
from twin.kernels.polled import polled
from twin.model.plant import Plant
from twin.replay.simulate import simulate_recording

CYCLE_S, DELAY_S = 1.3, 0.2


def slow(phase: float, delay_s: float = DELAY_S) -> Plant:
    return plant("before the lag", "dead_time", "polled", (CYCLE_S, delay_s, phase))


def steps(seed: int, n: int = 2400, noise_psi: float = 0.02) -> Recording:
    """Levels held for some seconds, not in step with any clock."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(n) * 0.1
    at = np.cumsum(rng.uniform(4.0, 9.0, 80))
    command = rng.uniform(5.0, 12.5, 81)[np.searchsorted(at, time_s)]
    return Recording(f"steps{seed}", time_s, command, np.zeros(n), np.full(n, command[0]))


def recorded(seed: int, phase: float, delay_s: float = DELAY_S) -> Recording:
    one, rng = steps(seed), np.random.default_rng(seed + 100)
    pressure, position = simulate_recording(slow(phase, delay_s), one)
    noisy = pressure + rng.normal(0.0, 0.02, one.n)
    return replace(one, pressure=noisy, position=position + rng.normal(0.0, 5e-4, one.n))


def seen(t: FloatArray, command: FloatArray, at: FloatArray, clock: tuple[float, float]) -> FloatArray:
    """What was in force at the last instant of the clock at or before each of `at`; the first command before that."""
    last = clock[0] + np.floor((at - clock[0]) / clock[1]) * clock[1]
    row = np.clip(np.searchsorted(t, last, side="left"), 0, t.size - 1)
    return np.where(last < t[0], command[0], command[row])


@pytest.mark.parametrize("first_s", [0.4, -3.0, 1.04])
@pytest.mark.parametrize("cycle_s", [0.033, 0.7, 1.3])
def test_it_holds_what_was_in_force_at_the_last_instant(first_s: float, cycle_s: float) -> None:
    one, per_row = steps(3, 300), 5
    offsets = np.arange(one.n) * per_row
    found = np.empty(offsets[-1] + 1)
    polled(one.time_s, one.command, offsets, (first_s, cycle_s), one.command[0], found)
    h = 0.1 / per_row
    within = (np.arange(1000) + 0.5) / 1000.0
    at = (np.arange(1, found.size)[:, None] - 1 + within) * h
    law = seen(one.time_s, one.command, at, (first_s, cycle_s)).mean(axis=1)
    np.testing.assert_allclose(found[1:], law, atol=0.05)


def test_the_clock_is_in_the_answers() -> None:
    records = [recorded(1, 0.3), recorded(2, 0.8)]
    found = [onsets(one) for one in records]
    (cycle_s, phases), *_ = clocks(found, 1)
    assert cycle_s == pytest.approx(CYCLE_S, rel=0.005)
    for phase, true in zip(phases, (0.3, 0.8), strict=True):
        assert abs((phase - true + 0.5) % 1.0 - 0.5) < 0.1
    delays_s = np.sort(np.concatenate([one.delays_s for one in found]))
    assert delays_s[0] > DELAY_S - 0.05 and delays_s[-10] < DELAY_S + CYCLE_S + 0.05


def test_where_nothing_tells_there_is_no_clock() -> None:
    still = steps(1)
    assert not clocks([onsets(replace(still, command=np.full(still.n, 8.0)))], 3)
    assert not clocks([onsets(replace(still, pressure=None))], 3)


def test_delays_that_are_all_alike_are_no_cycle() -> None:
    """But for the last digits, or for the instants of rows."""
    one = steps(1)
    for delay_s, noise_psi in ((0.0, 0.0), (0.4, 0.0), (0.4, 0.02)):
        pressure, _ = simulate_recording(plant("before the lag", "dead_time", "pure_delay", (delay_s,)), one)
        noisy = pressure + np.random.default_rng(2).normal(0.0, noise_psi, one.n)
        found = onsets(replace(one, pressure=noisy))
        assert found.delays_s.size > 20
        assert not clocks([found], 3)


def test_a_long_record_is_read_where_it_is_enough() -> None:
    """Of hundreds of thousands of rows, a ramp among them, the spectrum is that of the first answers."""
    n = 400_000
    one = steps(1, n)
    ramp = np.where(one.time_s > 0.5 * one.time_s[-1], 5.0 + (one.time_s % 60.0) / 10.0, one.command)
    pressure, _ = simulate_recording(slow(0.3), replace(one, command=ramp))
    found = onsets(replace(one, command=ramp, pressure=pressure))
    assert found.delays_s.size <= 60
    assert clocks([found], 1)[0][0] == pytest.approx(CYCLE_S, rel=0.005)


@pytest.mark.thorough
def test_commands_that_wait_for_a_scan_are_a_dead_time() -> None:
    said = diagnose([recorded(1, 0.3), recorded(2, 0.8)], D, (), UP_TO_TWO).diagnosis
    assert [(cause.name, cause.form) for cause in said.causes] == [("dead_time", "polled_each")]
    assert said.causes[0].parameters["cycle"].value == pytest.approx(CYCLE_S, rel=0.01)
