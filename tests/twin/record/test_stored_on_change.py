"""Holes of a record that was stored on change say that nothing changed; those of one that lost its rows say nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.record.pieces import cut_at_holes
from twin.record.stored_on_change import held_through_holes
from twin.replay.simulate import simulate_recording


def whole() -> Recording:
    """Half an hour at 1 Hz of a loop that rests at a set point for a while and goes to the next one."""
    time_s = np.arange(1800.0)
    levels = np.repeat([9.5, 10.2, 8.9, 7.1, 6.0, 9.8, 10.6, 7.4, 9.9], 200)
    command = np.round(np.convolve(levels, np.ones(25) / 25.0, "same"), 2)
    blank = Recording("loop", time_s, command, np.full(1800, 0.14), pressure=np.full(1800, 9.5))
    pressure, position = simulate_recording(DesignModel(), blank)
    return replace(blank, position=np.round(position, 3), pressure=np.round(pressure, 2), target=levels)


def kept(record: Recording, rows: np.ndarray) -> Recording:
    def at(values: FloatArray) -> FloatArray:
        return values[rows]

    assert record.pressure is not None and record.target is not None
    signals = {name: at(getattr(record, name)) for name in ("time_s", "command", "position", "pressure", "target")}
    return replace(record, **signals)


def stored(record: Recording, last_too: bool) -> Recording:
    """Only rows in which something is new; `last_too`: and the last one before each of them."""
    signals = np.stack([record.command, record.position])
    new = np.append(True, (np.diff(signals, axis=1) != 0.0).any(axis=0))
    if last_too:
        new[:-1] |= new[1:].copy()
    return kept(record, np.flatnonzero(new))


@pytest.mark.parametrize("last_too", [True, False])
def test_the_command_holds_until_a_row_is_stored(last_too: bool) -> None:
    record = whole()
    short = stored(record, last_too)
    assert short.n < 0.6 * record.n
    [filled], [note] = cut_at_holes([short])
    assert "holes in which nothing had changed" in note.what
    assert np.isnan(filled.position).sum() == note.rows == filled.n - short.n
    # what it says of any moment is what was commanded, to the moment between two rows
    at = np.searchsorted(filled.time_s, record.time_s)
    assert np.mean(filled.command[at] == record.command) > 0.99
    _, position = simulate_recording(DesignModel(), filled)
    np.testing.assert_allclose(position[np.isfinite(filled.position)], short.position, atol=2e-3)


def test_a_record_that_lost_its_rows_is_cut_as_before() -> None:
    record = whole()
    lost = np.zeros(record.n, dtype=bool)
    for start in range(100, 1700, 160):
        lost[start : start + 60] = True  # over some of the moves
    holes = kept(record, np.flatnonzero(~lost))
    assert held_through_holes(holes) == (holes, [])
    assert len(cut_at_holes([holes])[0]) > 1


def test_a_few_holes_prove_nothing() -> None:
    record = whole()
    calm = kept(record, np.flatnonzero((record.time_s < 120.0) | (record.time_s > 180.0)))
    assert held_through_holes(calm) == (calm, [])


def test_a_record_in_which_nothing_moves_is_left_alone() -> None:
    record = whole()
    still = replace(record, command=np.full(record.n, 9.0), position=np.full(record.n, 0.2))
    sparse = kept(still, np.flatnonzero(np.arange(record.n) % 100 < 50))
    assert held_through_holes(sparse)[1] == []
