"""Where a drift explains why repeats differ, their difference is no noise, and a smaller cause beside it shows."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from logs.recording import Recording
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin import diagnose as module
from twin.choose.weigh import Weights
from twin.diagnose import Outcome, Settings, diagnose
from twin.fit.space import Cause
from twin.judge.partial import Interrupted
from twin.judge.repeatable import differ_for_a_cause, leaves_what_rests
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.noise.model import SignalNoise, estimate_noise
from twin.search.search_rules import SearchRules

DRIFT = Inserted("friction_drift", effect("friction_drift").form("linear"), (3e-5,))
LOOSE = Inserted("linkage_lost_motion", effect("linkage_lost_motion").form("play"), (0.003,))


@pytest.fixture(scope="module")
def drifting() -> Recording:
    """The same commands twice, with a packing that grips harder all the time and a slightly loose core."""
    trial, _ = trial_of(Plant(DESIGN, (DRIFT, LOOSE)), np.tile(staircase()[:1500], 2))
    r = trial.recording
    assert r.pressure is not None
    return replace(r, pressure=r.pressure + np.random.default_rng(7).normal(0.0, 0.008, r.n))


def answered(record: Recording) -> Outcome:
    return diagnose([record], DESIGN, (), Settings(search=SearchRules(most=2)))


@pytest.mark.thorough
def test_both_are_named_and_the_floor_is_that_of_the_resting_reading(drifting: Recording) -> None:
    assert estimate_noise([drifting]).position.source == "repeats"
    found = answered(drifting)
    assert {c.name for c in found.diagnosis.causes} == {"friction_drift", "linkage_lost_motion"}
    sure = {c.name: c.probability for c in found.diagnosis.causes}
    assert sure["linkage_lost_motion"] <= Weights().further < sure["friction_drift"]  # beside a larger one
    noise = found.result.case.noise
    assert noise.position.source == "still" and noise.position.sigma == pytest.approx(SIGMA, rel=0.15)
    assert noise.pressure is not None and noise.pressure.source == "repeats"


@pytest.mark.thorough
def test_what_leaves_more_than_the_resting_noise_is_not_kept(
    drifting: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "leaves_what_rests", lambda _decision: False)
    found = answered(drifting)
    assert found.result.case.noise.position.source == "repeats"
    assert "friction_drift" in {c.name for c in found.diagnosis.causes}


@pytest.mark.thorough
def test_who_stops_the_second_search_keeps_what_the_first_found(drifting: Recording) -> None:
    begun: list[str] = []

    def stop(what: str, _share: float) -> None:
        begun.append(what)
        if begun.count("noise and events") == 2 and what.startswith("position"):
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stopped:
        diagnose([drifting], DESIGN, (), Settings(search=SearchRules(most=2)), stop)
    found = stopped.value.diagnosis
    assert {"friction_drift", "linkage_lost_motion"} <= {c.name for c in found.ranking}  # each tried alone
    loud = estimate_noise([drifting]).position.sigma
    assert found.gap.noise_floor == pytest.approx(100.0 * loud / DESIGN.travel, rel=1e-3)


def decision(
    mse: float, names: tuple[str, ...] = ("friction_drift",), others: tuple[tuple[str, float], ...] = ()
) -> Any:
    """One that accepted `names`, beside others that leave so much of what counts as noise."""
    tried = [
        SimpleNamespace(mse=left, space=SimpleNamespace(causes=(Cause(n, effect(n), effect(n).forms[0]),)))
        for n, left in others
    ]
    accepted = SimpleNamespace(mse=mse)
    return SimpleNamespace(names=names, accepted=accepted, floor=1.0, findings=SimpleNamespace(fits=tried))


def test_when_a_cause_explains_by_what_repeats_differ() -> None:
    loud = SignalNoise(3e-3, 1.0, "repeats", 900, 0.1, by_source={"repeats": 3e-3, "still": 1e-3})
    assert differ_for_a_cause(decision(0.2), loud)
    assert not differ_for_a_cause(decision(0.9), loud)
    assert not differ_for_a_cause(decision(0.2, ()), loud)
    assert not differ_for_a_cause(decision(0.2), replace(loud, source="still"))
    assert not differ_for_a_cause(decision(0.2), replace(loud, by_source={"repeats": 3e-3, "still": 2.9e-3}))
    assert not differ_for_a_cause(decision(0.2), replace(loud, by_source={"repeats": 3e-3}))
    assert differ_for_a_cause(decision(0.9, others=(("friction_drift", 0.2),)), loud)  # too loud for it to be accepted
    assert differ_for_a_cause(decision(1.0, (), (("lvdt_drift", 0.2),)), loud)
    assert not differ_for_a_cause(decision(0.9, others=(("friction_drift", 0.8), ("stiction", 0.2))), loud)


def test_what_rests_is_about_the_noise() -> None:
    assert leaves_what_rests(decision(1.2)) and not leaves_what_rests(decision(2.0))
    assert not leaves_what_rests(decision(1.2, ()))
