"""Where a valve is after it has been sent to safety, in the words that end every job."""

from __future__ import annotations

from hal.bench import BenchInfo


def whereabouts(info: BenchInfo, safe: bool, sent: float | None) -> str:
    """`safe`: the device confirmed; `sent`: the last command of the job, None: there was none."""
    last = "nothing was sent to it" if sent is None else f"last sent {sent:.4g} {info.command_unit}"
    if not safe:
        return f"the valve did NOT confirm its safe command, {last}"
    if info.profile.get("safe_direction") == "hold":
        return f"the valve is left where it is, {last}"
    return "the valve is at its safe command"
