"""A recorded run, read back: start, samples with units, events, stop. Reads what a killed program left behind."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

import numpy as np

from hal.counted import counted
from hal.errors import BadInput
from logs.layout import EVENTS, SAMPLES, START, STOP, is_run_folder
from logs.recording import FloatArray, Recording

if TYPE_CHECKING:
    from io import BufferedReader

StopStatus = Literal["success", "abort", "fail"]
Status = Literal["success", "abort", "fail", "crash", "running"]


_NO_STOP = "no stop document: the program was killed, the power failed or the disk was full"


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened, or that somebody wrote down. `time_s` is bench time; None after the run has ended.

    `kind` is "event", "note" or "state"; `level` is "info", "warning" or "error".
    """

    time_s: float | None
    level: str
    text: str
    kind: str = "event"
    utc: str = ""


@dataclass(frozen=True, slots=True)
class Stop:
    """How a run ended, and why, in words; `rows` were written by then."""

    status: StopStatus
    reason: str
    utc: str = ""
    rows: int = 0


@dataclass(frozen=True, slots=True)
class Run:
    """A record. `columns` are float64 arrays of one length; `units` has the unit of each ("" where it has none).

    `problems` says in sentences what a crash or a damaged file has cost.
    """

    path: Path
    start: Mapping[str, object]
    columns: Mapping[str, FloatArray]
    units: Mapping[str, str]
    events: tuple[Event, ...] = ()
    stop: Stop | None = None
    problems: tuple[str, ...] = ()
    running: bool = False
    imported: Recording | None = None  # what a stranger's file was read as; None for a run of ours

    @property
    def rows(self) -> int:
        return int(next(iter(self.columns.values())).size) if self.columns else 0

    @property
    def name(self) -> str:
        return self.path.resolve().name

    @property
    def kind(self) -> str:
        return str(self.start.get("kind", "run"))

    @property
    def status(self) -> Status:
        """`success`, `abort` or `fail` as the stop document says; without one `running`, or `crash`."""
        if self.stop is None:
            return "running" if self.running else "crash"
        return self.stop.status

    @property
    def reason(self) -> str:
        if self.stop is not None:
            return self.stop.reason
        return "still running" if self.running else _NO_STOP

    @property
    def duration_s(self) -> float:
        time_s = self.columns.get("time_s")
        return float(time_s[-1] - time_s[0]) if time_s is not None and time_s.size else 0.0


def read_run(path: Path) -> Run:
    """Reads a run folder, also one that is being written, was cut off by a crash or lost its tail.

    Raises: `BadInput` when `path` is no run folder or its start document and its schema are both unreadable.
    """
    if not is_run_folder(path):
        what = "is not a run folder (no run.json in it)" if path.exists() else "does not exist"
        raise BadInput(f"{path}: {what}; `lostmotion runs` lists the recorded runs")
    problems: list[str] = []
    columns, units, inner_start = _read_samples(path, problems)
    start = _read_json(path / START, problems) or inner_start
    if not start and not columns:
        raise BadInput(f"{path}: neither {START} nor the head of {SAMPLES} can be read; nothing is left of this run")
    if not columns:
        named = start.get("columns")
        units = {str(key): str(unit) for key, unit in named.items()} if isinstance(named, Mapping) else {}
        columns = {key: np.zeros(0) for key in units}
    stop = _read_stop(path, problems)
    running = stop is None and is_being_written(path / SAMPLES)
    rows = next(iter(columns.values())).size if columns else 0
    if stop is None and not running:
        left = f"{counted(rows, 'row')} can be read"
        problems.insert(0, f"{_NO_STOP}; {left}")
    if stop is not None and rows < stop.rows:
        problems.append(f"{SAMPLES} holds {rows} of the {stop.rows} rows that were written; its tail is damaged")
    return Run(path, start, columns, units, _read_events(path, problems), stop, tuple(problems), running)


def _read_samples(path: Path, problems: list[str]) -> tuple[dict[str, FloatArray], dict[str, str], dict[str, object]]:
    """Every whole batch of the stream, the units and the start document in its schema."""
    import pyarrow as pa

    if not (path / SAMPLES).is_file():
        problems.append(f"{SAMPLES} is missing")
        return {}, {}, {}
    with (path / SAMPLES).open("rb") as file:
        try:
            reader = pa.ipc.open_stream(file)
        except (pa.ArrowInvalid, OSError):
            problems.append(f"{SAMPLES} ends before its first row")
            return {}, {}, {}
        batches = _whole_batches(reader, file, problems)
    table = pa.Table.from_batches(batches, reader.schema)
    columns = {name: table.column(name).to_numpy().astype(np.float64, copy=False) for name in table.column_names}
    units = {each.name: (each.metadata or {}).get(b"unit", b"").decode() for each in reader.schema}
    head = (reader.schema.metadata or {}).get(b"start", b"{}")
    return columns, units, json.loads(head)


def _whole_batches(reader: Any, file: BufferedReader, problems: list[str]) -> list[Any]:
    import pyarrow as pa

    batches = []
    end = file.tell()
    while True:
        try:
            batches.append(reader.read_next_batch())
        except StopIteration:
            return batches
        except (pa.ArrowInvalid, OSError):
            torn = file.seek(0, 2) - end
            problems.append(f"{SAMPLES} ends in a torn batch; its last {torn} bytes are ignored")
            return batches
        end = file.tell()


def _read_json(path: Path, problems: list[str]) -> dict[str, object]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        problems.append(f"{path.name} cannot be read")
        return {}
    return document if isinstance(document, dict) else {}


def _read_stop(path: Path, problems: list[str]) -> Stop | None:
    if not (path / STOP).exists():
        return None
    document = _read_json(path / STOP, problems)
    status = document.get("status")
    if status not in get_args(StopStatus):
        return None
    rows = document.get("rows")
    return Stop(
        status=cast(StopStatus, status),
        reason=str(document.get("reason", "")),
        utc=str(document.get("utc", "")),
        rows=rows if isinstance(rows, int) else 0,
    )


def _read_events(path: Path, problems: list[str]) -> tuple[Event, ...]:
    if not (path / EVENTS).is_file():
        return ()
    events = []
    for line in (path / EVENTS).read_bytes().splitlines():
        if not line.strip():
            continue  # a note that was written while the line before it was still growing begins with a line end
        try:
            entry = json.loads(line)
            time_s = entry.get("time_s")
            events.append(
                Event(
                    time_s=None if time_s is None else float(time_s),
                    level=str(entry.get("level", "info")),
                    text=str(entry.get("text", "")),
                    kind=str(entry.get("kind", "event")),
                    utc=str(entry.get("utc", "")),
                )
            )
        except (ValueError, AttributeError, TypeError):
            problems.append(f"{EVENTS} holds a torn line; the other events are complete")
    return tuple(events)


def is_being_written(samples: Path) -> bool:
    """Whether a live writer holds its lock; a killed one holds none."""
    try:
        import fcntl

        with samples.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except (ImportError, OSError):
        return False
    return False
