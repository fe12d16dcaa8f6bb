"""Any record as a `Run`, for looking at it and handing it on: a run folder as it is, a stranger's file converted."""

from __future__ import annotations

from pathlib import Path

from logs.layout import is_run_folder
from logs.load import load_recording
from logs.recording import CommandTiming, FloatArray, Recording
from logs.run import Run, Stop, read_run


def open_record(
    path: Path, *, mapping: str | None = None, units: str | None = None, command_timing: CommandTiming = "before"
) -> Run:
    """Raises: `BadInput` as `read_run` and `load_recording` do."""
    if is_run_folder(path) and not mapping and not units:
        return read_run(path)
    recording = load_recording(path, mapping=mapping, units=units, command_timing=command_timing)
    return run_of_recording(recording, path)


def run_of_recording(recording: Recording, path: Path) -> Run:
    """Arrays as a run with our column names, so that everything that takes a run takes a stranger's file too."""
    pressure, position = recording.pressure_unit, recording.position_unit
    named: dict[str, tuple[FloatArray | None, str]] = {
        "time_s": (recording.time_s, "s"),
        f"command_{pressure}": (recording.command, pressure),
        f"pressure_{pressure}": (recording.pressure, pressure),
        f"position_{position}": (recording.position, position),
        f"target_{position}": (recording.target, position),
    }
    columns = {name: values for name, (values, _) in named.items() if values is not None}
    return Run(
        path=path,
        start={"kind": "imported", "file": path.name},
        columns=columns,
        units={name: named[name][1] for name in columns},
        stop=Stop("success", "imported file", rows=recording.n),
        imported=recording,
    )
