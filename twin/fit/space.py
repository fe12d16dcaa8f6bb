"""The unknowns of a hypothesis: which causes are in it, and how a vector of unknowns becomes a plant.

A hypothesis is a set of causes. An effect among them brings the parameters of one of its forms. A design number among
them is free; the other design numbers of the stage are nuisances with a tight prior, so that re-tuning can neither hide
an effect nor can an effect take credit for re-tuning.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.fit.numbers import NUMBERS, nominal, reference, retuned
from twin.model.effect import Effect, Form, Parameter, Scales
from twin.model.plant import Inserted, Plant

#: Relative spread of a design number that stands accused.
ACCUSED_SPREAD = 0.5
#: ... and of one that an effect of the hypothesis gives another meaning.
ABSORBED_SPREAD = 0.1
#: Relative move of a design number beside an effect, far beyond its prior, from which it is suspected itself.
SHIFTED = 0.1
REFERENCE = Scales()


@dataclass(frozen=True, slots=True)
class Cause:
    """An effect in one of its forms, or a design number (`form` is None).

    `present`: the values [record units] that the design already gives to this form; the cause is then their change.
    """

    name: str
    effect: Effect | None = None
    form: Form | None = None
    present: tuple[float, ...] = ()

    @property
    def stage(self) -> str:
        """Stage of the chain: ep, actuator or sensor."""
        return self.effect.stage if self.effect else NUMBERS[self.name.removeprefix("parameter:")]


@dataclass(frozen=True, slots=True)
class Unknown:
    """One unknown: value = centre + unit * z, within bounds on z; `spread` is the prior's standard deviation of z."""

    label: str
    centre: float
    unit: float
    lower: float
    upper: float
    spread: float
    step: float
    smooth: bool = True


@dataclass(frozen=True, slots=True)
class Space:
    """The unknowns of a hypothesis over a base plant (design and effects already accepted as true)."""

    base: Plant
    causes: tuple[Cause, ...]
    numbers: tuple[str, ...]
    unknowns: tuple[Unknown, ...]
    scales: Scales

    def plant(self, z: FloatArray) -> Plant:
        """The plant at `z`: design numbers first, then the effects' parameters in the order of the causes."""
        values = [u.centre + u.unit * float(v) for u, v in zip(self.unknowns, z, strict=True)]
        design = retuned(self.base.design, dict(zip(self.numbers, values, strict=False)))
        at = len(self.numbers)
        inserted = []
        for cause in self.causes:
            if cause.effect is not None and cause.form is not None:
                count = len(cause.form.parameters)
                inserted.append(Inserted(cause.name, cause.form, tuple(values[at : at + count])))
                at += count
        return Plant(design, self.base.inserted).having(inserted)

    @property
    def lower(self) -> FloatArray:
        return np.array([u.lower for u in self.unknowns])

    @property
    def upper(self) -> FloatArray:
        return np.array([u.upper for u in self.unknowns])

    @property
    def spreads(self) -> FloatArray:
        return np.array([u.spread for u in self.unknowns])

    @property
    def steps(self) -> FloatArray:
        return np.array([u.step for u in self.unknowns])


def make_space(
    base: Plant, causes: Sequence[Cause], numbers: Sequence[str], scales: Scales, spread: float | None = None
) -> Space:
    """The space of a hypothesis; `numbers` are the design numbers of the stage, accused or not.

    `spread`: of those that are not; as `scales` doubt them where it is not given.
    """
    spread = scales.doubt if spread is None else spread
    accused = {c.name.removeprefix("parameter:") for c in causes if c.effect is None}
    absorbed = {n for c in causes if c.effect is not None for n in c.effect.absorbs}
    kept = [n for n in numbers if n in accused or spread > 0.0]
    spreads = {
        n: ACCUSED_SPREAD if n in accused else max(ABSORBED_SPREAD, spread) if n in absorbed else spread for n in kept
    }
    unknowns = [_number(base.design, n, spreads[n]) for n in kept]
    for cause in causes:
        if cause.form is not None:
            unknowns += _form_unknowns(cause.name, cause.form, scales, cause.present)
    return Space(base, tuple(causes), tuple(kept), tuple(unknowns), scales)


#: By how much of itself a number may be too large at most: a valve may have hardly any backlash.
_LOWEST = {"deadband": 0.999}
#: And too small; a short lag may be ten times as long.
_HIGHEST = {"offset": 1.0, "tau": 9.0, "ep_tau": 9.0}


def _number(design: DesignModel, name: str, spread: float) -> Unknown:
    centre = nominal(design, name)
    size = reference(design, name)
    lowest = -_LOWEST.get(name, 0.9) * centre / size if name != "offset" else -1.0
    highest = _HIGHEST.get(name, 4.0)
    return Unknown(name, centre, size, lowest, highest, spread, 1e-3)


def _form_unknowns(cause: str, form: Form, scales: Scales, present: Sequence[float]) -> list[Unknown]:
    unknowns = []
    for k, p in enumerate(form.parameters):
        size = p.scale * scales.factor(p.kind)
        centre = present[k] if present else p.neutral * scales.factor(p.kind)
        lower, upper = ((bound * scales.factor(p.kind) - centre) / size for bound in (p.lower, p.upper))
        step = 5e-3 if p.smooth else 4e-2
        unknowns.append(Unknown(f"{cause}.{p.name}", centre, size, lower, upper, _spread(p), step, p.smooth))
    return unknowns


def cause_starts(
    cause: Cause, scales: Scales = REFERENCE, records: Sequence[Recording] = (), dense: bool = True
) -> list[FloatArray]:
    """Start vectors of a cause's own unknowns in z; see `form_starts`.

    What the design already has also starts with each of its parameters halved, and larger by half, in turn.
    """
    assert cause.form is not None
    starts = form_starts(cause.form, scales, records, dense)
    if not cause.present:
        return starts
    here = _in_z(cause.form, cause.present, scales)
    sizes = [v / (p.scale * scales.factor(p.kind)) for p, v in zip(cause.form.parameters, cause.present, strict=True)]
    near = [share * size * row for row, size in zip(np.eye(len(sizes)), sizes, strict=True) for share in (-0.5, 0.5)]
    return near + [start - here for start in starts]


def form_starts(
    form: Form, scales: Scales = REFERENCE, records: Sequence[Recording] = (), dense: bool = True
) -> list[FloatArray]:
    """Start vectors of a form's own unknowns in z: every combination of its parameters' starts.

    A parameter to which the response jumps is started densely, if `dense`: its valleys are narrow. A form that reads
    its starts from the `records` is asked first.
    """
    if form.starts_for is not None and records:
        own = form.starts_for(records, scales)
        if own:
            return [_in_z(form, values, scales) for values in own]
    starts: list[list[float]] = [[]]
    for p in form.parameters:
        values = [(s - p.neutral) / p.scale for s in (_dense(p) if dense and not p.smooth else p.starts)]
        starts = [[*head, v] for head in starts for v in values]
    return [np.array(s) for s in starts]


def _in_z(form: Form, values: Sequence[float], scales: Scales) -> FloatArray:
    pairs = zip(form.parameters, values, strict=True)
    return np.array([(v / scales.factor(p.kind) - p.neutral) / p.scale for p, v in pairs])


def _dense(p: Parameter) -> list[float]:
    """Starts of a parameter with narrow valleys: log-spaced over its range of starts where it is a size."""
    low, high = min(p.starts), max(p.starts)
    if not p.size or low <= 0.0:
        return list(p.starts)
    return [float(v) for v in np.geomspace(0.7 * low, min(1.5 * high, p.upper), p.looks)]


def _spread(p: Parameter) -> float:
    """Prior spread of an effect parameter in z: twice its clear size, more where its range lies far from neutral."""
    nearest = min(abs((s - p.neutral) / p.scale) for s in p.starts)
    return max(2.0, 1.5 * nearest)
