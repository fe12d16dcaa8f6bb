"""A step of the command among missing rows happened nobody knows when: what it moves is not held against a model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from logs.recording import FloatArray, Recording
from twin.fit.trial import SETTLE_S, after_unseen_steps, make_trial


def sampled(time_s: FloatArray, with_pressure: bool = True) -> Recording:
    command = np.where(time_s < 50.0, 6.0, 10.0)
    return Recording("r", time_s, command, np.zeros(time_s.size), command.copy() if with_pressure else None)


EVEN = np.arange(1000) * 0.1


def test_rows_behind_a_step_in_a_hole_do_not_count_and_all_others_do() -> None:
    time_s = EVEN[(EVEN < 49.6) | (EVEN > 50.3)]
    vague = after_unseen_steps(sampled(time_s))
    assert np.array_equal(vague, (time_s > 50.0) & (time_s < time_s[time_s > 50.0][0] + SETTLE_S))
    known, unknown = make_trial(sampled(time_s), 0.05), make_trial(sampled(time_s, with_pressure=False), 0.05)
    assert not known.use_p[vague].any() and known.use_y[vague].all()
    assert not unknown.use_y[vague].any()


def test_a_step_between_neighbouring_rows_and_a_hole_without_a_step_cost_nothing() -> None:
    assert not after_unseen_steps(sampled(EVEN)).any()
    assert not after_unseen_steps(sampled(EVEN[(EVEN < 20.0) | (EVEN > 22.0)])).any()


def test_what_a_command_moves_by_itself_is_no_step() -> None:
    time_s = EVEN[(EVEN < 20.0) | (EVEN > 21.0)]
    whole = sampled(time_s)
    trembling = np.where(time_s > 20.5, 0.01, 0.0) * np.ptp(whole.command)
    assert not after_unseen_steps(replace(whole, command=whole.command + trembling)).any()
    assert after_unseen_steps(replace(whole, command=whole.command + 4.0 * trembling)).any()


def test_where_nearly_everything_would_go_nothing_goes() -> None:
    time_s = EVEN[np.random.default_rng(4).uniform(size=EVEN.size) < 0.5]
    restless = Recording("r", time_s, np.random.default_rng(5).uniform(4.0, 12.0, time_s.size), np.zeros(time_s.size))
    assert not after_unseen_steps(restless).any()


def test_a_clock_that_trembles_by_a_quarter_has_no_holes() -> None:
    """As many of its times between rows are long as short ones are short: all that a step moved had been left out."""
    rng = np.random.default_rng(6)
    time_s = EVEN + 0.043 * rng.uniform(-1.0, 1.0, EVEN.size)
    steps = np.repeat(rng.uniform(4.0, 12.0, 20), 50)
    restless = Recording("r", time_s, steps, np.zeros(EVEN.size))
    assert not after_unseen_steps(restless).any()
    hole = (time_s > 48.0) & (time_s < 50.0)
    missing = after_unseen_steps(Recording("r", time_s[~hole], steps[~hole], np.zeros(np.count_nonzero(~hole))))
    assert missing.any() and not missing[time_s[~hole] < 48.0].any()
