"""What is put beside the causes of a diagnosis, and which noise is its floor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.diagnosis import Cause
from twin.fit.case import Case, make_case
from twin.judge.assemble import _causes, _floor
from twin.judge.gap import GapParts
from twin.judge.repeatable import Disturbance
from twin.judge.verdict import Judgement
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

NAMED = Judgement("effects", (Cause("creep", "actuator", 0.9), Cause("parameter:tau", "actuator", 0.9)), (), ())


def parts(after: float) -> GapParts:
    nothing = np.full(8, np.nan)
    return GapParts(nothing, nothing, np.full(8, after), {"creep": 2.5}, {})


@pytest.fixture(scope="module")
def case() -> Case:
    return make_case([a_record(Plant(DesignModel()))], DesignModel())


def test_causes_say_their_form_and_what_is_left_without_them() -> None:
    creep = Inserted("creep", effect("creep").form("two_tails"), tuple([0.1] * 4))
    first, second = _causes(NAMED, parts(1.0), Plant(DesignModel(), (creep,)))
    assert (first.form, first.heldout_gap_without) == ("two_tails", 2.5)
    assert (second.form, second.heldout_gap_without) == ("", None)


def test_a_model_that_predicts_better_than_repeats_agree_lowers_the_floor_to_the_resting_noise(case: Case) -> None:
    drifting = replace(case.noise.position, by_source={"repeats": 0.003, "still": 0.001})
    loud = replace(case, sigma_y=0.003, noise=replace(case.noise, position=drifting))
    assert [_floor(loud, parts(after), NAMED, None) for after in (0.01, 0.002, 0.0005)] == [0.003, 0.002, 0.001]


def test_what_should_repeat_and_does_not_is_no_floor(case: Case) -> None:
    nothing = Judgement("unexplained", (), (), ())
    for signal, wanted in (("position", 0.001), ("pressure", case.sigma_y)):
        assert _floor(case, parts(0.01), nothing, Disturbance(signal, 0.02, 0.001, "in")) == wanted
    assert _floor(case, parts(0.01), nothing, None) == case.sigma_y
