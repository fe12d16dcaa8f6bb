"""A port that has gone while it was in use is opened again, for a limited time: the valve is still out there."""

from __future__ import annotations

from collections.abc import Callable

from hal.clock import Clock, RealClock
from hal.errors import BenchFault, DeviceRefused, PortFault, WireFault
from hal.reply import Bus

_PAUSE_S = 0.25


class Reopening:
    """Opens a bus again. `limit_s`: how long it tries, in real time; `say` is told that it does, and how it went."""

    def __init__(
        self, limit_s: float = 10.0, say: Callable[[str], None] | None = None, clock: Clock | None = None
    ) -> None:
        self.limit_s = limit_s
        self._clock = clock or RealClock()
        self._say = say or (lambda _: None)
        self._in_vain = False

    def again(self, bus: Bus, check: Callable[[], object], gone: PortFault) -> bool:
        """True when the port is open again and `check` has passed: it must prove that the same device is there.

        After one attempt in vain it does not try any more: the way out must not take for ever.
        """
        if self._in_vain:
            return False
        clock = self._clock
        self._say(f"{gone}; for {self.limit_s:g} s it is tried to open it again")
        end_s = clock.now_s() + self.limit_s
        while clock.now_s() < end_s:
            try:
                bus.close()
                bus.open()
                check()
            except (PortFault, WireFault, DeviceRefused, OSError):
                clock.sleep_until(clock.now_s() + _PAUSE_S)
                continue
            except BenchFault as other:  # somebody answers, and it is not our device
                self._say(str(other))
                break
            self._say("the port is open again")
            return True
        bus.close()  # whatever is there now, nothing may be written to it
        self._in_vain = True
        self._say("the port did not come back")
        return False
