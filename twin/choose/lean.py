"""Accuses the design number on whose re-tuning accepted effects lean.

The design numbers follow within their priors, so that an effect is not blamed for a small slip of a number. But when
the effects leave a good part of the gap with all numbers as the design has them, then it is a number that explains this
part, however little it had to move, and to name the effects only would be half of the answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.numbers import nominal
from twin.fit.space import SHIFTED, Cause, make_space
from twin.model.effect import Scales
from twin.search.claims import same_claim, size_of

#: Share of the gap that the effects leave without the numbers; and at least so many times the noise variance.
_SHARE, _LEAST = 0.25, 0.5
#: Mean squared residual, of the true model's, up to which the effects' forms are right enough to judge numbers beside.
_RIGHT = 1.5
_ROUNDS = 8
#: Share of a number by which it has to move, where an effect has it, to be another one; and so much of a lag, where it
#: has moved by so many times all that the effect takes itself.
_ANOTHER = 0.5
_SLOWER, _OUTRUN = 0.03, 3.0


def leaning(decision: Decision, scales: Scales, rules: DecisionRules) -> Decision:
    """The decision with the number accused that its effects cannot do without.

    Where as many causes, that lean on no number, explain the gap as well, these are accepted instead. Numbers that
    nobody is sure of are not accused.
    """
    accepted = decision.accepted
    if scales.doubt > SHIFTED or not decision.explained or all(c.effect is None for c in accepted.space.causes):
        return decision
    if accepted.mse > _RIGHT * decision.floor:
        return decision
    lean = _Leaning(decision, scales)
    needed = lean.needed()
    upright = None if needed is None else _upright(decision, scales, rules)
    if upright is not None:
        return upright
    needed = needed or lean.carried()
    if needed is None:
        return decision
    causes = (*accepted.space.causes, needed)
    accused = _fitted(decision, causes, accepted.space.numbers, scales)
    findings = replace(decision.findings, fits=(*decision.findings.fits, accused))
    return replace(decision, findings=findings, accepted=accused, rest=decision.rest_of(accused))


def _upright(decision: Decision, scales: Scales, rules: DecisionRules) -> Decision | None:
    """The decision for other causes, as many and as likely, that need no number; None where there are none."""
    findings, accepted = decision.findings, decision.accepted
    least = findings.score(accepted) - rules.evidence
    rivals = [f for f in findings.fits if size_of(f) == size_of(accepted) and set(f.names) != set(accepted.names)]
    near = [f for f in rivals if f.mse <= accepted.mse + rules.plain and findings.score(f) > least]
    for rival in sorted(near, key=findings.score, reverse=True):
        other = replace(decision, accepted=rival, rest=decision.rest_of(rival))
        if _Leaning(other, scales).needed() is None:
            return other
    return None


@dataclass(frozen=True, slots=True)
class _Leaning:
    decision: Decision
    scales: Scales

    def needed(self) -> Cause | None:
        """The number that makes up for all the others, as designed; None where none is needed, or more than one."""
        accepted = self.decision.accepted
        spare = [Cause(f"parameter:{n}") for n in accepted.space.numbers if f"parameter:{n}" not in accepted.names]
        spare = [c for c in spare if not same_claim(accepted, c)]
        if not spare or not self._left(self._with([])):
            return None
        best = min(spare, key=lambda c: self._with([c]).mse)
        return None if self._left(self._with([best])) else best

    def carried(self) -> Cause | None:
        """A number that an effect makes its own, and that is another one by now; None where there is none.

        A spread of breakaways has a deadband of its own, which may be all that it has of a valve designed without one.
        And a second lag of 0.02 s makes no stem 0.2 s quicker: that is a wrong lag beside it.
        """
        accepted, base = self.decision.accepted, self.decision.accepted.space.base.design
        own = {n for c in accepted.space.causes if c.effect is not None for n in c.effect.absorbs}
        accused = {n.removeprefix("parameter:") for n in accepted.names}
        for name in sorted(own.intersection(accepted.space.numbers) - accused):  # in the same order every time
            before, after = nominal(base, name), nominal(accepted.plant.design, name)
            another = abs(after - before) > _ANOTHER * abs(before)
            if (another or self._outrun(name, before, after)) and self._left(
                as_designed(self.decision, self.scales, but=name)
            ):
                return Cause(f"parameter:{name}")
        return None

    def _outrun(self, name: str, before: float, after: float) -> bool:
        """Whether a lag has moved by far more than the effects take that have it."""
        fit, at, taken_s = self.decision.accepted, len(self.decision.accepted.space.numbers), 0.0
        for cause in fit.space.causes:
            parameters = cause.form.parameters if cause.form is not None else ()
            sizes = zip(parameters, fit.values()[at:], strict=False)
            if cause.effect is not None and name in cause.effect.absorbs:
                taken_s += sum(abs(value) for p, value in sizes if p.kind == "time" and p.size)
            at += len(parameters)
        moved = abs(after - before)
        return taken_s > 0.0 and moved > max(_OUTRUN * taken_s, _SLOWER * abs(before))

    def _with(self, more: Sequence[Cause]) -> Fit:
        return as_designed(self.decision, self.scales, more)

    def _left(self, one: Fit) -> bool:
        """Whether much of the gap is left."""
        decision = self.decision
        gap = decision.findings.none.mse - decision.floor
        return one.mse - decision.accepted.mse > max(_SHARE * gap, _LEAST)


def as_designed(decision: Decision, scales: Scales, more: Sequence[Cause] = (), but: str = "") -> Fit:
    """The accepted causes, and `more`, with every number as designed that none of them accuses or absorbs.

    And that which they absorb `but` which is to be as designed, too.
    """
    causes = (*decision.accepted.space.causes, *more)
    numbers = {c.name.removeprefix("parameter:") for c in causes if c.effect is None}
    absorbed = {n for c in causes if c.effect is not None for n in c.effect.absorbs}
    kept = [n for n in decision.accepted.space.numbers if n in numbers or n in absorbed - {but}]
    return _fitted(decision, causes, kept, scales)


def _fitted(decision: Decision, causes: Sequence[Cause], numbers: Sequence[str], scales: Scales) -> Fit:
    accepted = decision.accepted
    space = make_space(accepted.space.base, causes, numbers, scales)
    return fit(decision.findings.channel, space, starts_of(space, [accepted]), rounds=_ROUNDS)
