"""A figure of the thesis next to ours: what the thesis says, numbers, a picture, and why it comes out so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

BLUE, ORANGE, GREEN, RED, GREY = "#1f5fa8", "#d9822b", "#2e8b57", "#b5322e", "#8a8a8a"


@dataclass(frozen=True, slots=True)
class Number:
    """One number: the thesis's (None where it gives none) and ours, in the same unit. `digits` after the point.

    `absent` is shown where ours is not finite: there is no such thing.
    """

    label: str
    thesis: float | None
    ours: float
    unit: str
    digits: int = 2
    absent: str = "-"


@dataclass(frozen=True, slots=True)
class Entry:
    """One section of the gallery. `draw` fills an empty canvas; an entry without one has no picture."""

    key: str
    title: str
    said: str
    found: str
    numbers: tuple[Number, ...] = ()
    draw: Callable[[Canvas], None] | None = None
    size_in: tuple[float, float] = (7.2, 3.2)
    command: str = ""
    notes: tuple[str, ...] = field(default_factory=tuple)

    @property
    def picture(self) -> str:
        """The file name of the picture."""
        return f"thesis-{self.key}.png"


def save(entry: Entry, folder: Path) -> None:
    """Draws the entry's picture into `folder`."""
    from matplotlib.figure import Figure as Canvas

    if entry.draw is None:
        return
    canvas = Canvas(figsize=entry.size_in, dpi=90, layout="constrained")
    entry.draw(canvas)
    folder.mkdir(parents=True, exist_ok=True)
    canvas.savefig(folder / entry.picture, metadata={"Software": None})
