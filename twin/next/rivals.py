"""Who is still in dispute after a diagnosis: the accepted explanation, and each one that could stand in its place."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from logs.recording import FloatArray
from twin.choose.decide import Decision
from twin.choose.stages import StageResult, combined
from twin.choose.weigh import comparable
from twin.fit.fitting import Fit
from twin.judge.verdict import Judgement
from twin.model.plant import Plant

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

    `alike` are names that no record of these signals could separate from the cause. `runner_up`: the rival is in no
    confusion set, because these records make it far less likely; it is only what comes next.
    """

    cause: str
    channel: str
    accepted: Rival
    rivals: tuple[Rival, ...]
    alike: tuple[str, ...]
    phi: float
    excess: float
    runner_up: bool = False

    @property
    def caveat(self) -> str:
        """What to say of rivals that are no rivals of the same rank, to be put behind a sentence; else nothing."""
        if not self.runner_up:
            return ""
        names = " and ".join(rival.name.removeprefix("parameter:").replace("_", " ") for rival in self.rivals)
        return f" (These records already make {names} far less likely; it only comes next.)"


def disputes(result: StageResult, judgement: Judgement) -> list[Dispute]:
    """Every cause of the judgement that is not settled, in the judgement's order."""
    found = []
    sets: dict[str, list[str]] = {}
    for first, *others in judgement.confusable:
        known = sets.setdefault(first, [])
        known += [name for name in others if name not in known]
    rejected = {n for d in result.decisions for n in d.names} - {cause.name for cause in judgement.causes}
    for cause in judgement.causes:
        decision = next((d for d in result.decisions if cause.name in d.names), None)
        if decision is None:
            continue
        names = sets.get(cause.name, [])
        if names:
            found.append(_dispute(result, decision, cause.name, names))
        elif cause.probability < SURE and (names := _next_best(decision, cause.name, rejected)):
            found.append(replace(_dispute(result, decision, cause.name, names), runner_up=True))
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


def _next_best(decision: Decision, name: str, rejected: Collection[str]) -> list[str]:
    """What the best hypothesis with one other cause in the place of this one has there.

    Only of those that were weighed against it, as for a confusion set; none that was `rejected` on unseen rows.
    """
    kept = set(decision.names) - {name}
    places = [(f, set(f.names) - kept) for f in comparable(decision) if kept < set(f.names) and name not in f.names]
    others = [(f, other) for f, (other, *more) in ((f, sorted(new)) for f, new in places) if not more]
    others = [(f, other) for f, other in others if other not in rejected]
    return [max(others, key=lambda pair: decision.findings.score(pair[0]))[1]] if others else []


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
