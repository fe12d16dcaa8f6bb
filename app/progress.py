"""A progress bar for long computations on stderr; silent where stderr is no terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

Progress = Callable[[str, float], None]
T = TypeVar("T")


def counted(results: Iterable[T], total: int, what: str) -> list[T]:
    """All `total` results, with a bar while they come."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    return list(track(results, what, total, console=console, disable=not console.is_terminal, transient=True))


@contextmanager
def diagnosis_progress() -> Iterator[Progress]:
    """Gives a callback `(what, share done)`; each `what` gets a bar of its own."""
    from rich.console import Console
    from rich.progress import BarColumn, TaskID, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Bars(*columns, console=console, transient=True, disable=not console.is_terminal) as bars:
        tasks: dict[str, TaskID] = {}

        def show(what: str, share: float) -> None:
            if what not in tasks:
                tasks[what] = bars.add_task(what, total=1.0)
            bars.update(tasks[what], completed=share)

        yield show
