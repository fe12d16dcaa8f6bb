"""What a bus has been through, in numbers."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(slots=True)
class BusStats:
    """Counters since the bus was opened. They only grow."""

    transactions: int = 0  # requests that were answered as they should be, exceptions included
    timeouts: int = 0  # requests without an answer that could be trusted
    damaged: int = 0  # of these, those where something arrived
    noise_bytes: int = 0  # bytes around an answer that belonged to nothing
    late_bytes: int = 0  # bytes that arrived after their request had been given up
    exceptions: int = 0  # answers that were Modbus exceptions
    resyncs: int = 0  # times the line was proved clean again
    probes: int = 0  # questions sent to prove it
    retries: int = 0  # requests sent again

    def as_dict(self) -> dict[str, int]:
        return asdict(self)
