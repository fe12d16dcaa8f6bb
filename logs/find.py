"""Finding recorded runs by what an operator types: a path, a name under logs/runs, a part of one, or `latest`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hal.errors import BadInput
from logs.layout import SAMPLES, START, STOP, is_run_folder
from logs.writer import DEFAULT_ROOT


@dataclass(frozen=True, slots=True)
class Summary:
    """A run in one line. `rows` and `seconds` are None while it runs, or where its samples cannot be read."""

    path: Path
    kind: str
    utc: str
    status: str
    reason: str
    rows: int | None
    seconds: float | None
    controller: str
    note: str
    size_bytes: int


def find_record(text: str, root: Path = DEFAULT_ROOT) -> Path:
    """The run folder or file that `text` means.

    Raises: `BadInput` when there is none, or several fit, naming them.
    """
    path = Path(text)
    if path.is_file() or is_run_folder(path):
        return path
    folders = run_folders(root)
    if text == "latest" and folders:
        return folders[-1]
    exact = [each for each in folders if each.name == text]
    fits = exact or [each for each in folders if text in each.name]
    if len(fits) == 1:
        return fits[0]
    if len(fits) > 1:
        names = ", ".join(each.name for each in fits[:6])
        raise BadInput(f"'{text}' fits {len(fits)} runs ({names}); give more of the name")
    if path.is_dir():
        raise BadInput(f"{path}: a folder without {START} is no run; `lostmotion runs {path}` lists the runs in it")
    raise BadInput(f"'{text}' is neither a file nor a run under {root}; `lostmotion runs` lists the recorded runs")


def run_folders(root: Path) -> list[Path]:
    """Every run under `root`, however deep, in the order of their start; folders inside a run are not searched."""
    if not root.is_dir():
        return []
    found: list[Path] = []
    waiting = [root]
    while waiting:
        folder = waiting.pop()
        if is_run_folder(folder):
            found.append(folder)
        else:
            waiting += [each for each in folder.iterdir() if each.is_dir() and not each.name.startswith(".")]
    return sorted(found, key=lambda each: (_utc(each), each.name))


def summarize(folder: Path) -> Summary:
    """Reads the two documents, so that a table of a thousand runs is instant; the samples only after a crash."""
    from logs.run import is_being_written

    start, stop = _document(folder / START), _document(folder / STOP)
    running = not stop and is_being_written(folder / SAMPLES)
    status = str(stop.get("status", "running" if running else "crash"))
    reason = str(stop.get("reason", "still running" if running else "no stop document"))
    rows, last_s, first_s = stop.get("rows"), stop.get("last_time_s"), stop.get("first_time_s")
    known = isinstance(last_s, int | float) and isinstance(first_s, int | float)
    seconds = float(last_s) - float(first_s) if known else None  # type: ignore[arg-type]
    if not stop and not running:
        rows, seconds = _left_by_a_crash(folder)
    return Summary(
        path=folder,
        kind=str(start.get("kind", "?")),
        utc=str(start.get("utc", "")),
        status=status,
        reason=reason,
        rows=rows if isinstance(rows, int) else None,
        seconds=seconds,
        controller=_name(start.get("controller")),
        note=str(start.get("note") or ""),
        size_bytes=sum(each.stat().st_size for each in folder.iterdir() if each.is_file()),
    )


def _left_by_a_crash(folder: Path) -> tuple[int | None, float | None]:
    """Rows and seconds of the samples that can be read."""
    from logs.run import read_run

    try:
        run = read_run(folder)
    except (BadInput, OSError, ValueError):
        return None, None
    return (run.rows, run.duration_s) if run.columns else (None, None)


def _name(value: object) -> str:
    """A controller or an experiment in the start document is a name, or a table with one."""
    if isinstance(value, Mapping):
        return str(value.get("name", ""))
    return "" if value is None else str(value)


def _utc(folder: Path) -> str:
    return str(_document(folder / START).get("utc", ""))


def _document(path: Path) -> Mapping[str, object]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return document if isinstance(document, dict) else {}
