"""Friction behind a play that the stops hold: the stem rests short of its target, and of the stops, at any speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.judged import a_record, judged
from tests.twin.loops import PRESSURE, TIME_S, at_once, plant, row_by_row
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

D = DesignModel()
SHARE = 0.2
STEP_S = 0.001


def small_steps() -> FloatArray:
    """The law in steps of a millisecond: a narrower play inside the stops, Coulomb's friction on what it pulls."""
    half, friction = 0.5 * D.deadband, 0.5 * D.deadband * SHARE * D.compliance
    outer, middle, rows = half * (1.0 - SHARE), 0.5 * (D.a1 + D.a2), [0.0]
    w = x = 0.0
    every = round(0.1 / STEP_S)
    for k in range(1, (TIME_S.size - 1) * every + 1):
        pressure = float(np.interp(k * STEP_S, TIME_S, PRESSURE))
        w = max(D.compliance * (pressure - middle - outer), min(D.compliance * (pressure - middle + outer), w))
        w = min(max(w, 0.0), D.travel)
        pull = w - x
        left = pull - friction if pull > friction else pull + friction if pull < -friction else 0.0
        x += STEP_S * max(-D.rate_limit, min(D.rate_limit, left / D.tau_s))
        if k % every == 0:
            rows.append(x)
    return np.array(rows)


def test_it_is_the_law_in_small_steps_at_once_and_row_by_row() -> None:
    one = plant("before the lag", "friction_in_motion", "short_of_target", (SHARE,))
    law = small_steps()
    assert np.abs(at_once(one) - law).max() < 1e-4 * D.travel / 0.2
    assert np.abs(row_by_row(one) - law).max() < 1e-4 * D.travel / 0.2
    assert law.max() < D.travel - 0.9 * 0.5 * D.deadband * SHARE * D.compliance  # it is not pushed onto the stop


@pytest.mark.thorough
def test_friction_that_does_not_fall_with_the_speed_is_no_stiction() -> None:
    form = effect("friction_in_motion").form("short_of_target")
    record = a_record(Plant(D, (Inserted("friction_in_motion", form, (0.03,)),)))
    _, judgement = judged(replace(record, pressure=None))
    assert [c.name for c in judgement.causes] == ["friction_in_motion"]
    assert abs(judgement.causes[0].parameters["share"].value - 0.03) < 0.003
