"""What an operator sees and says during a run: a progress bar with the time left, and notes from the keyboard."""

from __future__ import annotations

import select
import sys
import threading
from collections import deque
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Self, TextIO

from hal.clock import RealClock

if TYPE_CHECKING:
    from rich.progress import TaskID

    from control.loop import Progress as Where

REFRESH_S = 0.1


class RunDisplay:
    """A progress bar on stderr with step, readings and time left; silent where stderr is no terminal."""

    def __init__(self, title: str) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

        console = Console(stderr=True)
        self._clock = RealClock()
        self._shown_s = float("-inf")
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %  {task.fields[readings]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=console,
            disable=not console.is_terminal,
            transient=True,
        )
        self._task: TaskID = self._bar.add_task(title, total=1.0, readings="")

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Takes the bar away."""
        self._bar.stop()

    def show(self, where: Where) -> None:
        """Takes every tick; draws at most ten times a second."""
        now_s = self._clock.now_s()
        if now_s - self._shown_s < REFRESH_S and where.done_s < where.total_s:
            return
        self._shown_s = now_s
        sample = where.sample
        pressure = "" if sample.pressure is None else f"{sample.pressure.value:6.2f} psi "
        readings = f"{where.label:<12} {pressure}{sample.position.value:7.4f} in"
        self._bar.update(self._task, completed=where.done_s, total=where.total_s, readings=readings)


class KeyboardNotes:
    """Lines typed while a run goes on become notes in its record; nothing is read where stdin is no terminal."""

    def __init__(self) -> None:
        self._lines: deque[str] = deque()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        if sys.stdin is not None and sys.stdin.isatty():
            self._thread = threading.Thread(target=self._listen, args=(sys.stdin,), name="notes", daemon=True)
            self._thread.start()

    def __call__(self) -> Sequence[str]:
        """The notes since the last call."""
        if not self._lines:
            return ()
        return [self._lines.popleft() for _ in range(len(self._lines))]

    def close(self) -> None:
        self._ended.set()

    def join(self) -> None:
        """Returns when the keyboard is no longer read."""
        if self._thread is not None:
            self._thread.join()

    def _listen(self, keyboard: TextIO) -> None:
        while not self._ended.is_set():
            ready, _, _ = select.select([keyboard], [], [], 0.2)
            if not ready:
                continue
            line = keyboard.readline()
            if not line:
                return
            if line.strip():
                self._lines.append(line.strip())
