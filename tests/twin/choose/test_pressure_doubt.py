"""How far the true model may miss the position as nobody knows the driving pressure: not for its readings' noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.choose.rules import DecisionRules
from twin.choose.stages import drive_by_measured, judge, pressure_doubt
from twin.fit.case import make_case
from twin.fit.channel import position_channel
from twin.model.plant import Plant
from twin.search.search_rules import SearchRules


def doubt(wander_psi: float) -> float:
    """Of a healthy valve under a pressure that wanders slowly, read with a noise of 0.04 psi."""
    record = a_record(Plant(DesignModel()))
    assert record.pressure is not None
    dice = np.random.default_rng(3)
    slow = gaussian_filter1d(dice.normal(size=record.n), 8.0)
    read = record.pressure + wander_psi * slow / slow.std() + dice.normal(0.0, 0.04, record.n)
    case = make_case([replace(record, pressure=read)], DesignModel())
    converter = judge(case, SearchRules(most=1), DecisionRules(), lambda _w, _s: None).decisions[0]
    return pressure_doubt(case, position_channel(drive_by_measured(case, converter), case.sigma_y), converter)


@pytest.mark.thorough
def test_noise_of_the_readings_leaves_little_doubt_and_a_pressure_that_wanders_leaves_it() -> None:
    quiet, wandering = doubt(0.0), doubt(0.02)
    assert quiet < 2.0
    assert wandering > 8.0
