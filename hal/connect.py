"""From a profile and the name of a port to a bus that is not open yet."""

from __future__ import annotations

from hal.clock import Clock
from hal.errors import BadInput
from hal.profile import Profile
from hal.reply import Bus

BACKENDS = ("native", "pymodbus")


def make_bus(profile: Profile, port: str, clock: Clock, *, backend: str = "native", margin_s: float = 0.25) -> Bus:
    """The bus for `port`. `margin_s`: how much longer than wire and device need an answer may take [s].

    Raises: `BadInput` for a port name or backend that does not exist.
    """
    from hal.port import parse_port

    where = parse_port(port)
    if backend not in BACKENDS:
        raise BadInput(f"unknown backend '{backend}'; there are {', '.join(BACKENDS)}")
    devices = tuple(profile.devices.values())
    from hal.bus import RtuBus

    if backend == "pymodbus":
        from hal.backend_pymodbus import PymodbusLine

        return RtuBus(PymodbusLine(where, profile.serial, clock), devices, margin_s=margin_s)
    from hal.line import RtuLine
    from hal.tcp_bus import TcpBus
    from hal.transport import make_transport

    transport = make_transport(where, profile.serial)
    if where.kind == "tcp":
        slowest_s = max(device.turnaround_ms for device in devices) / 1000.0
        return TcpBus(transport, clock, timeout_s=slowest_s + margin_s, name=port)
    return RtuBus(RtuLine(transport, profile.serial, clock, name=port), devices, margin_s=margin_s)
