"""Records cut at holes in which nobody knows the command."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from logs.recording import DataNote, Recording
from twin.record.pieces import MOST_PIECES, cut_at_holes


def steps(holes: list[tuple[float, float]], seconds: float = 300.0) -> Recording:
    """A command that changes every 10 s, at 10 Hz, without the rows inside the holes."""
    time_s = np.arange(0.0, seconds, 0.1)
    kept = np.all([(time_s < a) | (time_s > b) for a, b in holes], axis=0) if holes else np.ones(time_s.size, bool)
    command = np.floor(time_s / 10.0) % 7.0
    notes = (DataNote("as loaded", "kept"),)
    return Recording("r", time_s[kept], command[kept], np.zeros(int(kept.sum())), notes=notes)


def test_no_hole_no_cut() -> None:
    recording = steps([])
    pieces, notes = cut_at_holes([recording])
    assert pieces[0] is recording
    assert notes == []


def test_a_hole_with_another_command_behind_it_cuts() -> None:
    pieces, notes = cut_at_holes([steps([(105.0, 112.0)])])
    assert [p.name for p in pieces] == ["r[1]", "r[2]"]
    assert [len(p.notes) for p in pieces] == [1, 0]
    assert "cut into 2 pieces" in notes[0].handled


def test_a_short_hole_under_one_command_is_bridged() -> None:
    assert len(cut_at_holes([steps([(102.0, 108.0)])])[0]) == 1
    held = replace(steps([(102.0, 120.0)]), command=np.full(steps([(102.0, 120.0)]).n, 7.0))
    assert len(cut_at_holes([held])[0]) == 2  # too long to believe that nothing happened


def test_rows_between_two_holes_are_left_out_and_said() -> None:
    pieces, notes = cut_at_holes([steps([(100.0, 115.0), (125.0, 145.0)])])
    assert len(pieces) == 2
    assert notes[0].rows > 0
    assert f"{notes[0].rows} rows between holes" in notes[0].handled


def test_a_record_of_crumbs_is_kept_whole() -> None:
    crumbs = steps([(k + 8.0, k + 18.0) for k in np.arange(0.0, 300.0, 20.0)])
    assert cut_at_holes([crumbs])[0] == [crumbs]


def test_not_more_pieces_than_can_be_handled() -> None:
    many = steps([(k + 25.0, k + 31.0) for k in np.arange(0.0, 3000.0, 50.0)], 3000.0)
    assert MOST_PIECES - 5 <= len(cut_at_holes([many])[0]) <= MOST_PIECES


def test_a_reading_from_before_the_hole_begins_no_piece() -> None:
    whole = steps([(105.0, 112.0)])
    moving = np.sin(0.05 * whole.time_s)
    after = int(np.flatnonzero(np.diff(whole.time_s) > 1.0)[0]) + 1
    moving[after : after + 4] = moving[after - 1]
    pieces, (note,) = cut_at_holes([replace(whole, position=moving)])
    assert pieces[1].time_s[0] == whole.time_s[after + 4]
    assert note.rows == 4 and "4 rows after holes" in note.handled
    moving[after : after + 100] = moving[after - 1]  # a stem that rests
    assert cut_at_holes([replace(whole, position=moving)])[0][1].time_s[0] == whole.time_s[after]
