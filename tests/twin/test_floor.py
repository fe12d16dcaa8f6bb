"""What the true model would leave, where a gap matters, and the plain cause that turns out not to be enough."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record, judged
from tests.twin.trials import SIGMA, staircase, trial_of
from twin.choose.decide import _likely_floor, decide
from twin.choose.plainer import plainer
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult
from twin.choose.trim import spoken, trimmed
from twin.choose.weigh import Weights
from twin.diagnose import Settings, diagnose
from twin.fit.case import Margin
from twin.fit.channel import position_channel
from twin.fit.fitting import Fit
from twin.fit.smooth import smoothed_pressure
from twin.fit.space import Cause, make_space
from twin.judge.heldout import refitted
from twin.judge.verdict import Judgement, pronounce
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import simulate_recording
from twin.search.findings import Findings
from twin.where.closure import rms

RULES = DecisionRules()
DESIGN = DesignModel()


def inserted(name: str, form: str, *values: float) -> Inserted:
    return Inserted(name, effect(name).form(form), values)


@cache
def two_causes() -> tuple[StageResult, Judgement]:
    """A converter that lags far behind, and a little creep behind it."""
    design = replace(DESIGN, ep_tau_s=1.2)
    return judged(a_record(Plant(design, (inserted("creep", "one_tail", 0.05, 30.0),))))


@pytest.mark.thorough
def test_the_true_model_leaves_no_more_than_half_again_of_what_the_likeliest_leaves() -> None:
    findings = two_causes()[0].decisions[1].findings
    least = findings.scored()[0][1].mse
    assert _likely_floor(findings, 30.0) == pytest.approx(1.5 * least)
    assert _likely_floor(findings, 1.2) == 1.2
    decision = decide(findings, RULES, 30.0)
    assert decision.names == ("creep",) and decision.explained


def without(result: StageResult, name: str) -> StageResult:
    """The result with what nobody knows the cause of in the place of one."""
    found = [
        replace(d, accepted=d.findings.none, explained=False, gap=True, rest=1.0) if name in d.names else d
        for d in result.decisions
    ]
    return replace(result, decisions=tuple(found))


@pytest.mark.thorough
@pytest.mark.parametrize(("share", "verdict"), [(0.99, "parameter"), (0.97, "unexplained")])
def test_a_rest_behind_a_converter_that_explains_the_gap_needs_no_cause(share: float, verdict: str) -> None:
    result, _ = two_causes()
    sensing: Any = SimpleNamespace(accepted={})
    assert pronounce(without(result, "creep"), sensing, share, Weights()).verdict == verdict
    nothing = without(without(result, "creep"), "parameter:ep_tau")
    assert pronounce(nothing, sensing, share, Weights()).verdict == "unexplained"
    quiet = replace(nothing, decisions=(replace(nothing.decisions[0], gap=False), nothing.decisions[1]))
    assert pronounce(quiet, sensing, share, Weights()).verdict == "unexplained"


def findings_of(fits: dict[tuple[str, ...], tuple[float, float]], before: float) -> Findings:
    """Hypotheses with their (mse, score), all of them far apart, on a channel that is not looked at."""
    base = Plant(DESIGN)

    def one(names: tuple[str, ...], mse: float, apart: float = 0.0) -> Fit:
        causes = tuple(
            Cause(n) if n.startswith("parameter:") else Cause(n, effect(n), effect(n).forms[0]) for n in names
        )
        space = make_space(base, causes, (), Scales())
        z = np.full(len(space.unknowns), 0.5)
        return Fit(space, z, mse, 0.0, np.array([apart]), 1e9 * np.eye(z.size), 1)

    made = {names: one(names, mse, 100.0 * (k + 1)) for k, (names, (mse, _)) in enumerate(fits.items())}
    none = one((), before)
    scores = {id(f): fits[names][1] for names, f in made.items()} | {id(none): -1e6}
    yardstick: Any = SimpleNamespace(phi=1.0, score=lambda f: scores[id(f)])
    channel: Any = SimpleNamespace(name="chain")
    return Findings(channel, none, none, tuple(made.values()), yardstick)


def test_wrong_numbers_that_are_not_enough_give_way_to_the_effect_they_were_taken_for() -> None:
    fits = {
        ("creep",): (1.0, 1000.0),
        ("parameter:tau",): (1.9, 200.0),
        ("friction_drift", "lvdt_drift"): (0.9, 600.0),
    }
    assert decide(findings_of(fits, 1400.0), RULES).names == ("creep",)
    del fits[("friction_drift", "lvdt_drift")]
    assert decide(findings_of(fits, 1400.0), RULES).names == ("parameter:tau",)


def test_what_is_left_when_a_companion_goes_is_the_best_of_its_size() -> None:
    fits = {
        ("friction_drift", "lvdt_drift"): (0.9, 1001.0),
        ("friction_drift", "creep"): (0.9, 1000.0),
        ("friction_drift", "stiction"): (0.9, 1000.0),
        ("friction_drift",): (1.0, 600.0),
        ("sensor_lag",): (1.0, 900.0),
    }
    findings = findings_of(fits, 100.0)
    decision = replace(decide(findings, RULES), accepted=findings.fits[0], explained=True, rest=0.0)
    assert trimmed(decision, RULES, Weights()).names == ("sensor_lag",)
    near = findings_of(fits | {("sensor_lag",): (1.0, 605.0)}, 100.0)
    assert trimmed(replace(decision, findings=near, accepted=near.fits[0]), RULES, Weights()).names == (
        "friction_drift",
    )


def test_what_a_fold_says_nothing_about_stays_where_the_whole_record_put_it() -> None:
    """A rate limit that is reached in one block only; the prior of the others would pull it back to the design."""
    fast = Plant(replace(DESIGN, rate_limit=0.24))
    trial, _ = trial_of(fast, staircase())
    channel = position_channel([trial], SIGMA)
    space = make_space(Plant(DESIGN), (Cause("parameter:rate_limit"),), ("rate_limit",), Scales())
    z = np.array([0.9])
    found = Fit(space, z, 1.0, 0.0, np.zeros(1), np.zeros((1, 1)), 1)
    nothing = np.zeros(trial.recording.n)
    assert refitted([found], [channel], nothing)[0].z == pytest.approx(z, abs=1e-3)


def test_a_dip_that_was_never_read_does_not_drive_the_play() -> None:
    """The model steps a quarter of a second before the pressure does: what the measurement adds rings there."""
    late = np.roll(staircase(), 3)
    late[:3] = late[3]
    trial, _ = trial_of(Plant(DESIGN), late)
    measured = trial.recording.pressure
    assert measured is not None
    noisy = measured + np.random.default_rng(4).normal(0.0, 0.005, measured.size)
    early = replace(trial, recording=replace(trial.recording, command=staircase(), pressure=noisy))
    driven = smoothed_pressure(Plant(DESIGN), early, 0.005)[trial.grid.offsets]
    assert driven.min() > measured.min() - 0.05 and driven.max() < measured.max() + 0.05
    for row in np.flatnonzero(np.abs(np.diff(staircase())) > 0.5):
        about = slice(max(row - 6, 0), row + 9)
        assert driven[about].min() > noisy[about].min() - 0.03
        assert driven[about].max() < noisy[about].max() + 0.03


def test_a_number_that_leaves_no_more_than_a_healthy_machine_needs_no_effect_beside_or_instead() -> None:
    fits = {("creep",): (0.6, 1000.0), ("parameter:tau",): (0.95, 900.0)}
    findings = findings_of(fits, 50.0)
    for within, name in ((1.0, "parameter:tau"), (0.0, "creep"), (0.9, "creep")):
        assert plainer(findings, findings.fits[0], replace(RULES, within=within)).names == (name,)


@pytest.mark.parametrize(("left", "name"), [(1.9, "parameter:deadband"), (3.5, "linkage_lost_motion")])
def test_however_large_the_gap_a_number_has_no_form_that_could_be_at_fault(left: float, name: str) -> None:
    """A lost motion of a design's valve closes what a narrower deadband does in 1,000 of its gap, and the rest."""
    fits = {("linkage_lost_motion",): (0.97, 1000.0), ("parameter:deadband",): (left, 100.0)}
    findings = findings_of(fits, 1122.0)
    assert plainer(findings, findings.fits[0], RULES).names == (name,)


@pytest.mark.thorough
def test_what_a_healthy_machine_does_anyway_is_not_named() -> None:
    creep = inserted("creep", "one_tail", 0.01, 30.0)
    healthy, record = a_record(Plant(DESIGN, (creep,))), a_record(Plant(replace(DESIGN, a1=8.88, a2=5.92), (creep,)))
    known = rms(healthy.position - simulate_recording(DESIGN, healthy)[1])
    for margin, told in ((Margin(position=known), False), (Margin(), True)):
        causes = diagnose([record], DESIGN, settings=Settings(margin=margin)).diagnosis.causes
        assert ("creep" in {c.name for c in causes}) is told
        assert told or [c.name for c in causes] == ["parameter:offset"]


def test_a_guess_beside_what_is_sure_is_not_spoken() -> None:
    """Four causes that fit a small rest equally well: naming one would be wrong three times out of four."""
    fits = {(name,): (1.0, 1000.0) for name in ("linkage_lost_motion", "stiction", "creep", "friction_drift")}
    alike, lone = findings_of(fits, 20.0), findings_of({("creep",): (1.0, 1000.0)}, 20.0)
    guess = replace(decide(alike, RULES), accepted=alike.fits[0], explained=True, rest=0.0)
    sure = replace(decide(lone, RULES), accepted=lone.fits[0], explained=True, rest=0.0)
    assert [d.names for d in spoken((sure, guess), Weights(), False)] == [("creep",), ()]
    assert [d.names for d in spoken((guess,), Weights(), True)] == [()]
    assert spoken((guess,), Weights(), False) == (guess,)  # nothing is sure: whether it is upheld is decided later
    assert spoken((sure,), Weights(), True) == (sure,)
    large = findings_of(fits, 400.0)
    plain = replace(decide(large, RULES), accepted=large.fits[0], explained=True, rest=0.0)
    assert [d.names for d in spoken((sure, plain), Weights(), True)] == [("creep",), plain.names]
    assert spoken((guess, plain), Weights(), False) == (guess, plain)  # a guess makes nothing sure
    little = findings_of({("ep_calibration",): (1.0, 1000.0)}, 1.6)
    slight = replace(decide(little, RULES), accepted=little.fits[0], explained=True, rest=0.0)
    assert [d.names for d in spoken((slight, guess), Weights(), False)] == [(), guess.names]


def test_what_hardly_shows_on_a_signal_is_not_spoken_beside_what_is_sure() -> None:
    """A design that leaves 1.3 times the noise is not another machine; alone it is judged later, by unseen data."""
    leaves = [findings_of({("creep",): (1.0, 1000.0)}, mse) for mse in (20.0, 1.6, 1.8)]
    sure, slight, clear = (
        replace(decide(one, RULES), accepted=one.fits[0], explained=True, rest=0.0) for one in leaves
    )
    assert [d.names for d in spoken((sure, slight), Weights(), False)] == [("creep",), ()]
    assert [d.names for d in spoken((slight,), Weights(), True)] == [()]
    assert spoken((slight,), Weights(), False) == (slight,)
    assert spoken((sure, clear), Weights(), False) == (sure, clear)
