"""A display that does not flicker: it moves on when the position has left its step by something."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import UP_TO_TWO, a_record
from twin.diagnose import diagnose
from twin.model.plant import Plant
from twin.noise.lattice import lattice_step

STEP_IN = 0.02


def shown(position: FloatArray, keeps: float) -> FloatArray:
    """What a display shows that `keeps` its code until the position has left its step by so much of it."""
    codes, at = np.empty(position.size), np.round(position[0] / STEP_IN)
    for k, x in enumerate(position / STEP_IN):
        if abs(x - at) > 0.5 + keeps:
            at = np.round(x - np.sign(x - at) * keeps)
        codes[k] = at
    return STEP_IN * codes


def displayed(keeps: float, first: float = 0.0) -> Recording:
    """A healthy valve behind such a display; `first`: how far off its steps it begins [in]."""
    record = a_record(Plant(DesignModel()), n=3000)
    position = shown(record.position, keeps)
    stays = np.argmax(position != position[0])
    position[:stays] += first
    return replace(record, position=position)


def test_what_it_was_switched_on_with_is_no_step_of_it() -> None:
    for first in (0.17, 0.995, 1.006):  # and it may be so near to a step that both are seen
        assert lattice_step(displayed(0.15, first * STEP_IN).position) == pytest.approx(STEP_IN, rel=1e-3)


def test_several_levels_off_the_steps_are_a_finer_step() -> None:
    """Every fifth code is half a step off: that is no stranger any more."""
    codes = np.arange(40.0) + 0.5 * (np.arange(40) % 5 == 2)
    step = lattice_step(np.repeat(STEP_IN * codes, 5))
    assert step is None or step == pytest.approx(0.5 * STEP_IN, rel=1e-3)


@pytest.mark.thorough
@pytest.mark.parametrize("keeps", [0.0, 0.24])
def test_a_display_that_does_not_flicker_is_coarse_and_has_no_play(keeps: float) -> None:
    found = diagnose([displayed(keeps)], DesignModel(), (), UP_TO_TWO).diagnosis
    assert [c.name for c in found.causes] == ["sensor_quantization"]
    assert found.causes[0].parameters["step"].value == pytest.approx(STEP_IN, rel=0.01)
