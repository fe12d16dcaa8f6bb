"""Many causes that do a large gap alike are one sure answer; about a slight gap they are none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.twin.test_floor import findings_of
from twin.choose.alike import alike
from twin.choose.decide import Decision
from twin.diagnosis import Cause as Named
from twin.diagnosis import Ranked
from twin.fit.fitting import Fit
from twin.fit.space import make_space
from twin.judge.gap import GapParts
from twin.judge.upheld import upheld
from twin.judge.verdict import Judgement
from twin.model.effect import Scales
from twin.record.sensing import Sensing
from twin.search.reform import spares_numbers

#: All weigh the same.
EVEN: Any = SimpleNamespace(phi=1.0, score=lambda _: 0.0)


def moved(fit: Fit, apart: float, left: float | None = None) -> Fit:
    """A hypothesis that misses by `apart` noises from row to row, more or less of which it explains."""
    wave = apart * np.resize([1.0, -1.0], 100)
    return replace(fit, residuals=wave, mse=fit.mse if left is None else left)


def of_a_gap(before: float, left: float, apart: float) -> Decision:
    """A wrong deadband that leaves `left`, and a play of the linkage that predicts `apart` noises otherwise."""
    fits = {("parameter:deadband",): (left, 100.0), ("linkage_lost_motion",): (left, 99.0)}
    findings = findings_of(fits, before)
    accepted, other = moved(findings.fits[0], 0.0), moved(findings.fits[1], apart)
    findings = replace(findings, fits=(accepted, other), yardstick=EVEN)
    return replace(Decision(findings, accepted, True, True, 0.0), floor=1.0)


@pytest.mark.parametrize(
    ("before", "left", "apart", "same"),
    [
        (500.0, 1.5, 1.0, True),
        (500.0, 1.5, 1.6, False),  # 0.5 % of the squares apart
        (500.0, 3.2, 1.0, False),  # too much is left for any of them
        (60.0, 1.5, 0.1, False),  # as it would be of a smaller gap
    ],
)
def test_what_does_nearly_all_of_a_gap_alike_is_one_answer(
    before: float, left: float, apart: float, same: bool
) -> None:
    decision = of_a_gap(before, left, apart)
    assert alike(decision, "parameter:deadband") == (("linkage_lost_motion",) if same else ())


def test_beside_a_large_cause_only_what_is_left_without_it_is_the_gap_of_a_second_one() -> None:
    fits = {
        ("creep", "stiction"): (1.5, 100.0),
        ("creep", "lvdt_drift"): (1.5, 99.0),
        ("creep",): (9.0, 50.0),
    }
    findings = findings_of(fits, 5000.0)
    both, other, creep = (moved(f, a) for f, a in zip(findings.fits, (0.0, 1.0, 0.0), strict=True))
    findings = replace(findings, yardstick=EVEN)
    decision = Decision(replace(findings, fits=(both, other, creep)), both, True, True, 0.0)
    assert alike(decision, "stiction") == ()
    larger = replace(decision, findings=replace(findings, fits=(both, other, moved(creep, 0.0, 900.0))))
    assert alike(larger, "stiction") == ("lvdt_drift",)


@pytest.mark.parametrize(("before", "verdict"), [(1.25, "no_gap"), (1.4, "effect")])
def test_any_of_many_is_no_answer_about_a_slight_gap(before: float, verdict: str) -> None:
    """A flow loop that its plant calls healthy, 1.2 times its noise off: thirteen causes explained that alike."""
    creep = Named("creep", "actuator", 0.17, None, {})
    ranking = tuple(Ranked(name, 0.17, None, False) for name in ("lvdt_drift", "stiction"))
    judgement = Judgement("effect", (creep,), ranking, (), alike={"creep": ("lvdt_drift", "stiction")})
    parts = GapParts(*(np.full(8, level) for level in (before, 1.0, 1.0)), {}, {})
    assert upheld(parts, judgement, 1.0, Sensing((), {}, 0.0), False, exact=True)[1].verdict == verdict


@pytest.mark.parametrize(("alone", "together", "bends"), [(0.3, 0.0, True), (0.3, 0.25, False), (0.05, 0.0, False)])
def test_a_cause_is_needed_where_numbers_would_have_to_do_it(alone: float, together: float, bends: bool) -> None:
    findings = findings_of({("flow_force",): (1.2, 1.0), ("flow_force", "creep"): (1.1, 2.0)}, 500.0)
    less, more = (with_deadband(fit, z) for fit, z in zip(findings.fits, (alone, together), strict=True))
    assert spares_numbers(more, less) is bends


def with_deadband(fit: Fit, moved_by: float) -> Fit:
    """The hypothesis with a deadband beside, and so far off, that nobody accuses."""
    space = make_space(fit.space.base, fit.space.causes, ("deadband",), Scales())
    return replace(fit, space=space, z=np.concatenate([[moved_by], fit.z]))
