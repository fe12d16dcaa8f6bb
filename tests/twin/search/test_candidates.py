"""What stands trial beside what a record's own oddities have put into the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.fit.channel import Channel, position_channel
from twin.fit.space import Scales, make_space
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.search.candidates import effect_causes

DOWN_IN = -0.01


@pytest.fixture(scope="module")
def channel() -> Channel:
    return position_channel([trial_of(Plant(DESIGN), staircase())[0]], SIGMA)


def base(name: str, form: str, *values: float) -> Plant:
    return Plant(DesignModel(), (Inserted(name, effect(name).form(form), values),))


def test_a_gauge_that_rounds_down_may_be_off_besides(channel: Channel) -> None:
    rounds = base("lvdt_calibration", "zero", DOWN_IN)
    causes = {c.form.name: c for c in effect_causes(channel, rounds) if c.name == "lvdt_calibration" and c.form}
    assert set(causes) == {"zero", "gain_and_zero", "picks_up"}  # not the one that would take the zero away
    space = make_space(rounds, (causes["gain_and_zero"],), (), Scales())
    [one] = space.plant(np.zeros(2)).inserted
    assert one.values == pytest.approx((0.0, DOWN_IN))  # no change is no cause


def test_what_else_was_put_in_for_the_records_sake_is_settled(channel: Channel) -> None:
    late = base("sensor_lag", "first_order", 0.1)
    assert not [c for c in effect_causes(channel, late) if c.name == "sensor_lag"]


def test_what_happens_once_is_no_candidate_for_several_recordings(channel: Channel) -> None:
    several = replace(channel, trials=(*channel.trials, *channel.trials))
    for looked_at, there in ((channel, True), (several, False)):
        forms = {c.form.name for c in effect_causes(looked_at) if c.name == "lvdt_drift" and c.form is not None}
        assert ("wander" in forms) is there and "linear" in forms
