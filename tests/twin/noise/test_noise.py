"""Noise without a model: the right sigma and memory from repeats, still stretches and fast changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from logs.recording import Recording
from tests.twin.toy_valve import Toy, record, staircase
from twin.noise.fast import fast_memory
from twin.noise.model import estimate_noise, poisson_tail
from twin.noise.repeats import _longest, find_repeats
from twin.noise.robust import autocorrelation, autoregression, correlation_samples, robust_sigma
from twin.noise.still import even_windows, given_back, still_pieces

DT = 0.1
SIGMA = 8e-4
LEVELS = [5.0, 9.5, 11.0, 9.0, 7.0, 5.5, 10.5, 4.0, 12.0, 8.0]


def coloured(n: int, memory: float, sigma: float, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    shock = rng.standard_normal(n + 500) * sigma * np.sqrt(1 - memory**2)
    out = np.zeros(n + 500)
    for i in range(1, out.size):
        out[i] = memory * out[i - 1] + shock[i]
    return out[500:]


def runs(sigmas: list[float], memory: float = 0.0) -> list[Recording]:
    command = staircase(DT, 20.0, LEVELS)
    made = []
    for seed, sigma in enumerate(sigmas):
        clean = record(Toy(), command, DT, seed, 0.0)
        made.append(replace(clean, position=clean.position + coloured(clean.n, memory, sigma, seed + 50)))
    return made


def test_repeats_give_sigma_memory_and_white_innovations() -> None:
    recordings = runs([SIGMA, SIGMA], memory=0.7)
    noise = estimate_noise(recordings)
    assert noise.pairs == 1
    assert noise.position.source == "repeats"
    assert noise.position.sigma == pytest.approx(SIGMA, rel=0.1)
    assert noise.position.correlation_samples == pytest.approx((1 + 0.7) / (1 - 0.7), rel=0.35)
    white = noise.whiten(coloured(4000, 0.7, SIGMA, 99))
    assert np.std(white) == pytest.approx(1.0, rel=0.1)
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.08
    assert noise.pressure is not None
    assert noise.pressure.sigma == pytest.approx(0.02, rel=0.1)


def test_one_record_without_repeats_uses_still_stretches() -> None:
    noise = estimate_noise(runs([SIGMA]))
    assert noise.position.source == "still"
    assert noise.position.sigma == pytest.approx(SIGMA, rel=0.12)


def test_always_moving_falls_back_to_fast_changes_and_says_so() -> None:
    n = 3000
    time = np.arange(n) * DT
    rng = np.random.default_rng(3)
    position = 0.28 + 0.2 * np.sin(2 * np.pi * time / 8) + SIGMA * rng.standard_normal(n)
    command = 8 + np.sin(time) + np.sin(0.77 * time**1.1)
    noise = estimate_noise([Recording("moving", time, command, position)])
    assert noise.position.source == "high_frequency"
    assert noise.position.sigma == pytest.approx(SIGMA, rel=0.15)
    assert noise.pressure is None


def test_an_even_command_will_do_for_the_pressure() -> None:
    command = np.interp(np.arange(4000), [0, 1900, 2100, 4000], [4.0, 12.0, 12.1, 4.5])
    clean = record(Toy(), command, DT, 0, SIGMA, 0.0)
    assert clean.pressure is not None
    memory = replace(clean, pressure=clean.pressure + coloured(clean.n, 0.5, 0.02, 7))
    noise = estimate_noise([memory]).pressure
    assert noise is not None
    assert noise.source == "straight"
    assert noise.sigma == pytest.approx(0.02, rel=0.15)
    assert noise.correlation_samples == pytest.approx(3.0, rel=0.35)


def test_memory_of_the_fast_part_and_what_parabolas_take() -> None:
    level, phi = fast_memory(coloured(40000, 0.8, 1.0, 3) + 3 * np.sin(np.arange(40000) / 400))
    assert level == pytest.approx(1.0, rel=0.15)
    assert phi == pytest.approx(0.8, abs=0.1)
    pieces = still_pieces(coloured(20000, 0.8, 1.0, 4), 0.1, even_windows(20000, 0.1) // 26 * 26)
    sizes = [piece.size for piece in pieces]
    rho, factor = given_back(autocorrelation(pieces), sizes)
    assert rho[1] == pytest.approx(0.8, abs=0.07)
    assert factor * robust_sigma(np.concatenate(pieces)) == pytest.approx(1.0, rel=0.15)


def test_a_period_inside_one_record_is_a_repeat() -> None:
    command = np.tile(staircase(DT, 15.0, LEVELS[:5]), 3)
    pairs = find_repeats([record(Toy(), command, DT, 1, SIGMA)])
    assert len(pairs) == 1
    assert pairs[0].shift_s == pytest.approx(75.0)
    difference = pairs[0].difference("position")
    assert difference is not None
    assert robust_sigma(difference) == pytest.approx(SIGMA, rel=0.12)


def test_a_sine_is_laid_over_itself_to_a_part_of_a_row() -> None:
    """Half a row off, what moves differs by ten times its noise."""
    t = np.arange(0.0, 400.0, DT)
    dice, period_s = np.random.default_rng(4), 41.2345
    swing = np.sin(2.0 * np.pi * t / period_s) + 0.4 * np.sin(6.0 * np.pi * t / period_s + 1.0)
    one = Recording("sines", t, 8.0 + 3.0 * swing, 0.25 + 0.2 * swing + dice.normal(0.0, SIGMA, t.size), None)
    (pair,) = find_repeats([one])
    assert pair.shift_s % period_s == pytest.approx(0.0, abs=0.06 * DT)
    assert estimate_noise([one]).position.sigma == pytest.approx(SIGMA, rel=0.15)


def test_a_repeat_is_found_behind_a_stroke_that_is_not_repeated() -> None:
    stroke, sweep = staircase(DT, 20.0, [12.0, 4.0, 6.5]), staircase(DT, 15.0, LEVELS[:6])
    command = np.concatenate([stroke, sweep, np.full(80, 4.5), sweep])
    (pair,) = find_repeats([record(Toy(), command, DT, 1, SIGMA)])
    assert pair.shift_s == pytest.approx((sweep.size + 80) * DT)
    assert pair.rows.start == pytest.approx(stroke.size, abs=40)
    assert pair.rows.stop - pair.rows.start == pytest.approx(sweep.size, abs=80)


@given(st.lists(st.booleans(), min_size=1, max_size=60))
def test_the_longest_agreeing_stretch(agree: list[bool]) -> None:
    rows = np.array(agree)
    begin, end = _longest(rows)

    def worth(a: int, b: int) -> float:
        return float(np.sum(np.where(rows[a:b], 0.03, -0.97)))

    every = [worth(a, b) for a in range(rows.size + 1) for b in range(a, rows.size + 1)]
    assert worth(begin, end) == pytest.approx(max(every))


def test_shifted_repeats_align_and_different_commands_do_not() -> None:
    command = staircase(DT, 20.0, LEVELS)
    first = record(Toy(), command, DT, 1, SIGMA)
    late = record(Toy(), np.concatenate([np.full(70, 5.0), command]), DT, 2, SIGMA)
    other = record(Toy(), staircase(DT, 20.0, LEVELS[::-1]), DT, 3, SIGMA)
    pairs = find_repeats([first, late])
    assert [pair.shift_s for pair in pairs] == [pytest.approx(7.0)]
    assert find_repeats([first, other]) == []


def test_false_readings_do_not_raise_sigma_but_show_as_heavy_tails() -> None:
    recordings = runs([SIGMA, SIGMA])
    rng = np.random.default_rng(5)
    spoiled = []
    for recording in recordings:
        position = recording.position.copy()
        position[rng.random(position.size) < 0.01] = 0.0
        spoiled.append(replace(recording, position=position))
    noise = estimate_noise(spoiled)
    assert noise.position.sigma == pytest.approx(SIGMA, rel=0.15)
    assert noise.position.heavy_tail_p < 1e-6
    assert noise.position.tail_ratio > 3
    assert estimate_noise(recordings).position.heavy_tail_p > 1e-3


def test_drift_between_repeats_is_not_noise() -> None:
    first, second = runs([SIGMA, SIGMA])
    drifted = replace(second, position=second.position + 0.01 + 5e-5 * second.time_s)
    assert estimate_noise([first, drifted]).position.sigma == pytest.approx(SIGMA, rel=0.1)


def test_quantized_and_missing_values() -> None:
    first, second = runs([SIGMA, SIGMA])
    step = 2e-3
    coarse = [replace(r, position=np.round(r.position / step) * step) for r in (first, second)]
    assert estimate_noise(coarse).position.sigma == pytest.approx(np.hypot(SIGMA, step / np.sqrt(12)), rel=0.2)
    holes = [replace(r, position=np.where(np.arange(r.n) % 37 == 0, np.nan, r.position)) for r in (first, second)]
    noise = estimate_noise(holes)
    assert noise.position.sigma == pytest.approx(SIGMA, rel=0.1)
    assert np.isnan(noise.whiten(holes[0].position)).sum() == np.isnan(holes[0].position).sum()


def test_scale_and_memory_of_known_samples() -> None:
    rng = np.random.default_rng(0)
    sample = rng.standard_normal(20000)
    assert robust_sigma(sample) == pytest.approx(1.0, rel=0.02)
    sample[:600] = 40.0
    assert robust_sigma(sample) == pytest.approx(1.0, rel=0.03)
    assert robust_sigma(np.full(5, 2.0)) == 0.0
    rho = autocorrelation([coloured(20000, 0.6, 1.0, 1)])
    assert correlation_samples(rho) == pytest.approx(4.0, rel=0.15)
    ar, variance = autoregression(rho, 20000)
    assert ar[0] == pytest.approx(0.6, abs=0.03)
    assert variance == pytest.approx(1 - 0.36, rel=0.05)
    assert poisson_tail(0, 0.1) == 1.0
    assert poisson_tail(1, 0.1) == pytest.approx(1 - np.exp(-0.1))
    assert poisson_tail(50, 1.0) < 1e-30
