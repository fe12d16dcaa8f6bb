"""A pressure that wanders by itself is noise where it is small and nothing tells better, and a gap where it matters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO, a_record
from tests.twin.trials import DESIGN, staircase, trial_of
from twin.choose.decide import decide
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult, driven_about
from twin.diagnose import diagnose
from twin.fit.case import make_case
from twin.fit.channel import pressure_channel
from twin.fit.fitting import fit
from twin.fit.space import make_space
from twin.judge.wander import comes_and_goes, wander
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, pressure_response, reading_response, stem_response
from twin.search.findings import Findings
from twin.search.score import make_yardstick


def wandering(size_psi: float) -> Recording:
    """A healthy valve whose pressure drifts about by itself, RMS `size_psi`, within some ten seconds."""
    command = staircase()
    trial, _ = trial_of(Plant(DESIGN), command)
    r, grid, dice = trial.recording, trial.grid, np.random.default_rng(8)
    c = Plant(DESIGN).coefficients(float(r.time_s[-1]))
    slow = gaussian_filter1d(dice.normal(0.0, 1.0, r.n), 60.0)
    settled = pressure_response(c, grid, command, float(command[0]))
    pressure = settled + size_psi * np.interp(
        np.linspace(0.0, r.n - 1.0, settled.size), np.arange(r.n), slow / slow.std()
    )
    position = reading_response(c, grid, stem_response(c, grid, pressure, 0.0, 0.0), pressure)
    read = pressure[grid.offsets] + dice.normal(0.0, 5e-3, r.n)
    return replace(r, pressure=read, position=position + dice.normal(0.0, 6e-4, r.n))


def hung(size_psi: float) -> Recording:
    """A healthy valve whose converter stays back by `size_psi` for 3 s now and then, and the stem with it."""
    command = staircase()
    trial, _ = trial_of(Plant(DESIGN), command)
    r, grid, dice = trial.recording, trial.grid, np.random.default_rng(8)
    c = Plant(DESIGN).coefficients(float(r.time_s[-1]))
    fine_s = np.interp(np.linspace(0.0, r.n - 1.0, grid.n_fine), np.arange(r.n), r.time_s)
    settled = pressure_response(c, grid, command, float(command[0]))
    pressure = settled - size_psi * (np.mod(fine_s, 70.0) < 3.0)
    position = reading_response(c, grid, stem_response(c, grid, pressure, 0.0, 0.0), pressure)
    read = pressure[grid.offsets] + dice.normal(0.0, 5e-3, r.n)
    return replace(r, pressure=read, position=position + dice.normal(0.0, 6e-4, r.n))


@pytest.mark.parametrize(("one", "events"), [(wandering(0.008), False), (hung(0.04), True), (wandering(0.0), False)])
def test_what_comes_and_goes_is_told_from_what_wanders(one: Recording, events: bool) -> None:
    channel = pressure_channel(make_case([one], DESIGN).trials, 5e-3)
    assert comes_and_goes(channel.residuals(Plant(DESIGN)), channel.trials) is events


@pytest.mark.thorough
def test_what_comes_and_goes_is_no_noise() -> None:
    """As large over all as what wanders and counts as noise, but an event, which nobody would call the usual."""
    assert diagnose([hung(0.04)], DESIGN, (), UP_TO_TWO).diagnosis.verdict == "unexplained"


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("size_psi", "verdict", "said"), [(0.004, "no_gap", True), (0.008, "no_gap", True), (0.02, "unexplained", False)]
)
def test_what_wanders_is_noise_while_it_is_small(size_psi: float, verdict: str, said: bool) -> None:
    found = diagnose([wandering(size_psi)], DESIGN, (), UP_TO_TWO).diagnosis
    assert found.verdict == verdict
    assert any("wandering" in note.handled for note in found.data_quality) is said


@pytest.mark.thorough
@pytest.mark.parametrize(("change_psi", "verdict"), [(0.012, "no_gap"), (0.05, "unexplained")])
def test_a_pressure_that_passes_for_healthy_has_no_zero_that_drifts(change_psi: float, verdict: str) -> None:
    """It resembles one that drifts by a trifle, which is outside of the vocabulary, and no reason to give up."""
    drifts = Inserted("ep_calibration", effect("ep_calibration").form("zero_drifts"), (-0.003, change_psi, 100.0))
    record = a_record(Plant(DESIGN, (drifts,)))
    noisy = record.position + np.random.default_rng(4).normal(0.0, 0.0016, record.n)
    found = diagnose([replace(record, position=noisy)], DESIGN, (), UP_TO_TWO).diagnosis
    assert found.verdict == verdict


def unexplained(recordings: list[Recording]) -> StageResult:
    """A result without a single candidate."""
    case = make_case(recordings, DESIGN)
    assert case.sigma_p is not None
    channel = pressure_channel(case.trials, case.sigma_p)
    none = fit(channel, make_space(case.base, (), (), case.scales), [np.zeros(0)])
    findings = Findings(channel, none, none, (), make_yardstick(none.residuals, channel.use))
    return StageResult(case, (decide(findings, DecisionRules()),), driven_about(case.base, case))


def test_where_commands_were_repeated_it_is_known_whether_it_comes_back() -> None:
    one = wandering(0.008)
    dice = np.random.default_rng(9)
    assert one.pressure is not None
    noise, noise_psi = dice.normal(0.0, 6e-4, one.n), dice.normal(0.0, 5e-3, one.n)
    again = replace(one, name="again", position=one.position + noise, pressure=one.pressure + noise_psi)
    alone, twice = unexplained([one]), unexplained([one, again])
    assert wander(alone.case, alone) is not None
    assert wander(twice.case, twice) is None
