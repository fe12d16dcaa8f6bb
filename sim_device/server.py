"""The virtual device: a valve that speaks Modbus RTU and is not there."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from hal.clock import Clock, RealClock, SteppedClock
from hal.errors import BadInput
from hal.profile import Profile
from sim_device.device import Options, build_units
from sim_device.faults import WireFaults
from sim_device.faulty_line import FaultyLine
from sim_device.faulty_stream import FaultyStream
from sim_device.line import Line
from sim_device.listener import RTU_SCHEME, Listener, parse_address
from sim_device.pacing import Pace
from sim_device.pseudoterminal import PseudoTerminal
from sim_device.responder import Responder, Stop
from sim_device.rig import Rig
from sim_device.valve import ValvePhysics


class VirtualDevice:
    """All units of a profile on one line, answered by a thread of this process while the context is open.

    Without `tcp`, or with `link`, the line is a pseudo-terminal whose name is `port` (`link` gives it a stable name).
    `tcp` is `HOST:PORT` or `tcp://HOST:PORT` (Modbus TCP), or `rtu+tcp://HOST:PORT`; port 0 takes a free one.
    `clock` is the valve's time: with a `SteppedClock` shared with the loop, runs are deterministic; the line itself
    (faults, pacing) lives in real time. `pace_baud` makes every byte take its time on the wire.

    Raises: `BadInput`, `PortFault` on entering.
    """

    def __init__(
        self,
        profile: Profile,
        physics: ValvePhysics,
        clock: Clock,
        *,
        link: Path | None = None,
        tcp: str | None = None,
        faults: WireFaults | None = None,
        pace_baud: int | None = None,
        idle_reset_s: float = 0.010,
        options: Options | None = None,
        allow_remote: bool = False,
    ) -> None:
        self._link = link
        self._tcp = tcp
        self._allow_remote = allow_remote
        self._idle_reset_s = idle_reset_s
        self._clock = clock
        self._pace = _pace(profile, pace_baud)
        self.line_faults, self.stream_faults = _faulty(faults, tcp, link)
        options = options or Options()
        self.rig = Rig(physics, clock, safe_command=profile.safe_command, refresh_s=options.refresh_s)
        units = build_units(profile, self.rig, clock, options)
        self.units = units
        self._line = Line(units)
        self._stop: Stop | None = None
        self._terminal: PseudoTerminal | None = None
        self._listener: Listener | None = None
        self._thread: threading.Thread | None = None

    @property
    def port(self) -> str:
        """What a master opens: the pseudo-terminal's path (or link), else the URL of the listener."""
        if self._terminal is not None:
            return self._terminal.port
        return self.tcp_url

    @property
    def tcp_url(self) -> str:
        """`tcp://HOST:PORT` or `rtu+tcp://HOST:PORT` with the port that was taken; empty without `tcp`."""
        return self._listener.url if self._listener is not None else ""

    def __enter__(self) -> Self:
        self._stop = Stop()
        try:
            if self._tcp is not None:
                self._listener = Listener(
                    self._tcp,
                    self._serve_socket,
                    self._line,
                    allow_remote=self._allow_remote,
                    faults=self.stream_faults,
                )
            if self._tcp is None or self._link is not None:
                self._terminal = PseudoTerminal(self._link)
                self._thread = threading.Thread(target=self._serve_terminal, name="virtual-device", daemon=True)
                self._thread.start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Hangs up, removes the link, ends the threads. Safe to call twice."""
        if self._stop is None:
            return
        self._stop.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        if self._listener is not None:
            self._listener.close()
        if self._terminal is not None:
            self._terminal.close()
        self._stop.close()
        self._stop = self._terminal = self._listener = self._thread = None

    def _serve_terminal(self) -> None:
        assert self._terminal is not None
        # In real time a silent line must not stop the valve; stepped time moves only when the loop moves it.
        live = None if isinstance(self._clock, SteppedClock) else lambda: self._line.quiet(self.rig.advance)
        self._responder(live).serve(self._terminal.fd, until_eof=False)

    def _serve_socket(self, fd: int) -> None:
        self._responder(None).serve(fd, until_eof=True)

    def _responder(self, on_quiet: Callable[[], None] | None) -> Responder:
        assert self._stop is not None
        return Responder(
            self._line,
            RealClock(),
            self._stop,
            faults=self.line_faults,
            pace=self._pace,
            idle_reset_s=self._idle_reset_s,
            on_quiet=on_quiet,
        )


def _faulty(
    faults: WireFaults | None, tcp: str | None, link: Path | None
) -> tuple[FaultyLine | None, FaultyStream | None]:
    """The faults of the RTU line and of the Modbus TCP connections, where there are such.

    Raises: `BadInput` for a fault that one of them cannot have.
    """
    if faults is None or not faults.any:
        return None, None
    stream = tcp is not None and parse_address(tcp)[0] != RTU_SCHEME
    line = not stream or link is not None
    return FaultyLine(faults) if line else None, FaultyStream(faults) if stream else None


def _pace(profile: Profile, baud: int | None) -> Pace | None:
    if baud is None:
        return None
    if baud < 300:
        raise BadInput(f"a line of {baud} baud cannot be paced; the least is 300")
    serial = profile.serial
    return Pace(baud, round(serial.char_s * serial.baud))
