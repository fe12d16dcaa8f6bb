"""Which records carry a diagnosis."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from hal.errors import BadInput
from logs.recording import FloatArray, Recording
from twin.admit import admit
from twin.noise.model import estimate_noise
from twin.plant import Plant

TIME_S = np.arange(0.0, 300.0, 0.1)
NOISE = 4e-4 * np.random.default_rng(1).standard_normal(TIME_S.size)
LEVEL = np.full(TIME_S.size, 10.0)


def admitted(position: FloatArray, command: FloatArray = LEVEL) -> None:
    records = [Recording("r", TIME_S, command, position + NOISE)]
    admit(records, Plant(DesignModel()), estimate_noise(records))


@pytest.mark.parametrize("period_s", [30.0, 250.0])
def test_a_stem_that_comes_and_goes_without_a_command_is_refused(period_s: float) -> None:
    swung = 0.28 + 0.2 * np.sin(2.0 * np.pi * TIME_S / period_s)
    with pytest.raises(BadInput, match=r"to and fro over (69|7.) % of travel.*check the column"):
        admitted(swung)
    admitted(swung, 8.0 + 2.0 * np.sin(2.0 * np.pi * TIME_S / period_s))  # the command moves too


def test_a_drift_a_settling_a_quick_swing_and_false_readings_at_a_constant_command_are_no_such_thing() -> None:
    settling = 0.23 * (1.0 - np.exp(-TIME_S / 2.7))
    admitted(settling)
    admitted(settling + 1e-4 * TIME_S)
    admitted(0.23 + 0.05 * np.sin(2.0 * np.pi * TIME_S))
    admitted(np.where(np.arange(TIME_S.size) % 97 == 5, 0.0, settling))
