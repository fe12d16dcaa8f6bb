"""A recording that anybody can get, as `lostmotion diagnose` is given it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

#: A valve with a positioner, one to one: what is asked is where the stem goes. All of it is guessed but the ones.
SERVO = """[units]
pressure = "percent"
position = "percent"
[ep]
tau = {ep_tau_s}
[valve]
a1 = {onset}
a2 = {onset}
compliance = {gain}
tau = {tau_s}
rate_limit = {rate_per_s}
travel = 100.0
"""


@dataclass(frozen=True, slots=True)
class Recording:
    """One file and the words that say what its columns are; `known` is what somebody says of the machine."""

    group: str
    name: str
    known: str
    file: Path
    words: tuple[str, ...]


def columns(**names: str) -> tuple[str, str]:
    """`--map` with the columns of a file."""
    return "--map", ",".join(f"{signal}={column}" for signal, column in names.items())


def units(**names: str) -> tuple[str, str]:
    """`--units` with the units of a file."""
    return "--units", ",".join(f"{signal}={unit}" for signal, unit in names.items())


def servo(
    path: Path, ep_tau_s: float, tau_s: float, rate_per_s: float = 100.0, gain: float = 1.0, onset: float = 0.0
) -> tuple[str, str]:
    """`--design` with a file written for it."""
    text = SERVO.format(ep_tau_s=ep_tau_s, tau_s=tau_s, rate_per_s=rate_per_s, gain=gain, onset=onset)
    path.write_text(text, encoding="utf-8")
    return "--design", str(path)
