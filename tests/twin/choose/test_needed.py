"""Numbers on which an effect leans, causes that are less likely than not, and causes that unseen data do not need."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record, judged
from twin.choose.decide import Decision
from twin.choose.lean import _Leaning, leaning
from twin.choose.plainer import instead_of, plainer
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult
from twin.choose.trim import dropped, trimmed
from twin.choose.weigh import Weights, weigh
from twin.diagnosis import Cause as Named
from twin.fit.fitting import Fit
from twin.fit.space import Cause, Space, make_space
from twin.judge.gap import GapParts, idle_cause
from twin.judge.verdict import Judgement
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.candidates import effect_causes


def with_lag(design: DesignModel, lag_s: float = 0.3) -> Plant:
    return Plant(design, (Inserted("sensor_lag", effect("sensor_lag").form("first_order"), (lag_s,)),))


@cache
def slipped(slip: float) -> tuple[StageResult, Judgement]:
    return judged(a_record(with_lag(DesignModel(compliance=0.19 * (1.0 + slip)), 0.1)))


@pytest.mark.thorough
@pytest.mark.parametrize(("slip", "accused"), [(0.015, True), (0.0, False)])
def test_a_number_that_slipped_a_little_and_matters_much_is_accused(slip: float, accused: bool) -> None:
    design = DesignModel(compliance=0.19 * (1.0 + slip))
    result, judgement = slipped(slip)
    assert ("parameter:compliance" in {c.name for c in judgement.causes}) is accused
    assert len(judgement.causes) == 1 + accused
    compliance = result.plant().design.compliance
    assert compliance == pytest.approx(design.compliance, rel=1e-3)


def lag_alone() -> tuple[Decision, Scales]:
    """What is decided of the slipped compliance before anybody asks on what the lag leans."""
    result, _ = slipped(0.015)
    before = result.decisions[-1]
    lag = next(f for f in before.findings.fits if f.names == ("sensor_lag",))
    return replace(before, accepted=lag), result.case.scales


@pytest.mark.thorough
def test_a_number_that_nobody_is_sure_of_is_not_accused() -> None:
    decision, scales = lag_alone()
    assert leaning(decision, scales, DecisionRules()).names == ("sensor_lag", "parameter:compliance")
    assert leaning(decision, replace(scales, doubt=0.2), DecisionRules()) is decision


@pytest.mark.thorough
def test_a_cause_as_likely_that_leans_on_no_number_is_preferred(monkeypatch: pytest.MonkeyPatch) -> None:
    decision, scales = lag_alone()
    other = next(c for c in effect_causes(decision.findings.channel) if c.name not in {"sensor_lag", "additional_lag"})
    upright = replace(decision.accepted, space=replace(decision.accepted.space, causes=(other,)))

    def needed(self: _Leaning) -> Cause | None:
        return None if self.decision.accepted.names == upright.names else Cause("parameter:compliance")

    monkeypatch.setattr(_Leaning, "needed", needed)
    for mse, wanted in ((upright.mse, other.name), (upright.mse + 1.0, "sensor_lag")):
        beside = replace(decision.findings, fits=(*decision.findings.fits, replace(upright, mse=mse)))
        assert leaning(replace(decision, findings=beside), scales, DecisionRules()).names[0] == wanted


@pytest.fixture(scope="module")
def position() -> tuple[StageResult, Decision]:
    """A valve with a lag and with the wrong rate limit, and what its position says."""
    result, _ = judged(a_record(with_lag(DesignModel(rate_limit=0.1))))
    decision = result.decisions[-1]
    assert len(decision.names) == 2
    return result, decision


@pytest.mark.thorough
def test_a_sure_cause_is_kept_and_one_with_many_rivals_is_left_out(position: tuple[StageResult, Decision]) -> None:
    _, decision = position
    rules, weights = DecisionRules(), Weights()
    assert trimmed(decision, rules, weights) is decision
    # with a temperature at which every pair is as likely as any other, neither is known
    unsure, lenient = Weights(temperature=1e9), replace(rules, unexplained=1.1)
    assert len(trimmed(decision, lenient, unsure).names) == 1
    assert (
        trimmed(decision, replace(rules, unexplained=0.0, nothing_left=0.0), unsure) is decision
    )  # nothing else explains it


@pytest.mark.thorough
def test_dropping_the_only_cause_leaves_the_design(position: tuple[StageResult, Decision]) -> None:
    _, decision = position
    one = dropped(decision, decision.names[0])
    assert one is not None and one.names == decision.names[1:]
    none = dropped(one, one.names[0])
    assert none is not None and none.names == () and not none.gap and none.rest == pytest.approx(1.0)


def errors(level: float) -> np.ndarray:
    return np.full(8, level)


@pytest.mark.thorough
def test_a_cause_behind_the_pressure_that_unseen_data_do_not_need(position: tuple[StageResult, Decision]) -> None:
    result, decision = position
    first, second = decision.names
    judgement = Judgement("effects", tuple(Named(name, "sensor", 0.9, None, {}) for name in decision.names), (), ())
    for left, healthy, idle in ((1.01, 0.0, second), (1.5, 0.0, None), (1.1, 1.15, second), (1.1, 1.05, None)):
        parts = GapParts(errors(3.0), errors(2.0), errors(0.01), {first: 1.5, second: left}, {})
        assert idle_cause(parts, judgement, result, 1.0, healthy) == idle
    alone = replace(judgement, causes=judgement.causes[1:])
    parts = GapParts(errors(3.0), errors(2.0), errors(0.01), {second: 0.9}, {})
    assert idle_cause(parts, alone, result, 1.0) is None


@pytest.mark.thorough
def test_a_number_that_adds_less_than_any_further_cause_would_have_to_is_left_out() -> None:
    result, _ = judged(a_record(Plant(DesignModel(rate_limit=0.1))))
    findings, rules = result.decisions[-1].findings, DecisionRules()
    alone = [f for f in findings.fits if f.names and all(n.startswith("parameter:") for n in f.names)]
    two = next(f for f in alone if set(f.names) == {"parameter:rate_limit", "parameter:tau"})
    close = replace(two, mse=two.mse - 0.5 * rules.gain)
    found = plainer(replace(findings, fits=(*findings.fits, close)), close, rules)
    assert found.names == ("parameter:rate_limit",)


@pytest.mark.thorough
@pytest.mark.parametrize(("prior", "plain"), [(0.0, False), (1e3, True)])
def test_several_numbers_are_no_plainer_than_an_effect_with_the_better_evidence(prior: float, plain: bool) -> None:
    findings, rules = slipped(0.015)[0].decisions[-1].findings, DecisionRules()
    two = next(f for f in findings.fits if len(f.names) == 2 and all(n.startswith("parameter:") for n in f.names))
    lag = replace(two.space, causes=effect_causes(findings.channel)[:1])
    effect_of_the_same_error = replace(two, space=lag, prior=prior, z=np.zeros_like(two.z))
    found = plainer(replace(findings, fits=(two, effect_of_the_same_error)), effect_of_the_same_error, rules)
    assert (found is two) is plain


@pytest.mark.thorough
def test_an_effect_that_spares_the_numbers_nothing_and_explains_no_more_is_no_cause() -> None:
    findings, rules = slipped(0.015)[0].decisions[-1].findings, DecisionRules()
    two = next(f for f in findings.fits if len(f.names) == 2 and all(n.startswith("parameter:") for n in f.names))
    lag = effect_causes(findings.channel)[0]
    space = make_space(findings.retuned.space.base, (lag,), findings.retuned.space.numbers, Scales())
    room = np.zeros(len(space.unknowns) - len(space.numbers))
    idle = _sure(replace(findings.retuned, space=space, z=np.concatenate([findings.retuned.z, room]), mse=two.mse))
    better = replace(findings, fits=(replace(two, prior=1e3), idle))  # by the evidence alone the effect would win
    assert plainer(better, idle, rules).names == two.names
    works = replace(idle, mse=two.mse - 1.0)
    assert plainer(replace(better, fits=(better.fits[0], works)), works, rules) is works
    one = next(f for f in findings.fits if len(f.names) == 1 and f.names[0] == two.names[0])
    assert instead_of(better, idle, one, rules).names == two.names  # one of them is not enough: both get their chance
    assert instead_of(replace(better, fits=(better.fits[0], works)), works, one, rules) is works


@pytest.mark.thorough
def test_an_effect_that_spares_the_numbers_takes_the_place_of_an_idle_one() -> None:
    """A gain of an unmeasured pressure moves three numbers at once; another effect only brings them along."""
    findings, rules = slipped(0.015)[0].decisions[-1].findings, DecisionRules()
    two = next(f for f in findings.fits if len(f.names) == 2 and all(n.startswith("parameter:") for n in f.names))
    lag, other = (c for c in effect_causes(findings.channel) if (c.name, c.form and c.form.name) in LAG_AND_GAIN)
    idle, sparing = (
        replace(findings.retuned, space=space, z=np.concatenate([share * findings.retuned.z, np.ones(1)]), mse=two.mse)
        for space, share in ((_with(findings.retuned, lag), 1.0), (_with(findings.retuned, other), 0.0))
    )
    idle, sparing = _sure(idle), _sure(sparing)
    better = replace(findings, fits=(replace(two, prior=1e3), idle, sparing))
    assert plainer(better, idle, rules) is sparing
    for worse in (replace(sparing, prior=1e6), replace(sparing, mse=two.mse + 1.0), replace(sparing, z=idle.z)):
        assert plainer(replace(better, fits=(*better.fits[:2], worse)), idle, rules).names == two.names


LAG_AND_GAIN = {("additional_lag", "behind_stem"), ("lvdt_calibration", "gain")}


def _with(fit: Fit, cause: Cause) -> Space:
    """The space of an effect of one number beside the numbers of `fit`."""
    return make_space(fit.space.base, (cause,), fit.space.numbers, Scales())


def _sure(fit: Fit) -> Fit:
    """With all of its unknowns known well."""
    return replace(fit, normal=1e9 * np.eye(fit.z.size))


def test_where_one_number_is_wrong_a_further_one_is_ten_times_as_rare() -> None:
    findings = slipped(0.015)[0].decisions[-1].findings
    two = next(f for f in findings.fits if len(f.names) == 2 and all(n.startswith("parameter:") for n in f.names))
    one = replace(two, space=replace(two.space, causes=two.space.causes[:1]))
    assert findings.score(one) - findings.score(two) == pytest.approx(np.log(10.0))


@pytest.mark.thorough
@pytest.mark.parametrize("rate", [0.0, 5e-5])
def test_what_drifts_between_repeats_is_found_beside_a_cause_that_does_not(rate: float) -> None:
    play = Inserted("linkage_lost_motion", effect("linkage_lost_motion").form("play"), (0.008,))
    wear = Inserted("friction_drift", effect("friction_drift").form("linear"), (rate,))
    record = a_record(Plant(DesignModel(), (play, wear) if rate else (play,)), twice=True)
    _, judgement = judged(record)
    assert {c.name for c in judgement.causes} == {"linkage_lost_motion"} | ({"friction_drift"} if rate else set())


def test_an_idle_effect_is_no_rival_of_a_wrong_number() -> None:
    """A rate limit that is hardly ever reached: any effect with its number moved part of the way does as well."""
    decision = slipped(0.015)[0].decisions[-1]
    findings = decision.findings
    number = next(f for f in findings.fits if f.names == ("parameter:compliance",))
    lag = effect_causes(findings.channel)[0]
    space = make_space(findings.retuned.space.base, (lag,), findings.retuned.space.numbers, Scales())
    room = np.full(len(space.unknowns) - len(space.numbers), 0.5)
    at = findings.retuned.space.numbers.index("compliance")
    far = replace(number, z=number.z * 4.0, mse=findings.retuned.mse)
    rival = replace(
        findings.retuned, space=space, z=np.concatenate([findings.retuned.z, room]), normal=1e9 * np.eye(room.size + 5)
    )
    assert abs(rival.z[at]) < 0.5 * abs(far.z[0])  # it does not lean on the number as far as the accusation goes
    accepted = replace(decision, findings=replace(findings, fits=(far, rival)), accepted=far)
    assert rival.names[0] not in weigh(accepted, Weights()).probability
    busy = replace(accepted, findings=replace(findings, fits=(far, replace(rival, mse=rival.mse - 1.0))))
    assert rival.names[0] in weigh(busy, Weights()).probability


def test_an_idle_effect_is_no_rival_of_one_that_spares_the_numbers() -> None:
    decision = slipped(0.015)[0].decisions[-1]
    retuned = decision.findings.retuned
    lag, other = (
        c for c in effect_causes(decision.findings.channel) if (c.name, c.form and c.form.name) in LAG_AND_GAIN
    )
    idle, sparing = (
        _sure(replace(retuned, space=_with(retuned, cause), z=np.concatenate([share * retuned.z, np.ones(1)])))
        for cause, share in ((lag, 1.0), (other, 0.0))
    )
    for rival, there in ((idle, False), (_sure(replace(idle, mse=idle.mse - 1.0)), True)):
        alone = replace(decision.findings, fits=(sparing, rival))
        weighed = weigh(replace(decision, findings=alone, accepted=sparing), Weights())
        assert (rival.names[0] in weighed.probability) is there
