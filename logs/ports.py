"""Finding a free port on the loopback address, and proving that somebody listens on one."""

from __future__ import annotations

import socket

from hal.clock import Clock, RealClock

LOOPBACK = "127.0.0.1"


def free_port() -> int:
    """A port that was free a moment ago."""
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def listens(port: int, patience_s: float, clock: Clock | None = None) -> bool:
    """Whether somebody accepts connections on the port within `patience_s`."""
    clock = clock or RealClock()
    end_s = clock.now_s() + patience_s
    while True:
        try:
            with socket.create_connection((LOOPBACK, port), timeout=0.5):
                return True
        except OSError:
            if clock.now_s() >= end_s:
                return False
            clock.sleep_until(clock.now_s() + 0.05)
