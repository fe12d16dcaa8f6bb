"""Tables on the screen and in a pipe: a unit in brackets stays what it is, and a pipe gets no line breaks of ours."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table


def new_table(title: str, headings: Sequence[str], left: Collection[str] = ()) -> Table:
    """A table whose columns are numbers, aligned on the right, but for those named in `left`."""
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title, style="table.title"))  # as plain text, in which "[in]" is no style of rich's
    for heading in headings:
        table.add_column(Text(heading), justify="left" if heading in left else "right")
    return table


def console(width: int = 160) -> Console:
    """Standard output, `width` columns wide where it is no terminal."""
    from rich.console import Console

    found = Console(highlight=False)
    if not found.is_terminal:
        found.width = width
    return found
