"""Wrong design numbers that are not all that is wrong: what they clearly leave is somebody else's."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import a_record, judged
from tests.twin.test_floor import findings_of
from twin.choose.decide import Decision, _said, _worth, decide, with_numbers
from twin.choose.outside import inside
from twin.choose.rules import DecisionRules
from twin.diagnosis import Cause as Named
from twin.fit.fitting import Fit
from twin.fit.space import Cause, make_space
from twin.judge import verdict
from twin.judge.remainder import leaves_too_much
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.noise.model import estimate_noise
from twin.record.sensing import Sensing, sense
from twin.search.findings import Findings

D = DesignModel()
NUMBERS = ("offset", "compliance", "tau")


def caused(name: str, form: str = "") -> Cause:
    return Cause(name, effect(name), effect(name).form(form)) if form else Cause(name)


def a_fit(mse: float, *causes: Cause, moved: dict[str, float] | None = None) -> Fit:
    space = make_space(Plant(D), causes, NUMBERS, Scales())
    z = np.zeros(len(space.unknowns))
    for name, share in (moved or {}).items():
        z[space.numbers.index(name)] = share
    return Fit(space, z, mse, 0.0, np.zeros(1), np.zeros((1, 1)), 1)


def found(none: float, *fits: tuple[Fit, float]) -> Any:
    """Findings of these fits with their scores."""
    scores = {id(one): score for one, score in fits}
    return SimpleNamespace(none=a_fit(none), fits=tuple(f for f, _ in fits), score=lambda f: scores.get(id(f), -1e9))


def real(none: float, *fits: tuple[Fit, float]) -> Findings:
    """The same, to be decided upon."""
    scores: Any = SimpleNamespace(phi=1.0, score=found(none, *fits).score)
    return replace(findings_of({("creep",): (1.0, 0.0)}, none), fits=tuple(f for f, _ in fits), yardstick=scores)


COMPLIANCE, LAG = caused("parameter:compliance"), caused("sensor_lag", "first_order")


@pytest.mark.parametrize(
    ("small", "left", "wanted"),
    [
        (COMPLIANCE, 2.6, True),
        (COMPLIANCE, 1.3, False),  # as much as some healthy machines leave
        (caused("nonlinear_spring", "bow"), 2.6, False),  # another form of it may leave less
    ],
)
def test_what_a_number_clearly_leaves_is_worth_a_cause_however_large_the_gap(
    small: Cause, left: float, wanted: bool
) -> None:
    one, both = a_fit(left, small), a_fit(1.0, small, LAG)
    findings = found(10_000.0, (one, -500.0), (both, 0.0))
    assert _worth(findings, one, both, DecisionRules(), 1.0) is wanted


@pytest.mark.parametrize(("form", "wanted"), [("own_clock", True), ("periodic", False)])
def test_behind_a_clock_of_its_own_nobody_knows_what_the_healthy_machine_leaves(form: str, wanted: bool) -> None:
    """A filter behind readings that are held, 1000 nats ahead, leaves less than repeats of the held ones differ by."""
    stale = caused("stale_samples", form)
    one, both = a_fit(0.72, stale), a_fit(0.4, stale, LAG)
    findings = found(164.0, (one, -1000.0), (both, 0.0))
    assert _worth(findings, one, both, DecisionRules(within=1.0), 1.0) is wanted


def test_a_number_that_a_creep_moves_without_a_word_is_said_where_the_evidence_is_for_it() -> None:
    creep = a_fit(0.97, caused("creep", "pull_tails_apart"), moved={"tau": -0.13})
    gain = a_fit(0.965, caused("lvdt_calibration", "gain"), caused("parameter:tau"), moved={"tau": -0.13})
    other = a_fit(0.965, caused("lvdt_calibration", "gain"), caused("parameter:offset"), moved={"offset": -0.13})
    for rival, ahead, wanted in ((gain, 30.0, gain), (gain, 5.0, creep), (other, 30.0, creep)):
        findings = found(98.0, (creep, 0.0), (rival, ahead))
        assert _said(findings, creep, DecisionRules()) is wanted
    worse = replace(gain, mse=1.2)
    assert _said(found(98.0, (creep, 0.0), (worse, 30.0)), creep, DecisionRules()) is creep
    sure = [replace(f, normal=1e9 * np.eye(f.z.size), z=f.z + 1e-3) for f in (creep, gain)]
    assert decide(real(98.0, (sure[0], 0.0), (sure[1], 30.0)), DecisionRules()).names == gain.names


def test_a_number_is_accused_from_less_where_nobody_believes_what_all_of_them_moved() -> None:
    motion = caused("friction_in_motion", "full")
    alone, both = (a_fit(1.14, motion, *some, moved={"offset": -0.08}) for some in ((), (caused("parameter:offset"),)))
    findings = found(7e4, (alone, 0.0), (both, 27.0))
    assert with_numbers(findings, alone, 12.0) is alone
    for left, within, names in ((1.14, 0.0, both.names), (1.05, 1.0, alone.names)):
        # where nothing is left beyond what a healthy machine leaves, the numbers are what that one bends
        one, two = (replace(f, mse=left, normal=1e9 * np.eye(f.z.size)) for f in (alone, both))
        decision = decide(real(7e4, (one, 0.0), (two, 27.0)), DecisionRules(within=within))
        assert decision.accepted.names == names
        assert decision.explained


@pytest.mark.parametrize(
    ("name", "after", "exact", "wanted"),
    [
        ("parameter:compliance", 1.3, False, False),
        ("parameter:compliance", 4.3, False, True),
        ("parameter:compliance", 4.3, True, False),  # where all of a record is explained it is the held-out block
        ("sensor_lag", 4.3, False, False),
    ],
)
def test_numbers_alone_leave_hardly_more_than_the_noise(name: str, after: float, exact: bool, wanted: bool) -> None:
    assert leaves_too_much(42.0, after, 1.0, [Named(name, "actuator", 0.9, None, {})], False, exact) is wanted


@pytest.mark.parametrize(("left", "dropped"), [(2.0, True), (17.0, False)])
def test_a_rival_from_outside_stays_where_numbers_alone_fall_short(left: float, dropped: bool) -> None:
    number = a_fit(left, COMPLIANCE)
    both = a_fit(1.2, COMPLIANCE, caused("lvdt_drift", "jump"))
    findings = found(1739.0, (number, -1000.0), (both, 0.0))
    assert (inside(Decision(findings, both, True, True, 0.0), DecisionRules()).names == number.names) is dropped


def test_readings_that_are_held_together_are_seen_to_be() -> None:
    record = a_record(Plant(D))
    at = np.arange(record.n) // 5 * 5
    assert record.pressure is not None
    held = Recording("valve", record.time_s, record.command, record.position[at], record.pressure[at])
    for one, together in ((held, True), (replace(held, pressure=record.pressure), False)):
        sensing = sense([one], estimate_noise([one]), D)
        assert "stale_samples" in sensing.accepted
        assert sensing.together is together


@pytest.mark.thorough
def test_a_small_lag_beside_a_compliance_that_is_far_off_is_named() -> None:
    plant = Plant(replace(D, compliance=0.7 * D.compliance), (Inserted("sensor_lag", LAG.form, (0.05,)),))
    result, _ = judged(a_record(plant))
    assert "parameter:compliance" in result.causes
    assert len(result.causes) == 2
    assert set(result.causes) & {"sensor_lag", "additional_lag"}


@pytest.mark.parametrize("together", [True, False])
def test_a_pressure_that_is_held_with_the_position_needs_no_other_cause(
    monkeypatch: pytest.MonkeyPatch, together: bool
) -> None:
    """When each of its readings was true is known to a row at best, which is many times the noise of a fine gauge."""
    monkeypatch.setattr(verdict, "_comes_back", lambda _decision: True)
    monkeypatch.setattr(verdict, "_minor", lambda *_of: False)
    channel = SimpleNamespace(name="pressure", half=0.0, sigma=1.0)
    findings = SimpleNamespace(channel=channel, none=a_fit(15.7))
    result: Any = SimpleNamespace(decisions=[SimpleNamespace(gap=True, explained=False, findings=findings)])
    sensing = Sensing((), {"stale_samples": {}}, 0.0, together=together)
    assert verdict._unexplained(result, 0.0, sensing) is not together
