"""An emergency stop outlives the program: a small file says that a person has to look before anything moves again."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass
from pathlib import Path

from hal.clock import utc_now
from hal.errors import SafetyTrip


def state_folder() -> Path:
    """Where the program keeps what must outlive it (`$XDG_STATE_HOME`, or ~/.local/state)."""
    base = os.environ.get("XDG_STATE_HOME")
    return (Path(base) if base else Path.home() / ".local" / "state") / "lostmotion"


@dataclass(frozen=True)
class Latch:
    """The emergency stop of one bench."""

    path: Path

    @staticmethod
    def of_port(port: str) -> Latch:
        """The latch of the bench at `port`, in the state folder."""
        return Latch(state_folder() / f"stop-{re.sub(r'[^A-Za-z0-9]+', '-', port).strip('-')}.json")

    def engaged(self) -> str | None:
        """Why nothing may move; None: it may. A file that cannot be read counts as an emergency stop."""
        try:
            text = self.path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            return f"{self.path} cannot be read ({error.strerror})"
        try:
            content = json.loads(text)
            return f"{content['reason']}, {content['time']}"
        except (ValueError, KeyError, TypeError):
            return f"{self.path} is damaged"

    def engage(self, reason: str) -> None:
        """Raises: `OSError` when the state folder cannot be written."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        content = {"reason": reason, "time": utc_now().isoformat(timespec="seconds")}
        self.path.write_text(json.dumps(content), encoding="utf-8")

    def acknowledge(self) -> None:
        """A person has looked."""
        self.path.unlink(missing_ok=True)

    def check(self) -> None:
        """Raises: `SafetyTrip` while the stop is not acknowledged."""
        reason = self.engaged()
        if reason is not None:
            raise SafetyTrip(
                f"emergency stop not acknowledged ({reason}): look at the valve, then `lostmotion set --acknowledge`"
            )
