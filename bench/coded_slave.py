"""A slave in a process of its own whose registers hold their own address, so that any wrong answer shows.

`python bench/coded_slave.py` prints its port and serves until its standard input is closed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim_device.faults import WireFaults
    from sim_device.line import Line

UNIT = 1


class Coded:
    """Register n holds n; writes are accepted and forgotten."""

    def check_read(self, table: int, address: int, count: int) -> None: ...

    def read(self, table: int, address: int, count: int) -> Sequence[int]:
        return [at & 0xFFFF for at in range(address, address + count)]

    def check_write(self, table: int, address: int, values: Sequence[int]) -> None: ...

    def write(self, table: int, address: int, values: Sequence[int]) -> None: ...


@contextmanager
def coded_slave(*arguments: str) -> Iterator[str]:
    """Runs the slave; yields its port."""
    command = [sys.executable, __file__, *arguments]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdin is not None and process.stdout is not None
    try:
        yield process.stdout.readline().strip()
    finally:
        process.stdin.close()
        process.wait(timeout=10.0)


def main() -> None:
    from sim_device.diagnostics import Diagnostics
    from sim_device.faults import parse_faults
    from sim_device.identity import Identity
    from sim_device.line import Line, Unit
    from sim_device.pdu import Server

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pace", type=int, help="baud rate of the line")
    parser.add_argument("--tcp", action="store_true", help="Modbus TCP instead of a pseudo-terminal")
    parser.add_argument("--fault", action="append", default=[], help="as in `lostmotion emulate`")
    parser.add_argument("--timeout", type=float, default=0.1, help="what late replies are measured in [s]")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    diagnostics = Diagnostics()
    unit = Unit(Server(Coded(), diagnostics, Identity({0: "bench"})), diagnostics, lambda: None)
    faults = parse_faults(tuple(asked.fault), seed=asked.seed, timeout_s=asked.timeout)
    if asked.tcp:
        serve_tcp(Line({UNIT: unit}), faults)
    else:
        serve_terminal(Line({UNIT: unit}), faults, asked.pace)


def serve_terminal(line: Line, faults: WireFaults, baud: int | None) -> None:
    from hal.clock import RealClock
    from sim_device.faulty_line import FaultyLine
    from sim_device.pacing import Pace
    from sim_device.pseudoterminal import PseudoTerminal
    from sim_device.responder import Responder, Stop

    terminal, stop = PseudoTerminal(), Stop()
    responder = Responder(
        line,
        RealClock(),
        stop,
        faults=FaultyLine(faults) if faults.any else None,
        pace=Pace(baud) if baud else None,
    )
    thread = threading.Thread(target=responder.serve, args=(terminal.fd,), kwargs={"until_eof": False}, daemon=True)
    thread.start()
    print(terminal.port, flush=True)
    sys.stdin.read()
    stop.set()
    thread.join(5.0)


def serve_tcp(line: Line, faults: WireFaults) -> None:
    from sim_device.faulty_stream import FaultyStream
    from sim_device.listener import Listener

    stream = FaultyStream(faults) if faults.any else None
    listener = Listener("tcp://127.0.0.1:0", lambda _: None, line, allow_remote=False, faults=stream)
    print(listener.url, flush=True)
    sys.stdin.read()
    listener.close()


if __name__ == "__main__":
    main()
