"""Slips by their teeth: counted where there are some, and stiction named by them where no path can be followed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.toy_valve import TRAVEL, Toy, record
from twin.choose.decide import Decision
from twin.choose.stages import StageResult, driven_about
from twin.diagnose import diagnose
from twin.events.teeth import Teeth, Valve, fixed_in_place, pushes, teeth, turns
from twin.fit.case import Case, make_case
from twin.fit.channel import position_channel
from twin.fit.fitting import evaluated
from twin.fit.space import make_space
from twin.judge.by_teeth import by_slips, slipping, slips_note
from twin.noise.model import estimate_noise
from twin.search.candidates import effect_causes
from twin.search.findings import Findings
from twin.search.score import yardstick_for

FloatArray = npt.NDArray[np.float64]
DT, SIGMA = 0.1, 7e-4
RAMPS = np.concatenate([np.linspace(a, b, 800) for a, b in ((5, 12.5), (12.5, 5), (5, 11), (11, 7), (7, 12), (12, 5))])
VALVE = Valve(0.19, 2.7, 2.96, SIGMA, 0.006)


class Random(Toy):
    """A toy that sticks anew after every slip, each time as firmly as chance says."""

    def __init__(self, breakaway: float, spread: float, seed: int) -> None:
        super().__init__(breakaway=breakaway)
        object.__setattr__(
            self, "sticks", breakaway * (1.0 + spread * np.random.default_rng(seed).standard_normal(9999))
        )

    def position(self, pressure: FloatArray, dt: float) -> FloatArray:
        out, k = np.empty_like(pressure), iter(self.sticks)  # type: ignore[attr-defined]
        w = x = 0.0
        reach = self.compliance * next(k)
        for i, p in enumerate(pressure):
            low, high = self.compliance * (p - self.a1), self.compliance * (p - self.a2)
            if low - w > reach or w - high > reach:
                w = min(max(low, min(high, w), 0.0), TRAVEL)
                reach = self.compliance * max(next(k), 0.05)
            x += min(max((w - x) / self.tau_s, -self.rate), self.rate) * dt
            out[i] = x
        return out


def detent(pressure: FloatArray, dt: float) -> FloatArray:
    """Where a stem is that rests at every twentieth of an inch, whichever way it goes."""
    toy, out = Toy(), np.empty_like(pressure)
    w = held = x = 0.0
    for i, p in enumerate(pressure):
        w = min(max(toy.compliance * (p - toy.a1), min(toy.compliance * (p - toy.a2), w), 0.0), TRAVEL)
        held = round(w / 0.05) * 0.05 if abs(w - held) > 0.03 else held
        x += min(max((held - x) / toy.tau_s, -toy.rate), toy.rate) * dt
        out[i] = x
    return out


def seen(recording: Recording) -> Teeth:
    assert recording.pressure is not None
    return teeth(pushes(recording.time_s, recording.pressure, VALVE), recording.position)


def detented(seed: int) -> Recording:
    even = record(Toy(), RAMPS, DT, seed, 0.0, 0.006)
    noise = SIGMA * np.random.default_rng(seed).standard_normal(RAMPS.size)
    return replace(even, position=detent(Toy().pressure(RAMPS, DT), DT) + noise)


def judged(*recordings: Recording) -> tuple[Case, Decision]:
    """A decision of a search that has found nothing."""
    case = make_case(recordings, DesignModel(), (), None, estimate_noise(recordings))
    channel = position_channel(driven_about(case.base, case), case.sigma_y)
    none = evaluated(channel, make_space(case.base, (), (), case.scales), np.zeros(0))
    findings = Findings(channel, none, none, (), yardstick_for([none], channel.use))
    return case, Decision(findings, none, False, True, 1.0)


@given(arrays(np.float64, st.integers(2, 60), elements=st.floats(-10, 10)), st.floats(0.01, 5))
def test_turns_go_up_and_down_by_more_than_the_least(values: FloatArray, least: float) -> None:
    rows = turns(values, least)
    steps = np.diff(values[rows])
    assert np.all(np.abs(steps) > least)
    assert np.all(steps[1:] * steps[:-1] < 0)
    assert bool(rows) == (np.ptp(values) > least)
    assert turns(-values, least) == rows


@pytest.mark.parametrize("breakaway", [0.3, 0.6])
def test_teeth_of_a_stem_that_sticks_are_counted(breakaway: float) -> None:
    found = seen(record(Random(breakaway, 0.0, 0), RAMPS, DT, 1, SIGMA, 0.006))
    moved = 2 * (TRAVEL / 0.19 + (11 - 8.78) / 2 + 1.7)  # psi, roughly
    assert found.count == pytest.approx(moved / breakaway, rel=0.5)
    assert 0.4 * breakaway < found.typical < breakaway  # a bell takes the tips off


@pytest.mark.parametrize("toy", [Toy(), Toy(a1=9.3), Toy(tau_s=1.5), Toy(compliance=0.15)])
def test_what_slides_has_no_teeth(toy: Toy) -> None:
    assert seen(record(toy, RAMPS, DT, 2, SIGMA, 0.006)).count <= 6


def test_places_that_hold_the_stem_both_ways_are_no_friction() -> None:
    found = seen(detented(3))
    assert found.count > 20
    assert fixed_in_place(found)
    assert slipping(*judged(detented(3), detented(4))) is None


@pytest.mark.thorough
def test_a_stem_that_sticks_by_chance_is_recognised_by_its_slips() -> None:
    records = [record(Random(0.6, 0.3, seed), RAMPS, DT, seed, SIGMA, 0.006) for seed in (5, 6)]
    case, decision = judged(*records)
    result = by_slips(case, StageResult(case, (decision,), case.trials), unexplained=True)
    assert result is not None
    (found,) = result.decisions
    assert found.names == ("stiction",)
    assert found.slips is not None
    assert found.slips.model.count == pytest.approx(found.slips.seen.count, rel=0.5)
    breakaway = found.accepted.plant.inserted[0].values[0]
    assert breakaway == pytest.approx(0.6, rel=0.35)
    (note,) = slips_note(result, "psi")
    assert f"jumps {found.slips.seen.count} times" in note.what
    assert slips_note(StageResult(case, (decision,), case.trials), "psi") == []


@pytest.mark.thorough
@pytest.mark.parametrize(("breakaway", "refutes"), [(0.5, True), (0.13, False)])
def test_another_model_that_jumps_as_far_refutes_slips_and_short_teeth_however_many_do_not(
    breakaway: float, refutes: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    case, decision = judged(*(record(Random(0.6, 0.15, seed), RAMPS, DT, seed, SIGMA, 0.006) for seed in (5, 6)))
    channel = decision.findings.channel
    (jumps,) = (c for c in effect_causes(channel, case.base) if c.form is not None and c.form.name == "one_jump")
    space = make_space(case.base, [jumps], (), case.scales)
    other = evaluated(channel, space, np.array([breakaway / space.unknowns[0].unit]))
    monkeypatch.setattr("twin.judge.by_teeth._better", lambda *_: [other])
    assert (slipping(case, decision) is None) is refutes


@pytest.mark.thorough
@pytest.mark.parametrize(("some", "left", "told"), [(1.0, 1.1, True), (1.0, 0.9, False), (1.1, 1.1, False)])
def test_fewer_teeth_are_enough_where_slips_leave_little(
    some: float, left: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`some`, `left`: the least number of teeth, over those there are, and the most that may be left, over what is."""
    case, decision = judged(*(record(Random(0.6, 0.3, seed), RAMPS, DT, seed, SIGMA, 0.006) for seed in (5, 6)))
    found = slipping(case, decision)
    assert found is not None and found.slips is not None
    count = found.slips.seen.count
    monkeypatch.setattr("twin.judge.by_teeth._MANY", 2 * count)
    monkeypatch.setattr("twin.judge.by_teeth._SOME", some * count)
    monkeypatch.setattr("twin.judge.by_teeth._LEFT", left * found.rest)
    assert (slipping(case, decision) is not None) is told


def test_what_was_explained_to_its_noise_is_left_alone() -> None:
    records = [record(Random(0.6, 0.3, seed), RAMPS, DT, seed, SIGMA, 0.006) for seed in (5, 6)]
    case, decision = judged(*records)
    same = StageResult(case, (decision,), case.trials)
    assert by_slips(case, same, unexplained=False) is None  # nothing was accepted, and nothing is unexplained


def test_a_valve_that_slides_is_not_said_to_slip() -> None:
    assert slipping(*judged(*(record(Toy(a1=9.3), RAMPS, DT, seed, SIGMA, 0.006) for seed in (7, 8)))) is None


@pytest.mark.thorough
def test_the_diagnosis_names_stiction_by_its_slips() -> None:
    records = [record(Random(0.6, 0.15, seed), RAMPS, DT, seed, SIGMA, 0.006) for seed in (5, 6)]
    found = diagnose(records, DesignModel()).diagnosis
    assert [cause.name for cause in found.causes] == ["stiction"]
    assert any("was recognised by" in note.handled for note in found.data_quality)
