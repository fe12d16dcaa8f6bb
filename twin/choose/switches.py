"""A cause of hardly any size, beside which another law holds: the law is what explains, and no cause of its own.

Which loop moves the stem hangs on what acts there: beside a friction that the stem feels, what creeps or turns over a
distance pulls at the stem itself. An effect of next to nothing then brings the law along that another needs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from logs.recording import DataNote
from twin.choose.decide import Decision
from twin.fit.fitting import Fit, evaluated
from twin.fit.space import Cause
from twin.model.plant import Inserted, Plant

#: Share of its size that a switch keeps, and the share at most of what leaving it out costs that this costs.
_HARDLY, _COSTS = 1e-4, 0.05


def without_switches(decision: Decision) -> Decision:
    """The decision with what is no cause put into the base of its hypothesis, of hardly any size."""
    accepted = decision.accepted
    for cause in accepted.space.causes if decision.explained else ():
        effects = [one for one in accepted.space.causes if one.form is not None]
        if len(effects) > 1 and cause in effects and _is_switch(decision, accepted, cause):
            accepted = _based_on(decision, accepted, cause, _HARDLY)
    if accepted is decision.accepted:
        return decision
    fits = tuple(accepted if one is decision.accepted else one for one in decision.findings.fits)
    findings = replace(decision.findings, fits=fits)
    return replace(decision, findings=findings, accepted=accepted, rest=decision.rest_of(accepted))


def switch_notes(decisions: Sequence[Decision], base: Plant, updated: Plant) -> list[DataNote]:
    """What to say of an effect that is in the updated model, and no cause; nothing where that model does without."""
    what = "the updated model has {} of next to no size"
    handled = "it brings along the law by which what is named acts, and is no cause"
    return [
        DataNote(what.format(one.effect), handled)
        for decision in decisions
        for one in decision.accepted.space.base.inserted
        if one in updated.inserted and one not in base.inserted
    ]


def _is_switch(decision: Decision, fit: Fit, cause: Cause) -> bool:
    if cause.present or cause.form is None or not any(p.size for p in cause.form.parameters):
        return False
    without = _based_on(decision, fit, cause, 0.0).mse - fit.mse
    return _based_on(decision, fit, cause, _HARDLY).mse - fit.mse < _COSTS * without


def _based_on(decision: Decision, fit: Fit, cause: Cause, share: float) -> Fit:
    """The hypothesis as it is with `share` of a cause as known; 0: without it."""
    space, which = fit.space, _unknowns_of(fit, cause)
    assert cause.form is not None
    values = fit.values()[which]
    nothing = np.array([space.unknowns[k].centre for k in which])
    sizes = np.array([p.size for p in cause.form.parameters])
    known = Inserted(cause.name, cause.form, tuple(np.where(sizes, nothing + share * (values - nothing), values)))
    rest = np.setdiff1d(np.arange(fit.z.size), which)
    base = space.base.having([known]) if share > 0.0 else space.base
    unknowns = tuple(space.unknowns[k] for k in rest)
    causes = tuple(one for one in space.causes if one is not cause)
    there = replace(space, base=base, causes=causes, unknowns=unknowns)
    found = evaluated(decision.findings.channel, there, fit.z[rest])
    return replace(found, normal=fit.normal[np.ix_(rest, rest)], evaluations=fit.evaluations)


def _unknowns_of(fit: Fit, cause: Cause) -> npt.NDArray[np.intp]:
    """Where the unknowns of a cause are."""
    at = len(fit.space.numbers)
    for one in fit.space.causes:
        count = len(one.form.parameters) if one.form is not None else 0
        if one is cause:
            return np.arange(at, at + count, dtype=np.intp)
        at += count
    raise ValueError(f"{cause.name} is not in the hypothesis")
