"""What to say of readings that stand out as false ones do, and are a heavy tail of the noise."""

from __future__ import annotations

from logs.recording import DataNote
from twin.events.tails import together
from twin.record.sensing import Sensing

#: Fewer than so many are no drop-outs either, and nothing to speak of.
_SEVERAL = 3


def heavy_tail(sensing: Sensing) -> list[DataNote]:
    """The note, where there are such readings and they are no drop-outs; each is kept from the fits all the same."""
    tail, rows = together([e.tail for e in sensing.events]), sum(int(e.false_position.sum()) for e in sensing.events)
    if rows < _SEVERAL or "sensor_dropouts" in sensing.accepted or not tail.heavy:
        return []
    what = "position readings far from both neighbours, as many and as far as a noise with a heavy tail makes them"
    handled = "taken for noise, not for drop-outs, and kept from the fits"
    return [DataNote(what=what, handled=handled, rows=rows, first_row=None)]
