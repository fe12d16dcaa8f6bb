"""A cause of hardly any size that only brings another law along is none; one that has a size is."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.catalog import effect
from twin.choose.decide import Decision
from twin.choose.findings import Findings
from twin.choose.score import yardstick_for
from twin.choose.switches import switch_notes, without_switches
from twin.effect import Scales
from twin.fit.channel import position_channel
from twin.fit.fitting import evaluated
from twin.fit.space import Cause, make_space
from twin.plant import Inserted, Plant

RINGS = ("distributed_hysteresis", "two_rings", (0.63, 0.146, 0.97))


def decided(asymmetry: float, *others: tuple[str, str, tuple[float, ...]], explained: bool = True) -> Decision:
    """The true hypothesis: an asymmetry of the springs that the stem feels, beside others."""
    parts = (*others, ("spring_asymmetry", "at_stem", (asymmetry,)))
    there = [Inserted(name, effect(name).form(form), values) for name, form, values in parts]
    channel = position_channel([trial_of(Plant(DESIGN, tuple(there)), staircase())[0]], SIGMA)
    causes = [Cause(one.effect, effect(one.effect), one.form) for one in there]
    space = make_space(Plant(DESIGN), causes, ("tau",), Scales())
    values = np.concatenate([[DESIGN.tau_s], *(one.values for one in there)])
    z = np.array([(v - u.centre) / u.unit for v, u in zip(values, space.unknowns, strict=True)])
    none, fit = (
        evaluated(channel, s, at) for s, at in ((make_space(Plant(DESIGN), (), (), Scales()), z[:0]), (space, z))
    )
    return Decision(
        Findings(channel, none, none, (fit,), yardstick_for([none, fit], channel.use)), fit, explained, True, 0.0
    )


def test_what_only_brings_another_law_along_is_no_cause() -> None:
    before = decided(-0.0005, RINGS)
    after = without_switches(before)
    assert after.names == ("distributed_hysteresis",)
    assert after.accepted.mse == pytest.approx(before.accepted.mse, abs=0.05)
    assert after.findings.fits == (after.accepted,)
    values = dict(zip((u.label for u in after.accepted.space.unknowns), after.accepted.values(), strict=True))
    assert values["distributed_hysteresis.elastic"] == pytest.approx(0.63)
    [note] = switch_notes([after], Plant(DESIGN))
    assert "spring_asymmetry of next to no size" in note.what
    assert switch_notes([before], Plant(DESIGN)) == []


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
