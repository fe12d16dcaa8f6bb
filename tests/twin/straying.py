"""Valves whose pressure gauge is noisy, or strays, or whose pressure does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import a_record
from twin.model.plant import Plant
from twin.replay.simulate import simulate_recording

HEALTHY = Plant(DesignModel())
READING_IN = 1.5e-4


def slow(n: int, seed: int, rows: float = 12.0) -> FloatArray:
    """Unrest of unit deviation, made of bells of so many rows: within some five seconds unless told otherwise."""
    wave = gaussian_filter1d(np.random.default_rng(seed).normal(0.0, 1.0, n), rows)
    return np.asarray(wave / wave.std())


def read(record: Recording, gauge_psi: float) -> Recording:
    """What a valve reads whose pressure gauge is so noisy; `record` is without noise."""
    dice = np.random.default_rng(4)
    assert record.pressure is not None
    pressure = record.pressure + dice.normal(0.0, gauge_psi, record.n)
    return replace(record, pressure=pressure, position=record.position + dice.normal(0.0, READING_IN, record.n))


def straying(gauge_psi: float = 0.0, air_psi: float = 0.0, rows: float = 12.0, plant: Plant = HEALTHY) -> Recording:
    """A valve whose pressure gauge strays slowly, or whose pressure really does."""
    record = a_record(plant)
    command = record.command + air_psi * slow(record.n, 7, rows)
    pressure, position = simulate_recording(plant, replace(record, command=command))
    strays = pressure + gauge_psi * slow(record.n, 7, rows)
    return replace(read(replace(record, pressure=strays, position=position), 0.004), command=record.command)
