"""What can go wrong, as a tree; the roof turns it into one sentence and an exit code.

LostMotionError
├── BadInput            a file, row, value, argument or profile that cannot be used   (exit 2)
└── JobFailed           the job was valid and did not succeed                         (exit 1)
    └── BenchFault      the bench: port, wire, device, limits
        ├── PortFault   the port cannot be opened, or is gone
        ├── WireFault   no reply, or none that could be trusted
        ├── DeviceRefused   the device answered with a Modbus exception
        └── SafetyTrip  a limit was passed, or readings went stale
"""

from __future__ import annotations


class LostMotionError(Exception):
    """A failure with one clear sentence: what, where, which value, which limit, what to do."""

    exit_code = 1


class BadInput(LostMotionError):
    """The input cannot be used; nothing has been done with it."""

    exit_code = 2


class JobFailed(LostMotionError):
    """The input was valid, the job did not succeed."""


class BenchFault(JobFailed):
    """The bench failed while the job ran; the valve has been sent to its safe state, or the message says not."""


class PortFault(BenchFault):
    """The port cannot be opened, is busy, or has been unplugged."""


class WireFault(BenchFault):
    """No reply, or none that could be trusted. Carries what was sent and what came back."""

    def __init__(self, message: str, *, sent: bytes = b"", received: bytes = b"", waited_s: float = 0.0) -> None:
        super().__init__(message)
        self.sent = sent
        self.received = received
        self.waited_s = waited_s


class DeviceRefused(BenchFault):
    """The device answered with a Modbus exception code."""

    def __init__(self, message: str, *, function: int, code: int) -> None:
        super().__init__(message)
        self.function = function
        self.code = code


class SafetyTrip(BenchFault):
    """The safety layer stopped the bench: a limit, a stale or an implausible reading."""
