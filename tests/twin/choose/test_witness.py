"""The stem as a second witness of the pressure: what strays is the gauge, or the form of a converter's cause."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO, a_record
from tests.twin.straying import read, slow, straying
from twin.choose.decide import Decision, decide
from twin.choose.form_by_stem import formed_by_stem
from twin.choose.rules import DecisionRules
from twin.choose.stages import driven_about, judge
from twin.choose.trim import spoken
from twin.choose.weigh import Weights
from twin.choose.witness import driven_by_model, gauge_lies, gauge_wanders, left_of_position, missed_of_position
from twin.diagnose import diagnose
from twin.fit.case import Case, make_case
from twin.fit.channel import position_channel, pressure_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.smooth import BELIEVING, CAREFUL
from twin.fit.space import Cause, make_space
from twin.judge.verdict import strays
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import simulate_recording
from twin.search.findings import Findings
from twin.search.score import make_yardstick
from twin.search.search_rules import SLIGHT, SearchRules

DESIGN = DesignModel()
GAUGE_PSI = 0.03
HIGH = Inserted("ep_calibration", effect("ep_calibration").form("gain_and_zero"), (0.0, 0.5))
PLAY = Inserted("ep_deadband", effect("ep_deadband").form("play"), (0.018,))


def left_of(case: Case) -> tuple[float, float, float]:
    """What is left of the position by what stands out of the reading, by the model, and by all that was read."""
    careful, all_of_it = (driven_about(case.base, case, care) for care in (CAREFUL, BELIEVING))
    driven = (careful, driven_by_model(case.base, case.trials), all_of_it)
    read, modelled, believing = (left_of_position(case, trials) for trials in driven)
    return read, modelled, believing


@pytest.mark.parametrize(("where", "gauge"), [({"gauge_psi": 0.02}, True), ({"air_psi": 0.02}, False), ({}, False)])
def test_what_the_stem_does_not_follow_is_the_gauge(where: dict[str, float], gauge: bool) -> None:
    read, modelled, _ = left_of(make_case([straying(**where)], DESIGN))
    assert gauge_wanders(read, modelled) is gauge


@pytest.mark.parametrize(("where", "gauge"), [({"gauge_psi": 0.006}, True), ({"air_psi": 0.006}, False), ({}, False)])
def test_a_slow_noise_that_the_stem_denies_raises_no_floor(where: dict[str, float], gauge: bool) -> None:
    """What stands out of the noise says little; all of the reading moves a stem that the real one does not follow."""
    read, modelled, believing = left_of(make_case([straying(**where, rows=1.5)], DESIGN))
    assert not gauge_wanders(read, modelled)
    assert gauge_wanders(read, modelled, believing) is gauge


@pytest.mark.thorough
def test_a_search_asks_the_stem_about_all_of_the_reading() -> None:
    case = make_case([straying(gauge_psi=0.006, rows=1.5)], DESIGN)
    result = judge(case, SearchRules(most=1), DecisionRules(), lambda _what, _share: None)
    assert result.astray
    assert result.denied == ()
    assert result.decisions[-1].floor == 1.0


@pytest.mark.thorough
@pytest.mark.parametrize(("gauge_psi", "verdict"), [(0.008, "no_gap"), (0.04, "unexplained")])
def test_a_straying_gauge_is_no_gap_of_the_stem_and_is_said(gauge_psi: float, verdict: str) -> None:
    found = diagnose([straying(gauge_psi=gauge_psi)], DESIGN, (), UP_TO_TWO).diagnosis
    assert found.verdict == verdict
    assert any("the stem does not follow" in note.what for note in found.data_quality)
    assert ("the pressure gauge itself strayed" in found.statement) is (verdict == "unexplained")


@pytest.mark.thorough
def test_a_gauge_that_is_only_noisy_is_not_said_to_stray() -> None:
    found = diagnose([read(a_record(Plant(DESIGN)), 0.03)], DESIGN, (), UP_TO_TWO).diagnosis
    assert found.verdict == "no_gap"
    begins, noisy = (note.what for note in found.data_quality)
    assert begins.startswith("1 of 1 recordings begin in a state")
    assert noisy == "the pressure reading is noisier than what moved the stem"


LATE = Inserted("dead_time", effect("dead_time").form("pure_delay"), (0.3,))


def off(gauge: bool, what: Inserted) -> Recording:
    """A valve whose pressure gauge does what only its converter could do, or whose converter does it."""
    record = a_record(Plant(DESIGN))
    pressure, position = simulate_recording(Plant(DESIGN, (what,)), record)
    if gauge:
        _, position = simulate_recording(Plant(DESIGN), record)
    return read(replace(record, pressure=pressure, position=position), 0.01)


def late(gauge: bool) -> Recording:
    """A valve whose pressure gauge is late, or whose converter is."""
    return off(gauge, LATE)


def left_with_and_without(record: Recording) -> tuple[float, float]:
    """What is left of the position by a converter with the dead time that its gauge shows, and without."""
    case = make_case([record], DESIGN)
    with_it, without = (driven_by_model(Plant(DESIGN, i), case.trials) for i in ((LATE,), ()))
    return left_of_position(case, with_it), left_of_position(case, without)


@pytest.mark.parametrize("gauge", [True, False])
def test_a_cause_that_the_reading_has_and_the_stem_has_not_is_the_gauges(gauge: bool) -> None:
    with_it, without = left_with_and_without(late(gauge))
    assert gauge_lies(with_it, without) is gauge
    assert not gauge_lies(without, without)  # as good by what was found: nothing to deny


def test_the_stem_denies_nothing_where_something_is_wrong_behind_the_pressure() -> None:
    record = late(gauge=True)
    with_it, without = left_with_and_without(replace(record, position=record.position + 0.004 * slow(record.n, 3)))
    assert without > SLIGHT
    assert not gauge_lies(with_it, without)
    assert not gauge_lies(100.0, 1.01 * SLIGHT)  # however much more the reading leaves
    assert gauge_lies(100.0, 0.99 * SLIGHT)


def high(gauge: bool) -> Recording:
    """A valve whose pressure gauge reads 0.5 psi too much, or whose converter gives so much more."""
    return off(gauge, HIGH)


@pytest.mark.parametrize("gauge", [True, False])
def test_what_a_gauge_reads_too_high_shows_with_the_numbers_as_they_are(gauge: bool) -> None:
    """Re-tuned, the offset of the valve takes it over."""
    case = make_case([high(gauge)], DESIGN)
    with_it, without = (driven_by_model(Plant(DESIGN, i), case.trials) for i in ((HIGH,), ()))
    assert gauge_lies(missed_of_position(case, with_it), missed_of_position(case, without)) is gauge
    assert not gauge_lies(left_of_position(case, with_it), left_of_position(case, without))


@pytest.mark.thorough
@pytest.mark.parametrize(("gauge", "denied"), [(True, ("ep_calibration",)), (False, ())])
def test_a_gauge_that_reads_too_high_is_no_fault_of_the_converter(gauge: bool, denied: tuple[str, ...]) -> None:
    result = judge(make_case([high(gauge)], DESIGN), SearchRules(most=1), DecisionRules(), lambda _what, _share: None)
    assert result.denied == denied
    assert bool(result.causes) is not gauge


@pytest.mark.thorough
def test_a_late_gauge_is_judged_by_the_stem() -> None:
    case = make_case([late(gauge=True)], DESIGN)
    result = judge(case, SearchRules(most=1), DecisionRules(), lambda _what, _share: None)
    assert result.astray
    assert result.denied == ("dead_time",)
    assert result.causes == ()
    assert strays(result)


@pytest.mark.thorough
def test_a_late_gauge_is_said_in_words() -> None:
    found = diagnose([late(gauge=True)], DESIGN, (), UP_TO_TWO).diagnosis
    assert (found.verdict, found.causes) == ("unexplained", ())
    assert "the pressure reading that is off" in found.statement
    assert "the pressure gauge itself does what dead_time would" in found.statement
    assert any("by itself it would be dead_time" in note.what for note in found.data_quality)


@cache
def converter(form: str) -> tuple[Case, Decision]:
    """What a noisy gauge says of a converter with a play, held to be so `form`ed; it turns round in its band."""
    record = a_record(Plant(DESIGN), n=3000)
    waves = 9.0 + 2.5 * np.sin(record.time_s / 7.0) + 1.2 * np.sin(record.time_s / 3.1)
    record = replace(record, command=np.where(record.time_s < 40.0, waves[200], waves))
    pressure, position = simulate_recording(Plant(DESIGN, (PLAY,)), record)
    case = make_case([read(replace(record, pressure=pressure, position=position), GAUGE_PSI)], DESIGN)
    assert case.sigma_p is not None
    channel = pressure_channel(case.trials, case.sigma_p)
    cause = Cause("ep_deadband", effect("ep_deadband"), effect("ep_deadband").form(form))
    space = make_space(case.base, (cause,), channel.numbers, case.scales)
    found = fit(channel, space, starts_of(space), refine=2)
    none = fit(channel, make_space(case.base, (), (), case.scales), [np.zeros(0)])
    findings = Findings(channel, none, none, (found,), make_yardstick(found.residuals, channel.use))
    return case, decide(findings, DecisionRules(evidence=0.0, gain=0.0, share=0.0))


@pytest.mark.parametrize("form", ["overlap", "play"])
def test_the_form_is_the_one_that_the_stem_followed(form: str) -> None:
    case, decision = converter(form)
    assert decision.names == ("ep_deadband",)
    formed = formed_by_stem(case, decision, DecisionRules())
    [cause] = formed.accepted.space.causes
    assert cause.form is not None
    assert cause.form.name == "play"
    assert formed.names == decision.names
    assert formed.accepted in formed.findings.fits


def silent(decision: Decision) -> Decision:
    return replace(decision, accepted=decision.findings.none, explained=False)


def position_of(case: Case) -> Decision:
    """A position that is explained without any cause."""
    channel = position_channel(driven_about(case.base, case), case.sigma_y)
    none = fit(channel, make_space(case.base, (), (), case.scales), [np.zeros(0)])
    findings = Findings(channel, none, none, (), make_yardstick(none.residuals, channel.use))
    return silent(decide(findings, DecisionRules()))


def test_what_a_noisy_gauge_hardly_shows_is_named_where_it_moves_the_stem() -> None:
    """The pressure alone would pass for healthy; the stem is off by several times the noise of its reading."""
    case, decision = converter("play")
    assert decision.findings.none.mse < SLIGHT
    behind = position_of(case)
    assert spoken([decision, behind], Weights(), seen=True)[0].names == ("ep_deadband",)
    blunt = replace(behind.findings, channel=replace(behind.findings.channel, sigma=0.02))
    assert spoken([decision, replace(behind, findings=blunt)], Weights(), seen=True)[0].names == ()


@pytest.mark.thorough
def test_a_diagnosis_asks_the_stem_for_the_form(monkeypatch) -> None:
    """What the pressure alone would have is not what drives the valve."""
    asked = []

    def by_stem(case: Case, found: Decision, rules: DecisionRules) -> Decision:
        asked.append(found.names)
        return replace(formed_by_stem(case, found, rules), accepted=found.findings.none, explained=False)

    monkeypatch.setattr("twin.choose.stages.formed_by_stem", by_stem)
    case, _ = converter("play")
    result = judge(case, SearchRules(most=1), DecisionRules(), lambda _what, _share: None)
    assert asked == [("ep_deadband",)]
    assert result.decisions[0].names == ()
