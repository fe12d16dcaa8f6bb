"""A record of hours is looked at whole where its noise hides what long steps miss, on its own commands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.fit.case import Case, make_case
from twin.fit.hidden_steps import hidden_step_s
from twin.ready import thin
from twin.ready.thin import look_at
from twin.replay.simulate import simulate_recording

_NOISE_IN = 4e-4


def recorded(command: FloatArray, period_s: float = 4.0) -> Case:
    blank = np.zeros(command.size)
    record = Recording("loop", period_s * np.arange(command.size), command, blank)
    position = simulate_recording(DesignModel(), record)[1]
    noisy = position + np.random.default_rng(3).normal(0.0, _NOISE_IN, command.size)
    return make_case([replace(record, position=noisy)], DesignModel())


def loop(rows: int) -> FloatArray:
    """Commands of a loop that goes to and fro across its deadband, little by little."""
    t = np.arange(rows)
    return 7.3 + 1.9 * np.sin(2.0 * np.pi * t / 130.0) + 0.3 * np.sin(2.0 * np.pi * t / 37.0)


def test_small_moves_leave_room_for_long_steps() -> None:
    case = recorded(loop(2000))
    step_s = hidden_step_s(case, 50_000)
    assert step_s == pytest.approx(7996.0 / 50_000)
    assert hidden_step_s(replace(case, sigma_y=1e-7), 50_000) == 0.0  # a noise that hides nothing
    assert hidden_step_s(case, 5_000) == 0.0  # longer than a fifth of the lag of the stem


def test_the_look_at_such_a_record_leaves_nothing_out(monkeypatch: pytest.MonkeyPatch) -> None:
    case = recorded(loop(2000))
    seen, notes = look_at(case)
    assert [r.n for r in seen.recordings] == [2000]
    assert seen.trials[0].grid.n_fine < 1.1 * thin.MOST_STEPS < case.trials[0].grid.n_fine
    assert "all of them in steps of 0.13 s" in notes[0].handled
    monkeypatch.setattr(thin, "hidden_step_s", lambda _case, _steps: 0.0)
    assert len(look_at(case)[0].spans) > 1


def test_windows_with_few_rows_are_not_looked_through(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two rows a second for more than two hours: windows would show a seventh of what little there is."""
    command = np.interp(np.arange(16_000) / 8.0, np.arange(2000), loop(2000))
    case = recorded(command, 0.5)
    assert [r.n for r in look_at(case)[0].recordings] == [16_000]
    monkeypatch.setattr(thin, "NOT_MANY_ROWS", 15_000)
    seen = look_at(case)[0]
    assert len(seen.spans) > 1 and sum(r.n for r in seen.recordings) < thin.FEW_ROWS
