"""The process behind a live view: `python -m logs.view_process`, started by `logs.stream` and ended by its pipe.

It has an interpreter of its own, because rerun's work in the interpreter of the control loop would make ticks late; and
it takes the processor only when nobody else wants it. When the run ends, or is killed, the pipe ends, and so does this.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from pathlib import Path

from hal.clock import Clock, RealClock
from logs.live import PERIOD_S, LiveStream
from logs.view_wire import Unpacker

NICENESS = 10


def main() -> None:
    """Reads the run as one line of JSON and then frames, from stdin; says one line of JSON, and one more on trouble."""
    try:
        stream = _open(sys.stdin.fileno())
        _say({"uri": stream.uri})
        _step_back()
        work(sys.stdin.fileno(), stream, RealClock())
    except Exception as error:  # the view is a convenience: whatever it is, the run goes on
        _say({"trouble": f"{type(error).__name__}: {error}"})


def work(pipe: int, stream: LiveStream, clock: Clock) -> None:
    """Hands on what comes out of the pipe, ten times a second, until it ends. Raises: what the stream raises.

    After each pause it takes what is there and waits for what comes next. That is the loop at the end of a tick: until
    the next one it has no use for the processor.
    """
    unpacker = Unpacker()
    while data := os.read(pipe, 1 << 20):
        data += os.read(pipe, 1 << 20)
        stream.take(list(unpacker.feed(data)))
        clock.sleep_until(clock.now_s() + PERIOD_S)
    stream.close()


def _open(pipe: int) -> LiveStream:
    head = b""
    while not head.endswith(b"\n"):
        byte = os.read(pipe, 1)  # one at a time: what follows the line are frames
        if not byte:
            raise EOFError("the run ended before it began")
        head += byte
    document = json.loads(head)
    file = None if document["file"] is None else Path(document["file"])
    return LiveStream(document["start"], document["columns"], document["serve"], file)


def _say(words: dict[str, str]) -> None:
    with contextlib.suppress(OSError):  # whoever asked may be gone
        print(json.dumps(words), flush=True)


def _step_back() -> None:
    """Gives way to the control loop: every thread that rerun has started, too."""
    with contextlib.suppress(OSError, AttributeError):
        tasks = Path("/proc/self/task")
        for task in [int(entry.name) for entry in tasks.iterdir()] if tasks.is_dir() else [0]:
            os.setpriority(os.PRIO_PROCESS, task, NICENESS)


if __name__ == "__main__":
    main()
