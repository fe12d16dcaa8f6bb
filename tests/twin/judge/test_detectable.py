"""The smallest size that a record would have shown: in proportion, with a threshold, per cause, and in windows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import twin.judge.detectable
from control.design import DesignModel
from tests.twin.judged import a_record, judged
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult
from twin.diagnose import Settings, diagnose
from twin.diagnosis import EffectTest
from twin.fit.case import make_case
from twin.fit.channel import chain_channel
from twin.fit.numbers import reference
from twin.judge.detectable import Detector, _nuisance, detection_limits, smallest_shown, unseen_in_windows
from twin.judge.tolerance import TOLERANCE
from twin.model.catalog import effect, effects
from twin.model.plant import Inserted, Plant
from twin.record.sensing import smallest_seen
from twin.search.search_rules import SearchRules


@pytest.fixture(scope="module")
def healthy() -> StageResult:
    return judged(a_record(Plant(DesignModel())))[0]


@given(st.floats(0.5, 3.9), st.floats(-3.0, -0.1))
def test_a_power_law_is_followed_to_where_it_suffices(order: float, place: float) -> None:
    there = 10.0**place
    found = smallest_shown(lambda size: (size / there) ** order, 0.01, 1.0)
    assert 0.8 <= (found / there) ** order <= 1.3


def test_a_threshold_is_found_and_never_undercut() -> None:
    found = smallest_shown(lambda size: 0.0 if size < 0.3 else 50.0 * size, 0.01, 1.0)
    assert 0.3 <= found <= 1.0
    assert smallest_shown(lambda size: 0.5 * size, 0.01, 1.0) > 1.0
    assert smallest_shown(lambda size: 0.0, 0.01, 1.0) == float("inf")


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["dead_time", "lvdt_nonlinearity", "sensor_lag", "stiction", "spring_asymmetry"])
def test_what_is_larger_than_the_limit_is_noticed_and_what_is_smaller_is_not(healthy: StageResult, name: str) -> None:
    case = healthy.case
    channels = [d.findings.channel for d in healthy.decisions]
    tests = detection_limits(channels, case.base, case.scales, [effect(name)], DecisionRules())
    [test] = [t for t in tests if t.name == name]
    form = effect(name).form(test.form)
    assert test.detection_limit is not None
    for times, noticed in ((0.4, False), (3.0, True)):
        sizes = {p.name: p.neutral if p.size else p.starts[0] for p in form.parameters}
        sizes[test.parameter] = times * test.detection_limit
        record = a_record(Plant(DesignModel(), (Inserted(name, form, tuple(sizes.values())),)))
        found = diagnose([record], DesignModel(), settings=Settings(search=SearchRules(most=1))).diagnosis
        assert bool(found.causes) is noticed


def test_every_cause_has_a_line(healthy: StageResult) -> None:
    case = healthy.case
    channels = [d.findings.channel for d in healthy.decisions]
    tests = detection_limits(channels, case.base, case.scales, tuple(effects().values()), DecisionRules())
    tests = (*tests, *smallest_seen(case.noise, case.scales, case.travel))
    numbers = {f"parameter:{n}" for n in ("compliance", "deadband", "offset", "tau", "rate_limit", "ep_tau")}
    assert {t.name for t in tests} == set(effects()) | numbers
    supply = next(t for t in tests if t.name == "supply_saturation")
    assert supply.detection_limit is None or 4.0 < supply.detection_limit < 20.0  # a pressure, not a distance


def test_what_retuning_would_hide_shows_nothing_and_a_number_does_not_hide_itself(healthy: StageResult) -> None:
    case, channel = healthy.case, healthy.decisions[-1].findings.channel
    nuisance = np.linalg.qr(_nuisance(channel, case.base, case.scales))[0]
    detector = Detector(channel, case.base, case.scales, nuisance, channel.residuals(case.base), 1.0)
    slower = Plant(replace(case.base.design, tau_s=1.001 * case.base.design.tau_s))
    assert detector.shown(slower, nuisance) < 1e-2 * detector.shown(slower, nuisance[:, :0])
    tests = detection_limits([channel], case.base, case.scales, [], DecisionRules())
    [tau] = [t for t in tests if t.name == "parameter:tau"]
    assert tau.detection_limit is not None and tau.detection_limit < 0.01 * case.base.design.tau_s


def test_within_its_tolerance_a_number_has_to_show_clearly(
    healthy: StageResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    case, channel = healthy.case, healthy.decisions[-1].findings.channel

    def limits() -> dict[str, float]:
        tests = detection_limits([channel], case.base, case.scales, [], DecisionRules())
        return {t.name: t.detection_limit or np.inf for t in tests}

    asked = limits()
    monkeypatch.setattr(twin.judge.detectable, "TOLERANCE", 0.0)
    plain = limits()
    tolerated = {n: TOLERANCE * reference(case.base.design, n.removeprefix("parameter:")) for n in asked}
    assert any(plain[n] < asked[n] <= tolerated[n] * (1.0 + 1e-9) for n in asked)
    assert all(asked[n] == plain[n] for n in asked if plain[n] > tolerated[n])


def test_a_rate_limit_that_was_never_met_shows_when_it_is_lower() -> None:
    design = replace(DesignModel(), rate_limit=0.25)  # a stroke's lag alone is slower
    case = make_case([replace(a_record(Plant(design)), pressure=None)], design)
    channel = chain_channel(case.trials, case.sigma_y)
    tests = detection_limits([channel], case.base, case.scales, [], DecisionRules())
    [test] = [t for t in tests if t.name == "parameter:rate_limit"]
    assert test.detection_limit is not None
    lower, higher = (replace(design, rate_limit=0.25 + side * test.detection_limit) for side in (-1.0, 1.0))
    plain = channel.residuals(case.base)
    assert np.ptp(channel.residuals(Plant(lower)) - plain) > 1.0
    assert np.ptp(channel.residuals(Plant(higher)) - plain) < 1e-6


def test_a_form_that_acts_without_any_size_promises_nothing(healthy: StageResult) -> None:
    """Stops that are met at speed make a difference as soon as there is any friction, however little."""
    case, channel = healthy.case, healthy.decisions[-1].findings.channel
    tests = detection_limits([channel], case.base, case.scales, [effect("friction_in_motion")], DecisionRules())
    [test] = [t for t in tests if t.name == "friction_in_motion"]
    assert test.detection_limit is None or 1e-4 < test.detection_limit < 1.0


def test_more_recordings_than_an_effect_has_numbers_for() -> None:
    """A zero that each recording has apart is known for ten of them."""
    short = [replace(a_record(Plant(DesignModel()), seed=k, n=200), pressure=None, name=f"run{k}") for k in range(12)]
    case = make_case(short, DesignModel())
    channel = chain_channel(case.trials, case.sigma_y)
    tests = detection_limits([channel], case.base, case.scales, [effect("lvdt_drift")], DecisionRules())
    assert "lvdt_drift" in {t.name for t in tests}


def test_a_rate_limit_less_than_half_of_the_design_shows() -> None:
    fast = replace(DesignModel(), rate_limit=0.45)  # nothing here is faster than 0.2 in/s
    case = make_case([replace(a_record(Plant(fast)), pressure=None)], fast)
    channel = chain_channel(case.trials, case.sigma_y)
    tests = detection_limits([channel], case.base, case.scales, [], DecisionRules())
    [test] = [t for t in tests if t.name == "parameter:rate_limit"]
    assert test.detection_limit is not None and 0.5 < test.detection_limit / fast.rate_limit <= 0.8


def test_what_is_slow_is_not_promised_from_windows(healthy: StageResult) -> None:
    channel, case = healthy.decisions[-1].findings.channel, healthy.case
    tests = (EffectTest("lvdt_drift", True, "", "rate", 1e-6, "in/s"), EffectTest("creep", True, "", "share", 0.01))
    assert unseen_in_windows(tests, channel, case) == tests
    longer = [replace(r, time_s=np.linspace(0.0, 100.0 * r.duration_s, r.n)) for r in case.recordings]
    drift, creep = unseen_in_windows(tests, channel, replace(case, recordings=tuple(longer)))
    assert not drift.testable and creep.testable
