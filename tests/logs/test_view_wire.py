from __future__ import annotations

import math
import select

import pytest

from logs.run import Event
from logs.view_wire import Unpacker, pack_event, pack_row


def test_rows_and_events_come_out_as_they_went_in_however_they_are_cut() -> None:
    sent = [
        (1.0, -2.5, 1e300),
        Event(0.25, "error", "no reply – unit 3"),
        (0.0,),
        Event(None, "info", "x", "note", "u"),
    ]
    data = b"".join(pack_row(item) if isinstance(item, tuple) else pack_event(item) for item in sent)
    for size in (1, 7, len(data)):
        unpacker = Unpacker()
        pieces = [data[at : at + size] for at in range(0, len(data), size)]
        assert [item for piece in pieces for item in unpacker.feed(piece)] == sent


def test_a_missing_value_stays_missing() -> None:
    (row,) = Unpacker().feed(pack_row((1.0, float("nan"))))
    assert isinstance(row, tuple) and math.isnan(row[1])


@pytest.mark.parametrize("letter", ["x", "é", "\U0001f600", '"'])
def test_a_text_that_is_too_long_is_cut_so_that_it_is_written_whole(letter: str) -> None:
    frame = pack_event(Event(0.0, "info", letter * 9000))
    (event,) = Unpacker().feed(frame)
    assert len(frame) <= select.PIPE_BUF
    assert isinstance(event, Event) and event.text.endswith(" ...") and event.text.startswith(letter)


def test_more_columns_than_a_frame_holds_are_refused() -> None:
    with pytest.raises(ValueError, match="columns"):
        pack_row((0.0,) * 1000)
