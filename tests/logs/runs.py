"""Runs for the tests: a small valve of its own, so that records have the shape of real ones without any bench."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from logs.recording import FloatArray
from logs.writer import RunWriter

UNITS = {
    "time_s": "s",
    "command_psi": "psi",
    "pressure_psi": "psi",
    "position_in": "in",
    "target_in": "in",
    "next_command_psi": "psi",
    "lateness_s": "s",
    "latency_s": "s",
    "quality": "",
    "sequence": "",
    "step": "",
}
DESIGN = {"a1": 8.78, "a2": 5.82, "compliance": 0.19, "travel": 0.5625, "tau_s": 2.7}


def valve_columns(rows: int = 2000, period_s: float = 0.1, seed: int = 1) -> dict[str, FloatArray]:
    """A staircase up and down through play and two lags, with noise; no claim to be the thesis's valve."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(rows) * period_s
    half = rows // 2
    stairs = np.floor(np.concatenate((np.linspace(0, 12, half), np.linspace(12, 0, rows - half))))
    command = 3.0 + stairs
    pressure, position = np.empty(rows), np.empty(rows)
    p, w, x = 3.0, 0.0, 0.0
    for k, u in enumerate(command):
        p += (u - p) * (1 - np.exp(-period_s / 0.3))
        w = float(np.clip(max(0.19 * (p - 8.78), min(0.19 * (p - 5.82), w)), 0.0, 0.5625))
        x += (w - x) * (1 - np.exp(-period_s / 2.7))
        pressure[k], position[k] = p, x
    return {
        "time_s": time_s,
        "command_psi": command,
        "pressure_psi": pressure + 0.01 * rng.standard_normal(rows),
        "position_in": position + 0.0005 * rng.standard_normal(rows),
        "lateness_s": np.abs(2e-4 * rng.standard_normal(rows)),
        "latency_s": 4e-3 + np.abs(2e-4 * rng.standard_normal(rows)),
        "quality": np.zeros(rows),
        "sequence": np.arange(rows) % 65536 * 1.0,
        "step": stairs,
    }


def write_run(
    folder: Path, columns: Mapping[str, FloatArray], *, units: Mapping[str, str] | None = None, close: bool = True
) -> RunWriter:
    """A run with those columns on disk; finished unless `close` is False."""
    known = units or {name: UNITS[name] for name in columns}
    start = {"kind": "staircase", "seed": 1, "design": DESIGN, "bench": {"name": "test valve", "travel_in": 0.5625}}
    writer = RunWriter.create(folder, start, known)
    rows = next(iter(columns.values())).size
    writer.state(0.0, "running")
    for k in range(rows):
        writer.append({name: float(values[k]) for name, values in columns.items()})
    writer.event(float(columns["time_s"][rows // 2]), "info", "turning point")
    writer.note(float(columns["time_s"][rows // 3]), "supply at 60 psi")
    if close:
        writer.close("success", "finished")
    return writer
