"""Open-loop records of the virtual valve, and what the design model says to the same commands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from control.design import DesignModel
from control.identify_model import lagged, make_grid, stem
from logs.recording import FloatArray, Recording
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record

PERIOD_S = 0.1


def levels(values: Sequence[float], hold_s: float) -> FloatArray:
    """Commands that stay at every value for `hold_s`, one per tick."""
    return np.repeat(np.asarray(values, dtype=np.float64), round(hold_s / PERIOD_S))


def play(commands: FloatArray, physics: str = "thesis", seed: int = 1, **options: object) -> Recording:
    """The record of a fresh virtual valve that gets these commands (psi, or percent for the positioner)."""
    time_s = PERIOD_S * np.arange(commands.size, dtype=np.float64)
    pressure, position = record(make_physics(physics, seed, **options), time_s, commands)
    return Recording(name=physics, time_s=time_s, command=commands, position=position, pressure=pressure)


def simulated(recording: Recording, design: DesignModel) -> FloatArray:
    """The design model's stem for the commands of a record, from rest at the first reading [in]."""
    grid = make_grid(recording.time_s)
    d = design
    pressure = lagged(grid, recording.command, d.ep_tau_s, float(recording.command[0]))
    numbers = np.array([d.a1, d.a2, d.compliance, d.compliance, d.tau_s, d.rate_limit, d.travel])
    x0 = float(np.clip(recording.position[0], 0.0, d.travel))
    return stem(grid, pressure, numbers, x0, x0)[0]


def fit_percent(measured: FloatArray, model: FloatArray) -> float:
    """100 (1 - |measured - model| / |measured - mean|), the usual fit figure [%]."""
    spread = float(np.linalg.norm(measured - measured.mean()))
    return 100.0 * (1.0 - float(np.linalg.norm(measured - model)) / spread)


def settled(recording: Recording, hold_s: float) -> tuple[FloatArray, FloatArray]:
    """Command and mean position of the last quarter of every hold."""
    n = round(hold_s / PERIOD_S)
    rows = recording.position[: recording.n // n * n].reshape(-1, n)
    return recording.command[: rows.size].reshape(-1, n)[:, -1], np.asarray(rows[:, -n // 4 :].mean(axis=1))


def options(effects: Mapping[str, float] | None = None, **numbers: float) -> dict[str, object]:
    """Plant options as the catalog takes them."""
    return {"effects": dict(effects or {}), **numbers}
