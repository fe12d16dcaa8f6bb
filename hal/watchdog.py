"""The device's own dead man's handle, from the master's side: arm, look, clear, let go."""

from __future__ import annotations

from hal.assemble import NO_VALUE
from hal.device import Device, Watchdog
from hal.errors import SafetyTrip
from hal.pdu import Request, read_coils, read_registers, write_coil, write_register, write_registers
from hal.register import Register
from hal.reply import Bus
from hal.sample import Reading


def check_status(status: Reading | None, where: str) -> None:
    """Raises: `SafetyTrip` when the device at `where` says in a tick that it has taken over."""
    if status is not None and not status.quality & NO_VALUE and status.value != 0:
        raise taken_over(where, f" (status {status.value:g})")


def taken_over(where: str, status: str = "") -> SafetyTrip:
    """The sentence for a device that obeys nobody any more."""
    return SafetyTrip(
        f"the device on {where} has put its output to the safe value{status}: it heard "
        "nothing for too long, or an emergency stop; look at the valve, then `lostmotion set --acknowledge`"
    )


class WatchdogControl:
    """Speaks to the watchdog of one device. Without registers for it, every call does nothing.

    Raises (all methods): what the bus raises.
    """

    def __init__(self, bus: Bus, device: Device) -> None:
        self._bus = bus
        self._device = device
        self._setup: Watchdog | None = device.watchdog

    def arm(self, safe_value: float) -> None:
        """Tells the device what is safe and how long it may wait for us."""
        if self._setup is not None:
            self._write(self._setup.safe_value, safe_value)
            self._write(self._setup.timeout, self._setup.timeout_s)
            self._write(self._setup.enable, 1)

    def let_go(self) -> None:
        """Switches the watchdog off; only after the valve is safe."""
        if self._setup is not None:
            self._write(self._setup.enable, 0)
            self._write(self._setup.timeout, 0.0)

    def tripped(self) -> bool:
        """Whether the device has taken over, and ignores commands."""
        return self._setup is not None and self._setup.status is not None and self._read(self._setup.status) != 0

    def clear(self) -> None:
        """Gives the commands back to us; a person has to have asked for it."""
        if self._setup is not None:
            self._write(self._setup.status, float(self._setup.clear))
            self._write(self._setup.emergency, 0)

    def emergency(self) -> bool:
        """Makes the device take over now; False when it has no register for that."""
        if self._setup is None or self._setup.emergency is None:
            return False
        self._write(self._setup.emergency, 1)
        return True

    def _address(self, register: Register) -> int:
        return register.address - self._device.address_base

    def _write(self, register: Register | None, value: float) -> None:
        if register is None:
            return
        unit, address = self._device.id, self._address(register)
        words = register.to_words(value, self._device.word_order)
        request: Request
        if register.table == "coil":
            request = write_coil(unit, address, bool(words[0]))
        elif self._device.write_fc == 6:
            request = write_register(unit, address, words[0])
        else:
            request = write_registers(unit, address, words)
        self._bus.transact(request, retries=2)

    def _read(self, register: Register) -> float:
        unit, address = self._device.id, self._address(register)
        if register.table == "coil":
            return float(self._bus.transact(read_coils(unit, address), retries=2).pdu[2] & 1)
        function = 4 if register.table == "input" else 3
        words = self._bus.transact(read_registers(unit, function, address, register.words), retries=2).words
        return register.counts(words, self._device.word_order)
