"""An emergency stop outlives the program: a small file says that a person has to look before anything moves again."""

from __future__ import annotations

import json
import os
import re
import socket
from dataclasses import dataclass
from pathlib import Path

from hal.clock import utc_now
from hal.errors import BadInput, SafetyTrip
from hal.port import parse_port


def state_folder() -> Path:
    """Where the program keeps what must outlive it (`$XDG_STATE_HOME`, or ~/.local/state)."""
    base = os.environ.get("XDG_STATE_HOME")
    return (Path(base) if base else Path.home() / ".local" / "state") / "lostmotion"


@dataclass(frozen=True)
class Latch:
    """The emergency stop of one bench: a file, and others `also` where its port has other names."""

    path: Path
    also: tuple[Path, ...] = ()

    @staticmethod
    def of_port(port: str) -> Latch:
        """The latch of the bench at `port`, in the state folder.

        One bench has many names: a link by its serial number, another folder's path to it, a host by name or number. So
        there is a file for what the name leads to beside the one for the name, which may lead elsewhere tomorrow.
        """
        first, *others = dict.fromkeys(map(_file_of, (_led_to(port), port)))
        return Latch(first, tuple(others))

    @property
    def paths(self) -> tuple[Path, ...]:
        """Every file of which one stops the bench."""
        return (self.path, *self.also)

    def is_set(self) -> bool:
        """Whether there is a stop, without a look at its reason: cheap enough for every tick."""
        return any(path.exists() for path in self.paths)

    def engaged(self) -> str | None:
        """Why nothing may move; None: it may. A file that cannot be read counts as an emergency stop."""
        return next((reason for reason in map(_reason, self.paths) if reason is not None), None)

    def engage(self, reason: str) -> None:
        """Raises: `OSError` when the state folder cannot be written."""
        content = {"reason": reason, "time": utc_now().isoformat(timespec="seconds")}
        for path in self.paths:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(content), encoding="utf-8")

    def acknowledge(self) -> None:
        """A person has looked."""
        for path in self.paths:
            path.unlink(missing_ok=True)

    def check(self) -> None:
        """Raises: `SafetyTrip` while the stop is not acknowledged."""
        reason = self.engaged()
        if reason is not None:
            raise SafetyTrip(
                f"emergency stop not acknowledged ({reason}): look at the valve, then `lostmotion set --acknowledge`"
            )


def _file_of(name: str) -> Path:
    return state_folder() / f"stop-{re.sub(r'[^A-Za-z0-9]+', '-', name).strip('-')}.json"


def _led_to(port: str) -> str:
    """What the name of a port leads to: the device behind links, the number of a host and of its port."""
    try:
        name = parse_port(port)
    except BadInput:
        return port
    if name.kind == "serial":
        return str(Path(port).resolve()) if Path(port).exists() else port
    try:
        return f"{name.kind}://{socket.gethostbyname(name.host)}:{name.number}"
    except OSError:
        return port


def _reason(path: Path) -> str | None:
    try:
        text = path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        return f"{path} cannot be read ({error.strerror})"
    try:
        content = json.loads(text)
        return f"{content['reason']}, {content['time']}"
    except (ValueError, KeyError, TypeError):
        return f"{path} is damaged"
