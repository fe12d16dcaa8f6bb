"""The files of a run folder, and how documents are written into it so that a crash leaves none of them half."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path

START = "run.json"  # the start document, complete before the first sample
SAMPLES = "samples.arrows"  # Arrow IPC stream, append-only
EVENTS = "events.jsonl"  # one JSON object a line, append-only
STOP = "stop.json"  # the stop document; a run without it is running or has crashed
RECORD = frozenset({START, SAMPLES, EVENTS, STOP})  # what nothing but the recorder writes
VIEW = "view.rrd"  # a view for rerun, made from the record; never the truth


def is_run_folder(path: Path) -> bool:
    """Whether `path` is a folder with a run in it."""
    return path.is_dir() and ((path / START).is_file() or (path / SAMPLES).is_file())


def to_plain(value: object) -> object:
    """`value` as plain JSON values: non-finite numbers become null, unknown things their text."""
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): to_plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [to_plain(item) for item in value]
    item = getattr(value, "item", None)  # a numpy scalar
    return to_plain(item()) if callable(item) and not hasattr(value, "__len__") else str(value)


def write_document(path: Path, document: Mapping[str, object]) -> None:
    """Writes JSON so that after a crash or a power cut the file is there completely or not at all."""
    partial = path.with_suffix(".partial")
    with partial.open("w", encoding="utf-8") as file:
        json.dump(to_plain(document), file, indent=1, ensure_ascii=False)
        file.write("\n")
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)
    _sync_folder(path.parent)


def _sync_folder(folder: Path) -> None:
    """Makes a rename durable; where a folder cannot be synced (Windows) the rename alone has to do."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
