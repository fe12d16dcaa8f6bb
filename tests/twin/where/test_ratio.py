"""Intervals of ratios: they hold the truth on short records of much memory, and end where Fieller says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import t

from logs.recording import FloatArray
from twin.where.ratio import block_rows, memory_rows, ratio_interval, total_covariance


def dwelling(dice: np.random.Generator, rows: int, dwell: float) -> FloatArray:
    """Levels of variance 1, each for a geometric time of `dwell` rows in the mean."""
    changes = np.cumsum(dice.random(rows) < 1.0 / dwell)
    return np.asarray(dice.standard_normal(int(changes[-1]) + 1)[changes], dtype=np.float64)


def test_intervals_hold_the_truth_on_short_records_of_much_memory() -> None:
    hits = 0
    for seed in range(300):
        dice = np.random.default_rng(seed)
        first, second = dwelling(dice, 800, 10.0), dwelling(dice, 800, 10.0)  # 80 levels
        low, high = ratio_interval(4.0 * first * (first + second), (2.0 * first + second) ** 2)
        hits += low <= 4.0 / 5.0 <= high
    assert 0.93 <= hits / 300 <= 0.985  # with three memories per block and no Student's factor 0.86


def test_the_ends_are_what_the_two_sums_do_not_contradict() -> None:
    dice = np.random.default_rng(1)
    numerator, denominator = 1.0 + dice.standard_normal(640), 2.0 + dice.standard_normal(640)
    block = block_rows(1.0, numerator - numerator.sum() / denominator.sum() * denominator)
    assert block == 20
    quantile = t.ppf(0.975, 640 / block - 1)
    for end in ratio_interval(numerator, denominator):
        off = (numerator - end * denominator).reshape(-1, block).sum(axis=1)
        expected = quantile * off.std(ddof=1) / np.sqrt(off.size)  # of blocks that do not overlap
        assert abs(off.mean()) == pytest.approx(expected, rel=0.2)


def test_a_skewed_ratio_reaches_further_where_the_denominator_is_small() -> None:
    dice = np.random.default_rng(2)
    numerator, denominator = 1.0 + 0.1 * dice.standard_normal(400), 1.0 + 5.0 * dice.standard_normal(400)
    low, high = ratio_interval(numerator, denominator)
    ratio = numerator.sum() / denominator.sum()
    assert high - ratio > 1.5 * (ratio - low) > 0.0


def test_what_is_all_or_nothing_has_no_doubt() -> None:
    whole = 1.0 + np.random.default_rng(3).standard_normal(500)
    assert ratio_interval(whole, whole) == pytest.approx((1.0, 1.0), abs=1e-9)
    assert ratio_interval(0.0 * whole, whole) == (0.0, 0.0)


def test_a_denominator_that_may_be_nothing_leaves_a_wide_interval_and_one_row_none() -> None:
    dice = np.random.default_rng(4)
    numerator, denominator = 1.0 + dice.standard_normal(300), 0.01 + dice.standard_normal(300)
    denominator += 0.01 - denominator.mean()
    low, high = ratio_interval(numerator, denominator)
    assert np.isfinite([low, high]).all()
    assert high - low > 2.0 * abs(numerator.sum() / denominator.sum())
    assert np.isnan(ratio_interval(numerator[:1], denominator[:1])).all()


def test_a_doubt_of_the_denominator_is_in_the_interval() -> None:
    dice = np.random.default_rng(5)
    numerator, denominator = 3.0 + 0.01 * dice.standard_normal(900), 2.0 + 0.01 * dice.standard_normal(900)
    low, high = ratio_interval(numerator, denominator, doubt=0.05 * denominator.sum())
    assert (high - low) / 1.5 == pytest.approx(2.0 * t.ppf(0.975, 44) * 0.05, rel=0.03)


def test_a_slow_part_below_noise_is_seen_and_noise_alone_has_no_memory() -> None:
    dice = np.random.default_rng(6)
    slow = dwelling(dice, 20_000, 100.0)  # its integrated correlation time is 199 rows
    assert 100.0 < memory_rows(slow) < 400.0
    assert memory_rows(0.25 * slow + dice.standard_normal(20_000)) > 50.0  # its neighbours correlate by 0.06
    assert np.median([memory_rows(dice.standard_normal(20_000)) for _ in range(20)]) < 3.0
    assert memory_rows(np.zeros(100)) == 1.0


def test_blocks_are_long_against_all_memories_and_never_few() -> None:
    dice = np.random.default_rng(7)
    assert block_rows(1.0, dice.standard_normal(3000)) == pytest.approx(20, abs=20)
    assert block_rows(30.0, dice.standard_normal(3000)) >= 150
    assert block_rows(1.0, dwelling(dice, 3000, 500.0)) == 3000 // 8
    assert block_rows(1.0, dice.standard_normal(30_000)) >= 100
    assert block_rows(1.0, np.ones(5)) == 1
    assert block_rows(1.0, dwelling(dice, 60_000, 50.0)) > 5 * 99  # rows that it remembers


def test_eight_blocks_tell_the_variance_of_a_total_without_bias() -> None:
    found = [total_covariance(np.random.default_rng(k).standard_normal((160, 1)), 20)[0, 0] for k in range(600)]
    assert np.mean(found) == pytest.approx(160.0, rel=0.06)
