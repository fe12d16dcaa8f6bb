"""However a run ends: first the safe command, then the record says which way, and whether it was confirmed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol

from control.loop import Loop, Outcome
from hal.safety import describe_way_out
from hal.signals import shielded


class Record(Protocol):
    """What is closed at the end."""

    def close(self, status: Literal["success", "abort", "fail"], reason: str) -> None: ...


def supervised(loop: Loop, record: Record, job: Callable[[], Outcome]) -> Outcome:
    """Runs the job and closes its record as `success`, `abort` (the operator) or `fail` (everything else).

    Raises: what the job raised, after the valve has been made safe and the record is closed.
    """
    try:
        outcome = job()
    except BaseException as error:
        with shielded():
            _end(loop, record, error)
        raise
    _end(loop, record, None)
    return outcome


def _end(loop: Loop, record: Record, error: BaseException | None) -> None:
    status, reason = describe_way_out(error)
    confirmed = loop.bench.make_safe(reason)
    info = loop.bench.info
    command = f"{info.safe_command:g} {info.command_unit}"
    if confirmed:
        safe = f"the bench confirmed its safe state ({command}, or held, as its profile says)"
    else:
        safe = f"the safe command, {command}, was NOT confirmed: check the valve"
    loop.say("info" if confirmed else "error", f"{reason}; {safe}")
    loop.say_state("safe" if confirmed else "fault")
    record.close(status, f"{reason}; {safe}")
