"""A cause of hardly any size that only brings another law along is none; one that has a size is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.twin.judged import UP_TO_TWO, a_record
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.choose.decide import Decision
from twin.choose.stages import StageResult, driven_about
from twin.choose.switches import switch_notes, without_switches
from twin.diagnose import diagnose
from twin.fit.case import Case
from twin.fit.channel import Channel, position_channel, pressure_channel
from twin.fit.fitting import evaluated
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.findings import Findings
from twin.search.score import yardstick_for

RINGS = ("distributed_hysteresis", "two_rings", (0.63, 0.146, 0.97))
HARDLY = ("spring_asymmetry", "at_stem", (-1e-6,))


def decided(asymmetry: float, *others: tuple[str, str, tuple[float, ...]], explained: bool = True) -> Decision:
    """The true hypothesis: an asymmetry of the springs that the stem feels, beside others."""
    parts = (*others, ("spring_asymmetry", "at_stem", (asymmetry,)))
    there = [Inserted(name, effect(name).form(form), values) for name, form, values in parts]
    channel = position_channel([trial_of(Plant(DESIGN, tuple(there)), staircase())[0]], SIGMA)
    return decision_of(channel, there, Plant(DESIGN), explained)


def decision_of(channel: Channel, there: Sequence[Inserted], base: Plant, explained: bool = True) -> Decision:
    """That a hypothesis explains a channel, with the numbers that it is made of."""
    causes = [Cause(one.effect, effect(one.effect), one.form) for one in there]
    space, nothing = make_space(base, causes, ("tau",), Scales()), make_space(base, (), (), Scales())
    values = np.concatenate([[DESIGN.tau_s], *(one.values for one in there)])
    z = np.array([(v - u.centre) / u.unit for v, u in zip(values, space.unknowns, strict=True)])
    none, fit = evaluated(channel, nothing, z[:0]), evaluated(channel, space, z)
    findings = Findings(channel, none, none, (fit,), yardstick_for([none, fit], channel.use))
    return Decision(findings, fit, explained and bool(there), bool(there), 0.0)


def test_what_only_brings_another_law_along_is_no_cause() -> None:
    before = decided(-0.0005, RINGS)
    after = without_switches(before)
    assert after.names == ("distributed_hysteresis",)
    assert after.accepted.mse == pytest.approx(before.accepted.mse, abs=0.05)
    assert after.findings.fits == (after.accepted,)
    values = dict(zip((u.label for u in after.accepted.space.unknowns), after.accepted.values(), strict=True))
    assert values["distributed_hysteresis.elastic"] == pytest.approx(0.63)
    [note] = switch_notes([after], Plant(DESIGN), after.accepted.plant)
    assert "spring_asymmetry of next to no size" in note.what
    assert switch_notes([after], Plant(DESIGN), Plant(DESIGN)) == []  # one that was re-tuned instead
    assert switch_notes([before], Plant(DESIGN), before.accepted.plant) == []


def test_what_acts_alone_without_a_size_stays() -> None:
    """Friction that turns over hardly any distance is on the stem all the same."""
    elastic = ("friction_in_motion", "elastic", (1e-4, 0.0, 0.0))
    decision = decided(-0.1, elastic)
    assert without_switches(decision) is decision


@pytest.mark.parametrize("others", [(RINGS,), ()])
def test_what_has_a_size_or_nothing_beside_it_stays(others: tuple[tuple[str, str, tuple[float, ...]], ...]) -> None:
    decision = decided(-0.1 if others else -1e-6, *others)
    assert without_switches(decision) is decision


def test_what_was_not_accepted_stays_as_it_is() -> None:
    decision = decided(-0.0005, RINGS, explained=False)
    assert without_switches(decision) is decision


@pytest.mark.thorough
def test_a_diagnosis_names_what_explains_and_notes_the_switch(monkeypatch: pytest.MonkeyPatch) -> None:
    rings, hardly = (Inserted(name, effect(name).form(form), values) for name, form, values in (RINGS, HARDLY))

    def both(case: Case, *_: object, **__: object) -> StageResult:
        """As if the search had found the true hypothesis."""
        trials = driven_about(case.base, case)
        first = decision_of(pressure_channel(trials, case.sigma_p or 0.0), (), case.base)
        return StageResult(
            case, (first, decision_of(position_channel(trials, case.sigma_y), (rings, hardly), case.base)), trials
        )

    monkeypatch.setattr("twin.diagnose.judge", both)
    found = diagnose([a_record(Plant(DESIGN, (rings, hardly)), seed=4)], DESIGN, (), UP_TO_TWO).diagnosis
    assert [cause.name for cause in found.causes] == ["distributed_hysteresis"]
    assert any("spring_asymmetry of next to no size" in note.what for note in found.data_quality)
