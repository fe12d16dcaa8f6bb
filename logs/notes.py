"""Adding a note to a record from outside: one appended line, while another process may be writing the record."""

from __future__ import annotations

from pathlib import Path

from hal.clock import utc_now
from hal.errors import BadInput
from logs.layout import EVENTS, is_run_folder
from logs.run import read_run
from logs.sink import event_line


def add_note(folder: Path, text: str) -> float | None:
    """Appends a note and returns its bench time [s]: the last sample's while the run goes on, None after its end.

    Raises: `BadInput` when `folder` is no run, or cannot be written to.
    """
    if not is_run_folder(folder):
        raise BadInput(f"{folder}: notes go into run folders; `lostmotion runs` lists them")
    run = read_run(folder)
    time_s = run.columns.get("time_s")
    at_s = float(time_s[-1]) if run.running and time_s is not None and time_s.size else None
    utc = utc_now().isoformat(timespec="milliseconds")
    line = event_line({"time_s": at_s, "kind": "note", "level": "info", "text": text, "utc": utc})
    try:
        with (folder / EVENTS).open("ab", buffering=0) as file:
            file.write(_line_break(folder / EVENTS) + line)
    except OSError as error:
        raise BadInput(f"{folder}: the note cannot be written ({error.strerror}); check the folder's rights") from error
    return at_s


def _line_break(path: Path) -> bytes:
    """A line end where a crash has left the last line without one, so that the note stands on its own."""
    with path.open("rb") as file:
        if file.seek(0, 2) == 0:
            return b""
        file.seek(-1, 2)
        return b"" if file.read(1) == b"\n" else b"\n"
