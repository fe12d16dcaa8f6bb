"""Who is still in dispute after a diagnosis: the accepted explanation, and each one that could stand in its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from logs.recording import FloatArray
from twin.choose.decide import Decision
from twin.fit.fitting import Fit
from twin.plant import Plant
from twin.stages import StageResult, combined
from twin.verdict import Judgement

#: A cause named with less than this is in dispute even without a confusion set.
SURE = 0.85


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """One explanation. `freedom @ freedom.T`, shape (m, m), is the posterior covariance of its unknowns given the
    records; `others` are what the other channels accepted."""

    name: str
    fit: Fit
    base: Plant
    others: tuple[Fit, ...]
    freedom: FloatArray

    def plant(self, z: FloatArray | None = None) -> Plant:
        """The whole chain as this explanation has it, at its fitted unknowns or at `z`."""
        own = self.fit if z is None else replace(self.fit, z=z)
        return combined(self.base, [*self.others, own])


@dataclass(frozen=True, slots=True, eq=False)
class Dispute:
    """One cause and those that could replace it. `phi`, `excess`: see `twin/next/criterion.py`.

    `alike` are names that no record of these signals could separate from the cause.
    """

    cause: str
    channel: str
    accepted: Rival
    rivals: tuple[Rival, ...]
    alike: tuple[str, ...]
    phi: float
    excess: float


def disputes(result: StageResult, judgement: Judgement) -> list[Dispute]:
    """Every cause of the judgement that is not settled, in the judgement's order."""
    found = []
    sets = {names[0]: names[1:] for names in judgement.confusable}
    for cause in judgement.causes:
        decision = next((d for d in result.decisions if cause.name in d.names), None)
        if decision is None:
            continue
        names = list(sets.get(cause.name, ()))
        if not names and cause.probability < SURE:
            names = _next_best(decision, cause.name)
        if names:
            found.append(_dispute(result, decision, cause.name, names))
    return found


def rival_of(result: StageResult, decision: Decision, fit: Fit, name: str) -> Rival:
    """A fitted hypothesis of one channel with what the other channels accepted."""
    others = tuple(d.accepted for d in result.decisions if d is not decision and d.explained)
    return Rival(name, fit, result.case.base, others, _freedom(fit, decision.findings.phi))


def _dispute(result: StageResult, decision: Decision, cause: str, names: Sequence[str]) -> Dispute:
    kept = set(decision.names) - {cause}
    alike = [name for name in names if name in _same(decision.accepted, cause)]
    rivals = []
    for name in names:
        same = [f for f in decision.findings.fits if set(f.names) in (kept | {name}, {name}) and name not in alike]
        if same:
            # the whole hypothesis with the name in the cause's place, or else the name alone
            best = min(same, key=lambda f: (-len(f.names), f.mse))
            rivals.append(rival_of(result, decision, best, name))
    return Dispute(
        cause=cause,
        channel=decision.findings.channel.name,
        accepted=rival_of(result, decision, decision.accepted, cause),
        rivals=tuple(rivals),
        alike=tuple(alike),
        phi=decision.findings.phi,
        excess=max(decision.accepted.mse, 1.0),
    )


def _same(accepted: Fit, name: str) -> tuple[str, ...]:
    """Effects that the accepted form of a cause cannot be told from by any record."""
    cause = next(c for c in accepted.space.causes if c.name == name)
    if cause.effect is None or cause.form is None:
        return ()
    return tuple(cause.effect.same_as.get(cause.form.name, ()))


def _next_best(decision: Decision, name: str) -> list[str]:
    """What the best hypothesis of the same size without the cause has instead."""
    size = len(decision.names)
    others = [f for f in decision.findings.fits if len(f.names) == size and name not in f.names]
    if not others:
        return []
    best = max(others, key=decision.findings.score)
    return [n for n in best.names if n not in decision.names]


def _freedom(fit: Fit, phi: float) -> FloatArray:
    """A root of the posterior covariance of the unknowns: the records, as far as they are believed, and the prior."""
    if not fit.z.size:
        return np.zeros((0, 0))
    prior = np.diag(fit.space.spreads**-2.0)
    if not np.any(fit.normal):
        return np.diag(fit.space.spreads)
    information = (fit.normal - prior) / (phi * max(fit.mse, 1.0)) + prior
    values, vectors = np.linalg.eigh(0.5 * (information + information.T))
    root: FloatArray = vectors / np.sqrt(np.maximum(values, 1e-6 * max(float(values[-1]), 1e-12)))
    return root
