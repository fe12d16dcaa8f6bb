"""Trust: which unit's next answer can be believed, and how trust is won back.

The invariant is "never silently wrong". Modbus RTU answers carry no number, so an answer that comes after its request
was given up looks like the answer to the next one. Hence a unit that failed to answer is not believed until it has
answered a question that nothing else is answered like (`hal.device.Resync`); a slave answers in order, so by then
everything older has come out. The same holds for a port just opened, and after bytes that nobody asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from hal.device import Device
from hal.errors import WireFault
from hal.pdu import Request, echo, read_registers
from hal.reply import Line, Reply, accept, with_retries
from hal.stats import BusStats

_MOST_OWED = 4  # an answer that is overdue by more probes than this will not come any more


@dataclass
class Trust:
    """What is known of one unit on the line."""

    device: Device
    clean: bool = False  # nothing it could still say is owed to an older request
    probes: int = 0  # asked since it was last clean
    owed: int = 0  # answers to still older probes that never came, and may yet
    lengths: set[int] = field(default_factory=set)  # register counts asked for in earnest

    def __post_init__(self) -> None:
        self.turnaround_s = self.device.turnaround_ms / 1000.0
        self.counts_lengths = self.device.resync.method == "read"


class RtuBus:
    """Requests to the units of one RTU line. `margin_s`: how much longer than the wire and the device need we wait."""

    def __init__(self, line: Line, devices: tuple[Device, ...], *, margin_s: float = 0.25) -> None:
        self._line = line
        self._units = {device.id: Trust(device) for device in devices}
        self._margin_s = margin_s
        self._char_s = line.serial.char_s
        self._nonce = 0

    @property
    def stats(self) -> BusStats:
        return self._line.stats

    def open(self) -> None:
        for trust in self._units.values():
            trust.clean = False
        self._line.local_echo = None
        self._line.open()

    def close(self) -> None:
        self._line.close()

    def transact(self, request: Request, retries: int = 0) -> Reply:
        return with_retries(lambda: self._once(request), retries, self.stats) if retries else self._once(request)

    def timeout_s(self, request: Request) -> float:
        """How long to wait for an answer [s]: both frames on the wire, the device's turnaround, and the margin."""
        return self._patience_s(self._trust(request.unit), request)

    def _patience_s(self, trust: Trust, request: Request) -> float:
        chars = len(request.pdu) + (request.size or 250) + 6
        return chars * self._char_s + trust.turnaround_s + self._margin_s

    def _trust(self, unit: int) -> Trust:
        trust = self._units.get(unit)
        if trust is None:
            trust = self._units[unit] = Trust(Device(id=unit))
        return trust

    def _once(self, request: Request) -> Reply:
        trust = self._trust(request.unit)
        if trust.counts_lengths and request.function in (3, 4, 23):
            trust.lengths.add(request.size // 2 - 1)
        if stray := self._line.strays():
            self.stats.noise_bytes += stray
            trust.clean = False
        if not trust.clean:
            self._resynchronise(trust)
        return accept(request, self._ask(trust, request), self.stats, self._line.name)

    def _ask(self, trust: Trust, request: Request) -> Reply:
        trust.clean = False  # until the answer is here, whatever happens in between
        reply = self._line.ask(request, self._patience_s(trust, request))
        trust.clean = reply.rest == 0
        return reply

    def _resynchronise(self, trust: Trust) -> None:
        """Waits for quiet, then asks what only its own answer fits. Raises: `WireFault`, and the next call goes on."""
        self.stats.late_bytes += self._line.settle(self._margin_s)
        if self._line.local_echo is None:
            # A line that repeats what we say would answer every echo test by itself.
            self._line.ask(*self._with_timeout(self._harmless_read(trust, 1)))
        trust.probes += 1
        self.stats.probes += 1
        reply = self._line.ask(*self._with_timeout(self._probe(trust)))
        if reply.refused:
            self._judge_refusal(trust)
        if reply.rest:
            raise WireFault(f"unit {trust.device.id} on {self._line.name}: bytes after an answer; noise on the line?")
        trust.clean, trust.probes = True, 0
        self.stats.resyncs += 1

    def _judge_refusal(self, trust: Trust) -> None:
        """A refused echo test is an answer too, but one refusal looks like another: those still owed come first."""
        unit = f"unit {trust.device.id} on {self._line.name}"
        if trust.device.resync.method == "read":
            raise WireFault(f"{unit} refused the resync read; give its profile a readable resync.address and count")
        if trust.owed:
            trust.owed -= 1
            raise WireFault(f"{unit} still owes answers after a disturbance")
        trust.owed = min(trust.probes - 1, _MOST_OWED)

    def _with_timeout(self, request: Request) -> tuple[Request, float]:
        return request, self.timeout_s(request)

    def _harmless_read(self, trust: Trust, count: int) -> Request:
        device = trust.device
        address = max(0, device.resync.address - device.address_base)
        return read_registers(device.id, device.read_fc, address, count)

    def _probe(self, trust: Trust) -> Request:
        resync = trust.device.resync
        if resync.method == "echo":
            self._nonce = (self._nonce % 0xFFFF) + 1
            return echo(trust.device.id, self._nonce)
        # Every probe since the unit was last clean has a length of its own, and none that is read in earnest.
        free = [n for n in range(resync.count, 0, -1) if n not in trust.lengths]
        if not free:
            raise WireFault(f"unit {trust.device.id}: resync.count {resync.count} leaves no unused length; raise it")
        return self._harmless_read(trust, free[(trust.probes - 1) % len(free)])
