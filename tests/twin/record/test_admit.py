"""Which records carry a diagnosis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from hal.errors import BadInput
from logs.recording import FloatArray, Recording
from tests.control.toy_valve import Toy, random_steps, record
from twin.model.plant import Plant
from twin.noise.model import estimate_noise
from twin.record.admit import admit
from twin.replay.simulate import simulate_recording

TIME_S = np.arange(0.0, 300.0, 0.1)
NOISE = 4e-4 * np.random.default_rng(1).standard_normal(TIME_S.size)
LEVEL = np.full(TIME_S.size, 10.0)


def admitted(position: FloatArray, command: FloatArray = LEVEL) -> None:
    records = [Recording("r", TIME_S, command, position + NOISE)]
    admit(records, Plant(DesignModel()), estimate_noise(records))


@pytest.mark.parametrize(
    ("period_s", "design"),
    [(100.0, DesignModel()), (31.0, DesignModel(ep_tau_s=0.0, tau_s=0.02, rate_limit=100.0))],
)
def test_rows_further_apart_than_anything_the_valve_does_are_refused(period_s: float, design: DesignModel) -> None:
    command = np.where(np.arange(TIME_S.size) // 50 % 2, 12.0, 4.0)
    records = [Recording("r", 10.0 * period_s * TIME_S, command, 0.05 * (command - 4.0) + NOISE)]
    said = rf"^r: a row every {period_s:g} s shows nothing .*at most [\d.]+ s: check the unit .*--units time=ms"
    with pytest.raises(BadInput, match=said):
        admit(records, Plant(design), estimate_noise(records))


@pytest.mark.parametrize(
    ("period_s", "design"),
    [
        (10.0, DesignModel(ep_tau_s=1.0, tau_s=5.0, rate_limit=100.0)),  # a plant's log
        (30.0, DesignModel(ep_tau_s=0.0, tau_s=0.0, rate_limit=100.0)),
        (60.0, DesignModel()),
    ],
)
def test_a_slow_log_of_a_valve_is_not_refused(period_s: float, design: DesignModel) -> None:
    time_s, command = period_s * np.arange(600.0), np.where(np.arange(600) // 50 % 2, 12.0, 4.0)
    records = [Recording("r", time_s, command, 0.05 * (command - 4.0) + NOISE[:600])]
    admit(records, Plant(design), estimate_noise(records))


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


def test_rows_so_far_apart_that_motion_looks_like_noise_are_not_called_a_stuck_stem() -> None:
    """Every row is another level of a staircase, and settled there: the noise that shows is the motion."""
    command = np.random.default_rng(2).uniform(3.0, 15.0, 60)
    blank = Recording("r", 12.0 * np.arange(60), command, NOISE[:60])
    records = [replace(blank, position=simulate_recording(Plant(DesignModel()), blank)[1] + NOISE[:60])]
    with pytest.raises(BadInput, match=r"^r: .* goes with the command, .* from row to row \(every 12 s\)"):
        admit(records, Plant(DesignModel()), estimate_noise(records))
    stuck = [Recording("r", 12.0 * np.arange(60), command, 0.3 + NOISE[:60])]
    with pytest.raises(BadInput, match="stem is stuck"):
        admit(stuck, Plant(DesignModel()), estimate_noise(stuck))


def test_positions_from_another_zero_are_told_how_to_take_it_off() -> None:
    r = record(Toy(), np.arange(0.0, 200.0, 0.2), random_steps(200.0, 0.2))
    far = replace(r, position=r.position + 3.0, meta={"written": {"command": "bar", "position": "mm"}})
    with pytest.raises(BadInput, match=r"take that off, as in --units 'position=mm\(76.1\d..90.4\d?=0..14.29 mm\)'"):
        admit([far], Plant(DesignModel()), estimate_noise([far]))
