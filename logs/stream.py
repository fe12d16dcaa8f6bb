"""A run shown in rerun while it happens. The control tick hands over a row; nothing here can delay it or stop it.

The view lives in a process of its own (`logs.view_process`), which serves viewers on the loopback address and dies with
this one. A row is one write to a pipe that takes it whole or not at all. When the view cannot keep up it drops rows and
counts them; when it fails it is off and says why in `trouble`.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import subprocess
import sys
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import Self

from hal.clock import RealClock
from logs.layout import to_plain
from logs.run import Event
from logs.view_wire import pack_event, pack_row

CAPACITY_ROWS = 20_000  # that wait here while the pipe is full
PIPE_BYTES = 1 << 20
PATIENCE_S = 20.0  # for the process to start; importing rerun takes a second, on a busy machine several

_HOUSE = Path(__file__).resolve().parent.parent
_SET_PIPE_SIZE = 1031  # F_SETPIPE_SZ of Linux


class RunView:
    """A live view of one run. No method raises and none waits, except `close`, which waits 10 s at most.

    `uri` is where a viewer connects, "" when there is none; `trouble` says why the view is off, "" when it is on.
    """

    def __init__(self, columns: Mapping[str, str]) -> None:
        """Use `open`."""
        self.uri = ""
        self.trouble = ""
        self.dropped = 0
        self._names = tuple(columns)
        self._backlog: deque[bytes] = deque()
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe = -1

    @classmethod
    def open(
        cls,
        start: Mapping[str, object],
        columns: Mapping[str, str],
        *,
        serve: bool = True,
        file: Path | None = None,
        design: Mapping[str, object] | None = None,
    ) -> RunView:
        """Starts the view; takes the second that importing rerun takes, so call it before the run.

        `columns` and `start` are those of the `RunWriter`. With `serve` viewers can connect to `uri`; with `file`
        the view is written there too. `design` draws its curves where `start` names no design.
        """
        view = cls(columns)
        document = {
            "start": {**start, "design": start.get("design") or design},
            "columns": dict(columns),
            "serve": serve,
            "file": None if file is None else str(file.resolve()),
        }
        try:
            pack_row((0.0,) * len(columns))
            view._start(json.dumps(to_plain(document)).encode() + b"\n")
        except Exception as error:  # the view is a convenience: whatever it is, the run goes on
            view._turn_off(f"{type(error).__name__}: {error}")
        return view

    @property
    def on(self) -> bool:
        return not self.trouble and self._pipe >= 0

    @property
    def process_id(self) -> int:
        """Of the process behind the view; 0 when there is none."""
        return 0 if self._process is None else self._process.pid

    def append(self, row: Mapping[str, float]) -> None:
        """Takes one row; costs microseconds."""
        if self._room():
            nan = float("nan")
            self._backlog.append(pack_row(tuple(row.get(name, nan) for name in self._names)))
            self._push()

    def event(self, time_s: float | None, level: str, text: str) -> None:
        self._say(Event(time_s, level, text))

    def note(self, time_s: float | None, text: str) -> None:
        self._say(Event(time_s, "info", text, kind="note"))

    def state(self, time_s: float | None, text: str) -> None:
        """The bench is in state `text` from `time_s` on."""
        self._say(Event(time_s, "info", text, kind="state"))

    def close(self) -> None:
        """Sends what is left, and ends the service. Safe to call twice."""
        process, self._process = self._process, None
        if process is None:
            return
        if self.on and self.dropped:
            lost = f"this view lost {self.dropped} rows; the record has all of them"
            self._backlog.append(pack_event(Event(None, "warning", lost)))
        self._push_rest()
        self._hang_up(process)
        try:
            said, _ = process.communicate(timeout=5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            said, _ = process.communicate()
            self._turn_off("it did not end in time")
        self._hear(said)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _start(self, document: bytes) -> None:
        path = os.pathsep.join(filter(None, (str(_HOUSE), os.environ.get("PYTHONPATH"))))
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "logs.view_process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": path},
            process_group=0,  # Ctrl-C is meant for the run
        )
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(document)
        self._process.stdin.flush()
        answer = self._process.stdout
        if not select.select([answer], [], [], PATIENCE_S)[0]:
            raise TimeoutError(f"its process did not start within {PATIENCE_S:g} s")
        said = json.loads(answer.readline() or b'{"trouble": "its process died"}')
        if "trouble" in said:
            self._turn_off(said["trouble"])
            return
        self.uri = said["uri"]
        self._pipe = self._process.stdin.fileno()
        os.set_blocking(self._pipe, False)
        self._widen()

    def _widen(self) -> None:
        """A larger pipe, where the system has such a thing: rows wait there, not here."""
        if sys.platform == "linux":
            import fcntl

            with contextlib.suppress(OSError):
                fcntl.fcntl(self._pipe, _SET_PIPE_SIZE, PIPE_BYTES)

    def _say(self, event: Event) -> None:
        if self._room():
            self._backlog.append(pack_event(event))
            self._push()

    def _room(self) -> bool:
        if not self.on:
            return False
        if len(self._backlog) < CAPACITY_ROWS:
            return True
        self._push()
        self.dropped += 1
        return False

    def _push(self) -> None:
        """Writes what the pipe takes without waiting."""
        while self._backlog:
            frame = self._backlog.popleft()
            try:
                os.write(self._pipe, frame)
            except BlockingIOError:
                self._backlog.appendleft(frame)
                return
            except OSError as error:
                self._turn_off(f"its process is gone ({error.strerror})")

    def _push_rest(self) -> None:
        clock = RealClock()
        end_s = clock.now_s() + 5.0
        while self.on and self._backlog and (left_s := end_s - clock.now_s()) > 0.0:
            select.select([], [self._pipe], [], left_s)
            self._push()

    def _hang_up(self, process: subprocess.Popen[bytes]) -> None:
        """Ends the pipe: the process shows what it has, completes its file and ends."""
        self._pipe = -1
        if process.stdin is not None:
            with contextlib.suppress(OSError):
                process.stdin.close()
            process.stdin = None

    def _hear(self, said: bytes) -> None:
        """The last words of the process are better than what was guessed from outside."""
        for line in said.splitlines():
            with contextlib.suppress(ValueError, KeyError):
                self._turn_off(json.loads(line)["trouble"])

    def _turn_off(self, why: str) -> None:
        self.trouble = f"the view is off ({why}); the run and its record go on"
        self._backlog.clear()
