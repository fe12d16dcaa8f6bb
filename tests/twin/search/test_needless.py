"""A rival from outside of the vocabulary gives way to a plainer known form that explains all but a trifle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.twin.choose.test_outside import a_fit, answered, with_form
from tests.twin.judged import a_record
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.choose import trim
from twin.choose.decide import Decision
from twin.choose.outside import inside
from twin.choose.rules import DecisionRules
from twin.choose.trim import spoken
from twin.choose.weigh import Weights
from twin.fit.channel import position_channel
from twin.fit.fitting import Fit
from twin.fit.space import Cause
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.needless import without_needless
from twin.search.search import Searcher

CALIBRATION = effect("ep_calibration")
RULES = DecisionRules()


def test_a_drift_of_a_trifle_beside_a_zero_is_a_wander() -> None:
    """A rival counts where the known form leaves more than a healthy machine, or much of a small gap, or is freer."""
    zero, drifts = (Cause("ep_calibration", CALIBRATION, CALIBRATION.form(f)) for f in ("zero", "zero_drifts"))
    for gap, left, needed in ((31.9, 1.14, False), (31.9, 1.5, True), (3.0, 1.14, True), (3.0, 1.05, False)):
        fits = [a_fit((zero,), left), a_fit((drifts,), 0.98)]
        assert without_needless(fits, a_fit((), gap)) == fits[: 2 if needed else 1]
    damping = effect("asymmetric_damping")
    free, rival = (Cause(damping.name, damping, damping.form(f)) for f in ("orifice_each_way", "orifice_alike"))
    for fits in ([a_fit((drifts,), 0.98)], [a_fit((free,), 0.98), a_fit((rival,), 0.98)]):
        assert without_needless(fits, a_fit((), 31.9)) == fits


@pytest.mark.thorough
def test_a_zero_under_a_pressure_that_wanders_is_named() -> None:
    found = answered(a_record(with_form("ep_calibration", "zero_drifts", 0.05, -0.008, 120.0))).diagnosis
    assert [c.name for c in found.causes] == ["ep_calibration"]


@pytest.mark.parametrize(("channel", "heard"), [("pressure", False), ("chain", False), ("position", True)])
def test_what_resembles_a_rival_by_a_trifle_is_the_wander_of_an_unmeasured_pressure_too(
    channel: str, heard: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A gap that passes for healthy; behind a measured pressure the stem does not wander."""
    spring = effect("nonlinear_spring")
    rival = a_fit((Cause(spring.name, spring, spring.form("breaks")),), 1.0)
    none = a_fit((), 1.5)
    findings: Any = SimpleNamespace(channel=SimpleNamespace(name=channel, sigma=1.0), none=none)
    monkeypatch.setattr(trim, "_guess", lambda _decision, _weights: False)
    monkeypatch.setattr(trim, "moved_square", lambda _decision, _sigma: 0.0)
    decision = Decision(findings, rival, explained=True, gap=True, rest=0.0)
    [after] = spoken((decision,), Weights(), False)
    assert after.explained is heard
    [clear] = spoken((replace(decision, floor=0.5),), Weights(), False)
    assert clear.explained


def test_a_rival_is_dropped_only_where_the_others_explain_the_gap() -> None:
    """Beside a lag the jump takes next to nothing of the gap, a tenth, or most of it."""
    lag = Cause("sensor_lag", effect("sensor_lag"), effect("sensor_lag").form("first_order"))
    jump = Cause("lvdt_drift", effect("lvdt_drift"), effect("lvdt_drift").form("jump"))
    for left, names in (
        (3.0, ("sensor_lag",)),
        (10.0, ("sensor_lag", "lvdt_drift")),
        (60.0, ("sensor_lag", "lvdt_drift")),
    ):
        none, alone, both = (a_fit(causes, mse) for causes, mse in (((), 100.0), ((lag,), left), ((lag, jump), 1.0)))
        findings: Any = SimpleNamespace(none=none, fits=(alone, both), score=lambda f: -f.mse)
        decision = Decision(findings, both, True, True, 0.0)
        assert inside(decision, RULES).names == names
        assert inside(replace(decision, accepted=alone), RULES).names == ("sensor_lag",)


@pytest.mark.parametrize(
    ("gap", "left", "nats", "known"), [(146.0, 1.51, 4.0, True), (3.0, 1.51, 4.0, False), (146.0, 1.51, 20.0, False)]
)
def test_a_rival_that_does_hardly_better_gives_way_to_the_same_cause(
    gap: float, left: float, nats: float, known: bool
) -> None:
    """A reading that is off by a constant, and, as nothing else is fitted, hears a trifle of the pressure."""
    gauge = effect("lvdt_calibration")
    off, hears = (Cause(gauge.name, gauge, gauge.form(name)) for name in ("gain_and_zero", "picks_up"))
    none, plain, rival = a_fit((), gap), a_fit((off,), left), a_fit((hears,), 1.485)
    findings: Any = SimpleNamespace(none=none, fits=(plain, rival), score=lambda f: nats if f is rival else 0.0)
    decision = Decision(findings, rival, True, True, 0.0)
    assert inside(decision, RULES).accepted is (plain if known else rival)


def test_a_rival_that_was_needed_only_as_long_as_the_known_form_was_stuck_goes_in_the_end() -> None:
    """The last look from the neighbours may be the first from which the known form comes to its best."""
    gauge = effect("lvdt_calibration")
    trial, _ = trial_of(Plant(DESIGN, (Inserted(gauge.name, gauge.form("zero"), (0.05,)),)), staircase())
    channel = position_channel([trial], SIGMA)
    noise = np.random.default_rng(1).normal(size=channel.use.size)
    zero, rival = (
        replace(a_fit((Cause(gauge.name, gauge, gauge.form(name)),), 0.99), residuals=noise)
        for name in ("zero", "picks_up")
    )

    class OneRival(Searcher):
        def _singles(self, retuned: Fit) -> list[Fit]:
            return [rival]

        def _nothing_left(self, level: Sequence[Fit], none: Fit) -> bool:
            return True

        def _drifting(self, level: Sequence[Fit]) -> list[Fit]:
            return []

        def _neighbours(self, found: Sequence[Fit]) -> list[Fit]:
            return [zero]

    found = OneRival(channel, Plant(DESIGN), Scales()).run()
    forms = [f.space.causes[0].form for f in found.fits if f.names == (gauge.name,)]
    assert [form.name for form in forms if form] == ["zero"]
