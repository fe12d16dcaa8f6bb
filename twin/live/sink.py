"""A sink of the loop that adds the live twin's columns to every row before it goes to the record and the view."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from control.loop import Sink
from twin.live.monitor import Monitor

#: The twin's columns and their units.
COLUMNS: Mapping[str, str] = {"twin_position_in": "in", "twin_residual_in": "in", "twin_cusum": ""}


class TwinSink:
    """Passes everything on to `sinks`; `say` gets the sentence when the alarm begins or ends."""

    def __init__(self, monitor: Monitor, sinks: Sequence[Sink], say: Callable[[str], None]) -> None:
        self._monitor = monitor
        self._sinks = tuple(sinks)
        self._say = say

    def append(self, row: Mapping[str, float]) -> None:
        seen = self._monitor.see(row)
        more = {"twin_position_in": seen.position, "twin_residual_in": seen.residual, "twin_cusum": seen.statistic}
        for sink in self._sinks:
            sink.append({**row, **more})
        if seen.say:
            self.event(row["time_s"], "warning" if self._monitor.alarmed else "info", seen.say)
            self._say(seen.say)

    def event(self, time_s: float | None, level: str, text: str) -> None:
        for sink in self._sinks:
            sink.event(time_s, level, text)

    def note(self, time_s: float | None, text: str) -> None:
        for sink in self._sinks:
            sink.note(time_s, text)

    def state(self, time_s: float | None, text: str) -> None:
        for sink in self._sinks:
            sink.state(time_s, text)
