"""A number that an effect has made its own is accused beside it, where it is another one by now."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.trials import SIGMA, staircase, trial_of
from twin.choose.decide import Decision
from twin.choose.lean import leaning
from twin.choose.rules import DecisionRules
from twin.fit.channel import position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.findings import Findings
from twin.search.score import yardstick_for

SPREAD = effect("distributed_hysteresis")
LAG = effect("additional_lag")


@pytest.mark.parametrize(("deadband_psi", "accused"), [(0.0, True), (1.4, True), (2.6, False)])
def test_a_spread_does_not_carry_a_deadband_that_the_design_has_not(deadband_psi: float, accused: bool) -> None:
    """Breakaways about a deadband of 2.96 psi, and designs with none, with half of it and with nearly all."""
    form = SPREAD.form("uniform")
    trial, _ = trial_of(Plant(DesignModel(), (Inserted(SPREAD.name, form, (0.4,)),)), staircase())
    channel = position_channel([trial], SIGMA)
    base = Plant(DesignModel(a1=7.3 + 0.5 * deadband_psi, a2=7.3 - 0.5 * deadband_psi))
    none = fit(channel, make_space(base, (), (), Scales()), [np.zeros(0)])
    space = make_space(base, (Cause(SPREAD.name, SPREAD, form),), channel.numbers, Scales())
    found = fit(channel, space, starts_of(space), rounds=20)
    assert found.mse < 1.2
    assert found.plant.design.deadband == pytest.approx(2.96, abs=0.05)
    findings = Findings(channel, none, none, (found,), yardstick_for([none, found], channel.use))
    after = leaning(Decision(findings, found, explained=True, gap=True, rest=0.0), Scales(), DecisionRules())
    assert after.names == (SPREAD.name, *(("parameter:deadband",) if accused else ()))
    assert after.accepted.mse < 1.2


@pytest.mark.parametrize(("tau_s", "lag_s", "accused"), [(2.5, 0.03, True), (2.5, 0.15, False), (2.69, 0.03, False)])
def test_a_small_second_lag_does_not_carry_a_first_one_that_is_wrong(tau_s: float, lag_s: float, accused: bool) -> None:
    form = LAG.form("after_play")
    trial, _ = trial_of(Plant(DesignModel(tau_s=tau_s), (Inserted(LAG.name, form, (lag_s,)),)), staircase())
    channel = position_channel([trial], SIGMA)
    none = fit(channel, make_space(Plant(DesignModel()), (), (), Scales()), [np.zeros(0)])
    space = make_space(Plant(DesignModel()), (Cause(LAG.name, LAG, form),), channel.numbers, Scales())
    found = fit(channel, space, starts_of(space), rounds=20)
    assert found.mse < 1.2
    findings = Findings(channel, none, none, (found,), yardstick_for([none, found], channel.use))
    after = leaning(Decision(findings, found, explained=True, gap=True, rest=0.0), Scales(), DecisionRules())
    assert after.names == (LAG.name, *(("parameter:tau",) if accused else ()))
