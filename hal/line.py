"""An RTU line: silence before each frame, one question at a time, and everything that is not its answer set aside."""

from __future__ import annotations

import math

from hal.clock import Clock, RealClock
from hal.errors import WireFault
from hal.framing import describe, find_reply, seal
from hal.pdu import Request
from hal.profile import Serial
from hal.promptly import EARLY_S, wait_until
from hal.reply import Reply
from hal.stats import BusStats
from hal.transport import Transport
from hal.vigil import Vigil

_SETTLE_CHARS = 40  # a pause inside a late answer must not look like its end; USB adapters pause for milliseconds
_SETTLE_S = 0.002
_NEAR_S = 0.0015  # when the end of a frame is so near, it is not worth being woken up for the bytes before it


class RtuLine:
    """Asks and listens; whether an answer can be trusted is decided by the bus above.

    `clock` stamps, `wire` waits: with virtual time the wire is still real. `name` is for messages.
    """

    def __init__(
        self, transport: Transport, serial: Serial, clock: Clock, *, wire: Clock | None = None, name: str = "the line"
    ) -> None:
        self.stats = BusStats()
        self.local_echo: bool | None = None  # whether we hear ourselves; None: not known yet
        self.name = name
        self.serial = serial
        self._transport = transport
        self._clock = clock
        self._wire = wire or RealClock()
        self._silence_s = serial.silence_s if serial.pacing == "spec" else 0.0
        self._char_s = serial.char_s if serial.pacing == "spec" else 0.0
        self._vigil = Vigil()
        self._quiet_since_s = 0.0  # wire time of the last byte in either direction

    def open(self) -> None:
        self._transport.open()
        self._quiet_since_s = self._wire.now_s()

    def close(self) -> None:
        self._transport.close()

    def ask(self, request: Request, timeout_s: float) -> Reply:
        """Sends the request and waits for an answer of exactly its shape. Raises: `WireFault`."""
        frame = seal(request.unit, request.pdu)
        sent_s = self._send(frame)
        deadline_s = self._wire.now_s() + timeout_s
        due_s = math.inf  # when the last bit of the answer can be here
        data, left_s = b"", timeout_s
        while left_s > 0.0:
            data += self._read(left_s) if due_s == math.inf else self._read_near(due_s, left_s)
            start = self._start(data, frame, request)
            found = find_reply(data[start:] if start else data, request) if start >= 0 else None
            if found is not None:
                return self._answer(data, start, found, sent_s)
            now_s = self._wire.now_s()
            left_s = deadline_s - now_s
            due_s = min(due_s, now_s + self._missing_s(data, start, request))
        self.stats.timeouts += 1
        self.stats.damaged += bool(data)
        raise WireFault(self._sentence(request, data, timeout_s), sent=frame, received=data, waited_s=timeout_s)

    def _answer(self, data: bytes, start: int, found: tuple[int, int], sent_s: float) -> Reply:
        received_s = self._clock.now_s()
        first, last = start + found[0], start + found[1]
        rest = len(data) - last
        self.stats.noise_bytes += found[0] + rest
        return Reply(data[first + 1 : last - 2], sent_s, received_s, rest)

    def _start(self, data: bytes, frame: bytes, request: Request) -> int:
        """Where an answer may begin: behind our own bytes on a line that echoes them; -1: these are not whole yet."""
        if self.local_echo is not True and not request.echoes and data:
            # An answer to such a request never repeats it, so whoever does is the line itself.
            self.local_echo = data.startswith(frame) or (self.local_echo if len(data) < len(frame) else False)
        if not self.local_echo:
            return 0
        at = data.find(frame)
        return at + len(frame) if at >= 0 else -1

    def _missing_s(self, data: bytes, start: int, request: Request) -> float:
        """How long the rest of the answer takes on the wire [s], as far as its length is known."""
        if not data or start < 0 or not request.size:
            return math.inf
        refused = len(data) > start + 1 and data[start + 1] & 0x80
        return max(0, (5 if refused else request.size + 3) - len(data) + start) * self.serial.char_s

    def _read_near(self, due_s: float, left_s: float) -> bytes:
        """The next bytes. Near the moment when an answer is due they are watched for, as long as that pays."""
        if due_s - self._wire.now_s() < _NEAR_S:
            self._wire.sleep_until(due_s - EARLY_S)
            if data := self._vigil.keep(self._look):
                return data
        return self._read(left_s)

    def _look(self) -> bytes:
        return self._read(0.0)

    def _read(self, timeout_s: float) -> bytes:
        data = self._transport.read(timeout_s)
        if data:
            self._quiet_since_s = self._wire.now_s()
        return data

    def _send(self, frame: bytes) -> float:
        """Keeps the silence, sends, and returns the bench time of sending."""
        if self._silence_s:
            wait_until(self._wire, self._quiet_since_s + self._silence_s)
        sent_s = self._clock.now_s()
        self._transport.write(frame)
        if self._silence_s:  # write() returns while the bits are still on their way out
            self._quiet_since_s = self._wire.now_s() + len(frame) * self._char_s
        return sent_s

    def _sentence(self, request: Request, data: bytes, timeout_s: float) -> str:
        s = self.serial
        frame = seal(request.unit, request.pdu)
        if data == frame:
            said, advice = "no answer but the line's own echo", "check power, wiring and unit id"
        elif data:
            said, advice = describe(data, request), "check baud, parity, unit id and the cable"
        else:
            said, advice = "no answer", "check power, wiring, unit id and baud (`lostmotion probe` looks for them)"
        where = f"unit {request.unit} on {self.name} ({s.baud} 8{s.parity}{s.stop_bits})"
        return f"{where}: {said} within {timeout_s:.3g} s; {advice}"

    def strays(self) -> int:
        """Takes what has arrived unasked, and tells how many bytes it was."""
        return len(self._read(0.0))

    def settle(self, limit_s: float) -> int:
        """Listens until the line has been quiet for a moment; returns the number of bytes that came meanwhile.

        Raises: `WireFault` when somebody never stops.
        """
        pause_s = max(_SETTLE_S, _SETTLE_CHARS * self._char_s)
        give_up_s = self._wire.now_s() + limit_s + pause_s
        count = 0
        while data := self._read(pause_s):
            count += len(data)
            if self._wire.now_s() > give_up_s:
                raise WireFault(
                    f"{self.name} is never quiet ({count} bytes of chatter): is another master on the line?"
                )
        return count
