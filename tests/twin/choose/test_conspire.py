"""A cause that imitates another only with design numbers off just so: a gain with a compliance, for a stop."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record, judged
from twin.choose.conspire import without_conspiracy
from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.choose.twins import settled
from twin.choose.weigh import Weights, conspiracy, weigh
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

#: The search that they share takes seconds.
pytestmark = pytest.mark.thorough
STOP, GAIN = "reduced_travel", "lvdt_calibration"


@cache
def stopped_short() -> Decision:
    short = Inserted(STOP, effect(STOP).form("upper_stop"), (0.008,))
    return judged(a_record(Plant(DesignModel(), (short,))))[0].decisions[-1]


def alone(decision: Decision, name: str) -> Fit:
    return next(f for f in decision.findings.fits if f.names == (name,))


def behind_by(nats: float) -> Decision:
    """The decision for the gain, which has the better evidence by so much."""
    decision = stopped_short()
    stop, gain = alone(decision, STOP), alone(decision, GAIN)
    lead = decision.findings.score(gain) - decision.findings.score(stop)
    worse = replace(stop, prior=stop.prior + 2.0 * (lead + nats))
    fits = tuple(worse if f is stop else f for f in decision.findings.fits)
    return replace(decision, accepted=gain, findings=replace(decision.findings, fits=fits))


def test_a_gain_needs_a_compliance_that_is_off_by_as_much() -> None:
    decision = stopped_short()
    stop, gain, phi = alone(decision, STOP), alone(decision, GAIN), decision.findings.phi
    assert 1.0 < conspiracy(gain, stop, phi) <= 3.0
    assert conspiracy(stop, gain, phi) == -conspiracy(gain, stop, phi)


@pytest.mark.parametrize(("nats", "named"), [(0.0, STOP), (8.0, STOP), (60.0, GAIN)])
def test_the_twin_that_leaves_the_numbers_alone_is_named_unless_the_record_says_more(nats: float, named: str) -> None:
    assert without_conspiracy(behind_by(nats), DecisionRules(), Weights()).names == (named,)


def test_a_settled_decision_has_no_cause_that_needs_such_a_coincidence() -> None:
    assert settled(behind_by(1.0), DecisionRules(), Weights()).names == (STOP,)


def test_a_twin_that_leaves_more_does_not_do_the_same() -> None:
    decision = behind_by(0.0)
    fits = tuple(replace(f, mse=f.mse + 0.06) if f.names == (STOP,) else f for f in decision.findings.fits)
    worse = replace(decision, findings=replace(decision.findings, fits=fits))
    assert without_conspiracy(worse, DecisionRules(), Weights()).names == (GAIN,)


def test_the_coincidence_counts_in_the_probability() -> None:
    found = weigh(without_conspiracy(behind_by(1.0), DecisionRules(), Weights()), Weights()).probability
    assert 0.03 < found[GAIN] < 0.3 < found[STOP]


def test_numbers_that_are_off_by_any_amount_are_worth_no_more_than_some_nats() -> None:
    decision = stopped_short()
    stop, phi = alone(decision, STOP), decision.findings.phi
    far, farther = (replace(stop, z=stop.z + shift) for shift in (5.0, 50.0))
    assert conspiracy(far, stop, phi) == 3.0
    assert abs(conspiracy(farther, far, phi)) == 3.0


def test_a_cause_is_tried_in_its_other_forms_before_its_twin() -> None:
    """A friction that grows along the stroke about its middle: hinged at an end it needs a deadband that is off."""
    name, twin = "spring_asymmetry", "position_dependent_friction"
    middle = Inserted(name, effect(name).form("hinged_mid"), (-0.012,))
    decision = judged(a_record(Plant(DesignModel(), (middle,))))[0].decisions[-1]
    findings, spaces = decision.findings, decision.accepted.space

    def in_form(cause: str, form: str) -> Fit:
        one = Cause(cause, effect(cause), effect(cause).form(form))
        space = make_space(spaces.base, (one,), spaces.numbers, spaces.scales)
        return fit(findings.channel, space, starts_of(space, []), rounds=8)

    end, profile = in_form(name, "hinged_open"), in_form(twin, "profile")
    lead = findings.score(end) - findings.score(profile)
    profile = replace(profile, prior=profile.prior - 2.0 * (lead - 5.0))
    told = replace(decision, accepted=end, findings=replace(findings, fits=(end, profile)), explained=True)
    assert conspiracy(end, profile, findings.phi) > 0.5
    found = without_conspiracy(told, DecisionRules(), Weights()).accepted
    assert [(c.name, c.form.name) for c in found.space.causes if c.form] == [(name, "hinged_mid")]


def test_a_free_curve_does_not_spare_the_numbers_in_the_place_of_a_law() -> None:
    """A coarse reading, in which the curve found some of the rounding: it had the better evidence, and was named."""
    name, twin = "spring_asymmetry", "position_dependent_friction"
    law = Inserted(name, effect(name).form("hinged_mid"), (-0.03,))
    decision = judged(a_record(Plant(DesignModel(compliance=0.189), (law,))))[0].decisions[-1]
    accepted = alone(decision, name)
    curve = Cause(twin, effect(twin), effect(twin).form("profile"))
    free = fit(
        decision.findings.channel,
        space := make_space(accepted.space.base, (curve,), accepted.space.numbers, accepted.space.scales),
        starts_of(space, []),
        rounds=8,
    )
    spared = replace(free, z=np.where(np.arange(free.z.size) < len(accepted.space.numbers), 0.0, free.z))
    lead = decision.findings.score(accepted) - decision.findings.score(spared)
    spared = replace(spared, mse=accepted.mse, prior=spared.prior - 2.0 * (lead + 50.0))
    told = replace(decision, accepted=accepted, explained=True)
    told = replace(told, findings=replace(decision.findings, fits=(accepted, spared)))
    assert conspiracy(accepted, spared, decision.findings.phi) > 0.0
    assert without_conspiracy(told, DecisionRules(), Weights()).names == (name,)
