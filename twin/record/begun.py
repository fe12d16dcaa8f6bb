"""The state before the first row of a recording, as far as the recording tells."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Begun:
    """`play`: towards which reading the valve was moving, None where it stood still (`twin.replay.simulate.moving_to`).

    `remembers`: something slow holds it. `pressure`: what it was, where none was measured and the first command is not
    it, else None. `unsure_s`: how long what is only guessed of all this is felt [s].
    """

    play: float | None = None
    remembers: bool = False
    pressure: float | None = None
    unsure_s: float = 0.0
