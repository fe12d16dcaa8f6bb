"""Bent design numbers are held against causes that need them, not against a form that is not quite true."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.choose.decide import Decision
from twin.choose.unbent import unbent
from twin.fit.case import make_case
from twin.fit.channel import pressure_channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.findings import Findings
from twin.search.score import yardstick_for


def supply_of(form: str, *values: float) -> Inserted:
    return Inserted("supply_saturation", effect("supply_saturation").form(form), values)


def imitation(truth: Plant, cause: Cause) -> tuple[Decision, Scales]:
    """What a cause does for the pressure of a plant, with its lag re-tuned, as a decision that doubts it."""
    case = make_case([a_record(truth)], DesignModel(), ())
    channel = pressure_channel(case.trials, 0.008)
    none = fit(channel, make_space(case.base, (), (), case.scales), [np.zeros(0)])
    space = make_space(case.base, (cause,), ("ep_tau",), case.scales)
    found: Fit = fit(channel, space, starts_of(space, []), rounds=20)
    findings = Findings(channel, none, none, (found,), yardstick_for([none, found], channel.use))
    decision = Decision(findings, found, explained=False, gap=True, rest=0.0, imitates=True)
    return replace(decision, rest=decision.rest_of(found)), case.scales


@pytest.mark.parametrize(
    ("truth", "believed"),
    [
        # a supply that sinks and cuts off, seen as one that sinks and is aimed at
        (Plant(DesignModel(), (supply_of("sinking_cut_off", 9.5, 0.2, 20.0),)), True),
        # nothing but another lag, seen as anything
        (Plant(DesignModel(ep_tau_s=0.6)), False),
    ],
)
def test_a_cause_is_believed_that_does_without_the_bent_numbers(truth: Plant, believed: bool) -> None:
    sinking = Cause("supply_saturation", effect("supply_saturation"), effect("supply_saturation").form("sinking"))
    decision, scales = imitation(truth, sinking)
    assert decision.rest < 0.05  # with the lag bent both look explained
    assert abs(decision.accepted.z[0]) > 0.01
    after = unbent(decision, scales)
    assert after.explained is believed
    assert after.imitates is not believed
    assert after.accepted is decision.accepted


def test_what_seems_no_imitation_is_left_alone() -> None:
    sinking = Cause("supply_saturation", effect("supply_saturation"), effect("supply_saturation").form("sinking"))
    decision, scales = imitation(Plant(DesignModel(ep_tau_s=0.6)), sinking)
    plain = replace(decision, imitates=False)
    assert unbent(plain, scales) is plain
