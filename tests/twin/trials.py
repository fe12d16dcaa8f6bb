"""Trials made by the plant itself, for tests of the fit and the search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.fit.trial import Trial, make_trial
from twin.model.plant import Plant, pressure_response, reading_response, stem_response

DESIGN = DesignModel()
SIGMA = 5e-4


def staircase(seed: int = 1) -> FloatArray:
    """Levels of 25 s at 0.1 s, large and small, both ways."""
    rng = np.random.default_rng(seed)
    return np.repeat(rng.uniform(6.0, 11.5, 16), 250)


def trial_of(plant: Plant, command: FloatArray, seed: int = 2) -> tuple[Trial, FloatArray]:
    """What the plant would record, ready for the position channel, and its true reading."""
    time_s = np.arange(command.size) * 0.1
    blank = Recording("x", time_s, command, np.zeros(command.size), None)
    grid = make_trial(blank, 0.05).grid
    c = plant.coefficients(float(time_s[-1]))
    pressure = pressure_response(c, grid, command, float(command[0]))
    true = reading_response(c, grid, stem_response(c, grid, pressure, 0.0, 0.0), pressure)
    noisy = true + np.random.default_rng(seed).normal(0.0, SIGMA, true.size)
    recording = replace(blank, position=noisy, pressure=pressure[grid.offsets])
    return make_trial(recording, 0.05).with_pressure(pressure), true
