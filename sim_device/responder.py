"""The slave's end of an RTU line: waits for requests, answers them in order, and lets the line be as bad as told."""

from __future__ import annotations

import math
import os
import select
import threading
from collections.abc import Callable

from hal.clock import Clock
from hal.promptly import short_turns
from hal.vigil import Vigil
from sim_device.faulty_line import FaultyLine
from sim_device.framer import RequestFramer
from sim_device.line import Line
from sim_device.pacing import Pace, emit, sharpen_timer

_WAKE_EARLY_S = 150e-6  # what a thread needs to wake up, at most, on a machine with nothing else to do
_LOOKS_PER_SILENCE = 1.3e6  # a look takes about a microsecond: somewhat longer than the silence that a master keeps


class Stop:
    """Wakes every thread that waits, whether it waits for bytes or for time."""

    def __init__(self) -> None:
        self.read_fd, self._write_fd = os.pipe()
        self._event = threading.Event()

    def is_set(self) -> bool:
        return self._event.is_set()

    def set(self) -> None:
        if not self._event.is_set():
            self._event.set()
            os.write(self._write_fd, b"x")

    def wait(self, seconds: float) -> None:
        self._event.wait(seconds)

    def close(self) -> None:
        os.close(self.read_fd)
        os.close(self._write_fd)


class Responder:
    """Serves one stream of RTU bytes. `wire_clock` is real time: the line's, not the valve's."""

    def __init__(
        self,
        line: Line,
        wire_clock: Clock,
        stop: Stop,
        *,
        faults: FaultyLine | None = None,
        pace: Pace | None = None,
        idle_reset_s: float = 0.010,
        on_quiet: Callable[[], None] | None = None,
        quiet_s: float = 0.5,
    ) -> None:
        self._line = line
        self._clock = wire_clock
        self._stop = stop
        self._faults = faults
        self._pace = pace
        self._framer = RequestFramer(idle_reset_s)
        self._on_quiet = on_quiet
        self._quiet_s = quiet_s
        self._vigil = Vigil(int(_LOOKS_PER_SILENCE * pace.silence_s) if pace is not None else 0)

    def serve(self, fd: int, *, until_eof: bool) -> None:
        """Answers until the stop is set, or the far end closes (`until_eof`: a socket; a pty waits for the next)."""
        if self._pace is None:
            self._serve(fd, until_eof)
            return
        sharpen_timer()
        with short_turns():  # a wire waits for nobody
            self._serve(fd, until_eof)

    def _serve(self, fd: int, until_eof: bool) -> None:
        poll = select.poll()
        poll.register(fd, select.POLLIN)
        poll.register(self._stop.read_fd, select.POLLIN)
        while not self._stop.is_set():
            ready = self._awake(poll) or poll.poll(self._patience_ms())
            if self._stop.is_set():
                return
            now_s = self._clock.now_s()
            if not ready:
                self._quiet(fd, now_s)
                continue
            try:
                data = os.read(fd, 4096)
            except OSError:
                return
            if not data:
                if until_eof:
                    return
                continue
            damaged = self._framer.damaged
            frames = self._framer.feed(data, now_s)
            if self._framer.damaged != damaged:
                self._line.saw_damage(self._framer.damaged - damaged)
            for frame in frames:
                self._answer(fd, frame, now_s)

    def _awake(self, poll: select.poll) -> list[tuple[int, int]] | None:
        """What is ready at once or soon. A wire's time starts when the master speaks, not when a slave woke up."""
        if self._pace is None or self._framer.pending:
            return None
        return self._vigil.keep(lambda: poll.poll(0))

    def _patience_ms(self) -> float | None:
        if self._framer.pending:
            return math.ceil(1e3 * self._framer.idle_reset_s) + 1.0
        return 1e3 * self._quiet_s if self._on_quiet is not None else None

    def _quiet(self, fd: int, now_s: float) -> None:
        if self._framer.pending:
            damaged = self._framer.damaged
            for frame in self._framer.idle(now_s):
                self._answer(fd, frame, now_s)
            self._line.saw_damage(self._framer.damaged - damaged)
        elif self._on_quiet is not None:
            self._on_quiet()

    def _answer(self, fd: int, frame: bytes, arrived_s: float) -> None:
        reply = self._line.rtu(frame)
        if reply is None:
            return
        start_s = arrived_s if self._pace is None else self._pace.reply_starts_s(arrived_s, len(frame))
        if self._faults is not None:
            emission = self._faults.emit(frame, reply)
            reply = emission.data
            if emission.delay_s:
                start_s += emission.delay_s
                self._stop.wait(max(0.0, start_s - self._clock.now_s()))
        if not reply or self._stop.is_set():
            return
        if self._pace is None:
            _write(fd, reply)
        else:
            emit(reply, start_s, self._pace, self._clock, lambda piece: _write(fd, piece), _WAKE_EARLY_S)


def _write(fd: int, data: bytes) -> None:
    """A far end that is gone, or never reads, loses the reply, as on a real line."""
    try:
        os.write(fd, data)
    except OSError:
        return
