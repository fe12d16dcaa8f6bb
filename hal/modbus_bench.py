"""A bench on Modbus: one transaction a tick where the device can, and every reading with its own time and quality."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self

from hal.assemble import Replies, assemble
from hal.bench import BenchInfo
from hal.bench_info import info_of
from hal.clock import Clock
from hal.connect import make_bus
from hal.errors import BadInput, DeviceRefused, LostMotionError, PortFault, SafetyTrip, WireFault
from hal.freshness import Freshness
from hal.identity import check_identity
from hal.pdu import Request
from hal.profile import Profile
from hal.readback import ReadbackCheck
from hal.reopen import Reopening
from hal.reply import Bus, Reply
from hal.sample import Quality, Sample
from hal.second_master import SecondMaster
from hal.tick import looking_period_s, plan_tick
from hal.watchdog import WatchdogControl, check_status

_BUSY = (5, 6)  # exceptions that ask for patience; the next tick asks again
_SAFE_TRIES = 3


class ModbusBench:
    """The bench of a profile at a port. Nothing is opened before `with`, nothing written before it is known to be ours.

    `margin_s`: how much longer than wire and device need an answer may take [s].
    `pacing` and `backend` override the profile's.
    `acknowledge`: a person has looked at the valve; a device that has taken over is given back to us.
    `reopening`: how long a port that has gone is tried to be opened again, so that the valve can be made safe.
    `read_only`: nothing is ever written, on entering and leaving neither; only `observe` works.
    A tick without a trusted answer is a sample whose readings are `MISSING`; the safety layer counts them.
    """

    def __init__(
        self,
        profile: Profile,
        port: str,
        clock: Clock,
        *,
        backend: str | None = None,
        margin_s: float = 0.25,
        pacing: str | None = None,
        acknowledge: bool = False,
        read_only: bool = False,
        bus: Bus | None = None,
        reopening: Reopening | None = None,
    ) -> None:
        if pacing is not None:
            profile = profile.paced(pacing)
        self.profile = profile
        self.bus = bus or make_bus(profile, port, clock, backend=backend or profile.serial.backend, margin_s=margin_s)
        self._port = port
        self._clock = clock
        self._acknowledge = acknowledge
        self._read_only = read_only
        self._plan = plan_tick(profile)
        self._watchdog = WatchdogControl(self.bus, self._plan.device)
        self._freshness = Freshness()
        self._lock = threading.RLock()  # the dead man's thread may send the valve to safety in the middle of a tick
        self._identity: dict[str, str] = {}
        self._readback = ReadbackCheck(profile, self._plan, port)
        self._others = SecondMaster(self._plan, looking_period_s(self._plan, profile), self._watchdog, self._readback)
        self._reopening = reopening or Reopening()
        self._open = False
        self._armed = False
        self.held_command: float | None = None  # what the device held when we came

    @property
    def info(self) -> BenchInfo:
        return info_of(self.profile, self._port, self._identity)

    def __enter__(self) -> Self:
        self.bus.open()
        self._open = True
        try:
            self._start()
        except BaseException:
            if self._armed:  # else it would take over later, for no reason that anybody could see
                self._quietly(self._watchdog.let_go)
            self._close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if not self._read_only and self.make_safe("the bench is left"):
                self._quietly(self._watchdog.let_go)
        finally:
            self._close()

    def _identify(self) -> None:
        for name, device in self.profile.devices.items():
            prefix = f"{name}." if len(self.profile.devices) > 1 else ""
            said = check_identity(self.bus, device, self._port)
            self._identity |= {prefix + key: text for key, text in said.items()}

    def _start(self) -> None:
        self._identify()
        # Proves that every signal can be read, before the first command.
        self.held_command = self._observe(strict=True, freshness=Freshness()).readback_psi
        if self._read_only:
            return
        if self._watchdog.tripped():
            if not self._acknowledge:
                raise SafetyTrip(
                    f"the device on {self._port} has put its output to the safe value and ignores commands; "
                    "look at the valve, then give it back with `lostmotion set --acknowledge`"
                )
            self._watchdog.clear()
            self._watchdog.let_go()  # who ran before may have left it on, and our first command may be seconds away

    def arm(self) -> None:
        """From now on the device waits for us: call it when commands are about to come. Else the first one does it.

        Raises: what the bus raises.
        """
        with self._lock:
            self._armed = True
            self._watchdog.arm(self.profile.safe_command)

    def disarm(self) -> None:
        """Once the valve is safe, the device need not wait for us any more. Never raises."""
        with self._lock:
            self._armed = self._armed and not self._quietly(self._watchdog.let_go)

    def _close(self) -> None:
        self._open = False
        self.bus.close()

    def exchange(self, command_psi: float) -> Sample:
        """Writes one command and reads everything. Raises: `BadInput` for a command that is no number."""
        if self._read_only:
            raise BadInput(f"the bench on {self._port} was opened for reading only")
        if not math.isfinite(command_psi):
            raise BadInput(f"command {command_psi} is not a number that a valve can be given")
        if not self._armed:
            self.arm()
        words, commanded = self._plan.sending(command_psi)
        with self._lock:
            foreign = self._others.look(self._clock.now_s(), self._try)
            began_s = self._clock.now_s()
            written = self._try(self._plan.write_request(words))
            self._others.sent(commanded if written else None)
            replies: Replies = [] if self._plan.joint is None else [(self._plan.joint, written)]
            # Without a confirmed command nobody knows what the readings answer to: the tick is missing as a whole.
            replies += [(block, self._try(block.request()) if written else None) for block in self._plan.blocks]
            sample = assemble(commanded, written.midpoint_s if written else began_s, replies, self._freshness, foreign)
            self._check(sample)
            return sample

    def observe(self) -> Sample:
        """Reads everything and writes nothing; `commanded_psi` is the read-back, NaN where there is none."""
        return self._observe(strict=False, freshness=self._freshness)

    def _observe(self, *, strict: bool, freshness: Freshness) -> Sample:
        """`strict`: a signal that cannot be read raises what the bus raises, instead of being MISSING."""
        with self._lock:
            began_s = self._clock.now_s()
            replies: Replies = []
            for block in self._plan.every_block():
                ask = block.request()
                replies.append((block, self.bus.transact(ask, retries=2) if strict else self._try(ask)))
            return assemble(None, began_s, replies, freshness)

    def make_safe(self, reason: str) -> bool:
        """Vents; with the safe direction `hold` the valve is left where it is. Never raises."""
        return self._open if self.profile.safe_direction == "hold" else self.vent()

    def vent(self) -> bool:
        """Sends the safe command up to three times, reopening a port that has gone; True: confirmed. Never raises."""
        for _ in range(_SAFE_TRIES):
            try:
                if self._open and self._send_safe():
                    return True
            except PortFault as gone:
                if not self.reopen(gone):
                    return False
            except (LostMotionError, OSError):
                continue
        return False

    def reopen(self, gone: PortFault) -> bool:
        """Waits for the port to come back, with the same device behind it. Never raises."""
        with self._lock:
            return self._open and self._reopening.again(self.bus, self._identify, gone)

    def emergency_stop(self) -> bool:
        """Makes the device itself put out its safe value and ignore us, where it can; else the safe command."""
        with self._lock:
            taken_over = self._quietly(self._watchdog.emergency)
            return self.vent() or taken_over

    def _send_safe(self) -> bool:
        words, safe = self._plan.sending(self.profile.safe_command)
        with self._lock:
            self._others.sent(None)
            self.bus.transact(self._plan.write_request(words), retries=1)
            self._others.sent(safe)
            readback = self.observe().readback_psi
        if self.profile.signals.readback is None:
            return True
        return readback is not None and abs(readback - self.profile.safe_command) <= self._readback.tolerance

    def _quietly(self, action: Callable[[], bool | None]) -> bool:
        """On the way out a fault must not hide the reason for leaving, nor keep the port open."""
        try:
            return action() is not False
        except (LostMotionError, OSError):
            return False

    def _try(self, request: Request) -> Reply | None:
        try:
            return self.bus.transact(request)
        except WireFault:
            return None
        except DeviceRefused as error:
            if error.code in _BUSY:
                return None
            raise

    def _check(self, sample: Sample) -> None:
        """What the device said besides the measurement. Raises: `SafetyTrip`."""
        check_status(sample.aux.get("watchdog_status"), self._port)
        if sample.position.quality & Quality.RESTARTED:
            self._watchdog.arm(self.profile.safe_command)  # a restart has made it forget
        self._readback.judge(sample.commanded_psi, sample.readback_psi)
