"""What a further cause has to be worth: enough of the gap, or nearly all of the rest if it is the second."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.test_floor import findings_of
from twin.choose.decide import _fewer_unknowns, _worth, decide
from twin.choose.rules import DecisionRules
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Plant

NAMES = ("creep", "spring_asymmetry", "stiction")


def fitted(count: int, mse: float, bent: float = 0.0) -> Any:
    """A fit with so many causes; `bent`: squares of the design number's move, in deviations of its prior."""
    causes = [Cause(name, effect(name), effect(name).forms[0]) for name in NAMES[:count]]
    space = SimpleNamespace(causes=causes, numbers=("tau",), spreads=np.ones(1))
    return SimpleNamespace(mse=mse, space=space, z=np.array([np.sqrt(bent)]))


@pytest.mark.parametrize(
    ("count", "mse", "wanted"),
    [
        (2, (2.4, 1.05), True),  # a small second cause beside a large first one
        (3, (2.4, 1.05), False),  # a third one is the rest of a form that is not quite true
        (3, (6.0, 1.05), True),  # ... unless it is worth naming in itself
        (2, (2.4, 1.6), False),
    ],
)
def test_a_third_cause_has_to_explain_part_of_the_gap(count: int, mse: tuple[float, float], wanted: bool) -> None:
    small, large = fitted(count - 1, mse[0]), fitted(count, mse[1])
    findings: Any = SimpleNamespace(none=fitted(0, 101.0), score=lambda one: -100.0 * one.mse)
    assert _worth(findings, small, large, DecisionRules(), 1.0) is wanted


@pytest.mark.parametrize(("gap", "wanted"), [(4571.0, False), (2000.0, True), (400.0, True)])
def test_a_second_cause_is_no_trifle_beside_the_gap(gap: float, wanted: bool) -> None:
    """Behind a supply that is 8 psi low, its own form left 1.3 noise variances, which a port would have taken."""
    findings: Any = SimpleNamespace(none=fitted(0, gap), score=lambda one: -100.0 * one.mse)
    assert _worth(findings, fitted(1, 2.56), fitted(2, 1.26), DecisionRules(), 1.0) is wanted


@pytest.mark.parametrize(("gap", "wanted"), [(67_000.0, True), (300_000.0, False)])
def test_where_nothing_else_is_left_less_of_the_gap_is_a_trifle(gap: float, wanted: bool) -> None:
    """Behind a filter of five seconds a local friction moves the stem by five times the noise."""
    findings: Any = SimpleNamespace(none=fitted(0, gap), score=lambda one: -100.0 * one.mse)
    assert _worth(findings, fitted(1, 22.3), fitted(2, 0.91), DecisionRules(), 1.0) is wanted
    assert not _worth(findings, fitted(1, 22.3), fitted(2, 1.3), DecisionRules(), 1.0)  # a rest of the form, perhaps
    assert not _worth(findings, fitted(1, 9.0), fitted(2, 0.91), DecisionRules(), 1.0)


@pytest.mark.parametrize(
    ("mse", "first", "wanted"),
    [
        ((1.41, 0.97), False, True),  # four tenths more than the healthy machine leaves, and it takes them all
        ((1.25, 0.80), False, False),  # no more than some healthy machine leaves: its own misfit may be explained
        ((1.41, 1.16), False, False),  # the rest of a form that is not quite true
        ((1.41, 0.97), True, False),  # alone a cause has to explain more than the healthy machine's misfit
    ],
)
def test_a_second_cause_is_worth_what_the_first_leaves_beyond_a_healthy_machine(
    mse: tuple[float, float], first: bool, wanted: bool
) -> None:
    small, large = fitted(0 if first else 1, mse[0]), fitted(1 if first else 2, mse[1])
    none = small if first else fitted(0, 97.6)
    findings: Any = SimpleNamespace(none=none, score=lambda one: -100.0 * one.mse)
    assert _worth(findings, small, large, DecisionRules(gain=0.61, within=1.0), 1.0) is wanted


@pytest.mark.parametrize(("within", "left", "wanted"), [(1.0, 0.74, False), (1.0, 0.97, False), (0.0, 0.74, True)])
def test_leaving_less_than_the_healthy_machine_does_is_no_gain(within: float, left: float, wanted: bool) -> None:
    """A free curve beside a creep took of what any healthy valve of that kind leaves; the creep left 1.27 of it."""
    small, large = fitted(1, 1.27), fitted(2, left)
    findings: Any = SimpleNamespace(none=fitted(0, 106.0), score=lambda one: -100.0 * one.mse)
    assert _worth(findings, small, large, DecisionRules(gain=0.32, within=within), 1.0) is wanted


@pytest.mark.parametrize(
    ("bent", "left", "wanted"),
    [(0.0, 0.0, False), (800.0, 0.0, True), (800.0, 20.0, True), (800.0, 400.0, False)],
)
def test_a_second_cause_that_spares_numbers_nobody_believes_is_worth_it(bent: float, left: float, wanted: bool) -> None:
    """A lag of 4 s beside friction in motion, or a lag of 0.8 s with a time constant four times the design's."""
    small, large = fitted(1, 1.57, bent), fitted(2, 1.22, left)
    findings: Any = SimpleNamespace(none=fitted(0, 353.0), score=lambda one: -100.0 * one.mse)
    assert _worth(findings, small, large, DecisionRules(), 1.0) is wanted


def test_a_law_goes_before_a_free_curve_that_is_hardly_better() -> None:
    """A friction profile that is a straight line is an asymmetry of the spring."""

    def one(names: tuple[str, ...], unknowns: int, mse: float) -> Any:
        causes = [Cause(name, effect(name), effect(name).forms[0]) for name in names]
        return SimpleNamespace(names=names, mse=mse, space=SimpleNamespace(causes=causes, unknowns=[None] * unknowns))

    profile = one(("position_dependent_friction", "stale_samples"), 18, 0.989)
    line, poor = one(("spring_asymmetry", "stale_samples"), 6, 1.0), one(("creep", "stale_samples"), 7, 1.2)
    findings: Any = SimpleNamespace(none=fitted(0, 226.0), fits=(profile, line, poor), score=lambda f: -f.mse)
    assert _fewer_unknowns(findings, profile, DecisionRules()) is line
    assert _fewer_unknowns(findings, line, DecisionRules()) is line
    slight: Any = SimpleNamespace(none=fitted(0, 1.3), fits=(profile, line), score=lambda f: -f.mse)
    assert _fewer_unknowns(slight, profile, DecisionRules()) is profile


@pytest.mark.parametrize(
    ("first", "mse", "wanted"),
    [
        ("stiction", (53.6, 22.1), False),  # 60 % of what jumps leave is what any bystander finds
        ("stiction", (53.6, 11.0), True),
        ("stiction", (4.0, 1.95), True),  # next to the noise nothing is left to jumps
        ("creep", (53.6, 22.1), True),
    ],
)
def test_beside_jumps_that_no_model_follows_a_cause_has_to_explain_most(
    first: str, mse: tuple[float, float], wanted: bool
) -> None:
    def one(names: tuple[str, ...], left: float) -> Any:
        causes = [Cause(name, effect(name), effect(name).forms[0]) for name in names]
        return SimpleNamespace(mse=left, space=SimpleNamespace(causes=causes, numbers=(), spreads=()), z=np.zeros(0))

    findings: Any = SimpleNamespace(none=fitted(0, 60.0), score=lambda f: -100.0 * f.mse)
    small, large = one((first,), mse[0]), one((first, "spring_asymmetry"), mse[1])
    assert _worth(findings, small, large, DecisionRules(), 1.0) is wanted


def test_a_zero_error_and_a_drift_go_before_zeros_of_each_recordings_own() -> None:
    """... if with fewer unknowns they leave as little; and only what such zeros hide may come in."""

    def one(causes: dict[str, str], unknowns: int, mse: float) -> Any:
        some = [Cause(name, effect(name), effect(name).form(form)) for name, form in causes.items()]
        space = SimpleNamespace(causes=some, unknowns=[None] * unknowns)
        return SimpleNamespace(names=tuple(causes), mse=mse, space=space)

    def chosen(*others: Any) -> Any:
        findings: Any = SimpleNamespace(none=fitted(0, 626.0), fits=(zeros, *others), score=lambda f: -f.mse)
        return _fewer_unknowns(findings, zeros, DecisionRules())

    zeros = one({"lvdt_drift": "apart"}, 16, 0.988)
    laws = one({"lvdt_drift": "linear", "lvdt_calibration": "zero"}, 8, 0.989)
    assert chosen(laws) is laws
    assert chosen(one({"lvdt_drift": "linear", "lvdt_calibration": "zero"}, 8, 1.1)) is zeros
    assert chosen(one({"lvdt_drift": "linear", "creep": "one_tail"}, 9, 0.989)) is zeros
    assert chosen(one({"lvdt_drift": "linear", "lvdt_calibration": "zero"}, 12, 0.989)) is zeros


def test_an_asymmetry_and_a_spot_go_before_a_free_profile_of_the_friction() -> None:
    """... where the two laws are likelier; a law of the friction hides no asymmetry."""

    def one(causes: dict[str, str], unknowns: int, mse: float, score: float) -> Any:
        some = [Cause(name, effect(name), effect(name).form(form)) for name, form in causes.items()]
        space = SimpleNamespace(causes=some, unknowns=[None] * unknowns)
        return SimpleNamespace(names=tuple(causes), mse=mse, space=space, score=score)

    def chosen(curve: Any, score: float) -> bool:
        laws = one({"spring_asymmetry": "hinged_mid", "position_dependent_friction": "spot"}, 9, 0.957, score)
        findings: Any = SimpleNamespace(none=fitted(0, 315.0), fits=(curve, laws), score=lambda f: f.score)
        return _fewer_unknowns(findings, curve, DecisionRules()) is laws

    profile = one({"position_dependent_friction": "profile"}, 18, 0.921, -3104.0)
    assert chosen(profile, -3092.0)
    assert not chosen(profile, -3120.0)
    assert not chosen(one({"position_dependent_friction": "spot"}, 18, 0.921, -3104.0), -3092.0)


@pytest.mark.parametrize(
    ("deviations", "left", "accused", "explained"),
    [
        (6.0, 2.3, False, False),  # a deadband 6 % off, which nobody accuses, and more than the noise is left
        (6.0, 1.05, False, True),
        (4.0, 2.3, False, True),
        (6.0, 2.3, True, True),
    ],
)
def test_what_bends_the_numbers_far_and_leaves_something_imitates(
    deviations: float, left: float, accused: bool, explained: bool
) -> None:
    """A pilot that hunts shakes the stem: the deadband looks smaller, and a creep did the rest."""
    findings = findings_of({("creep",): (left, 1000.0)}, 68.0)
    causes = (*findings.fits[0].space.causes, *([Cause("parameter:deadband")] if accused else []))
    space = make_space(Plant(DesignModel()), causes, ("deadband",), Scales())
    z = np.full(len(space.unknowns), 0.5)
    z[0] = deviations * (0.01 * DesignModel().deadband / space.unknowns[0].unit)
    bent = replace(findings.fits[0], space=space, z=z, normal=1e9 * np.eye(z.size))
    scores: Any = SimpleNamespace(phi=1.0, score=lambda one: 1000.0 if one is bent else -1e6)
    assert decide(replace(findings, fits=(bent,), yardstick=scores), DecisionRules()).explained is explained
