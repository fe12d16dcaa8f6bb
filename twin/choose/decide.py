"""From fitted hypotheses to accepted causes: the fewest causes that explain the gap, or the admission that none does.

A further cause is accepted only if it is significant (tempered log-evidence), material (its share of the gap) and
thorough (it removes most of what the smaller hypothesis left); a wrong form of the right cause leaves a rest, and a
flexible bystander always finds something in that rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from twin.choose.plainer import effects_of, instead_of, plainer
from twin.choose.rules import DecisionRules
from twin.events.teeth import Slips
from twin.fit.fitting import Fit
from twin.fit.space import SHIFTED
from twin.search.claims import EXACT, nudged, shifted, size_of
from twin.search.findings import Findings
from twin.search.reform import bent_by, lays_open, spares_numbers

#: How far a number may be accused to have moved where nobody believes what they all moved together.
_UNBELIEVED = 0.05
#: By how many unknowns a free curve exceeds a law.
FREE = 5
#: Nats by which the accusation of a number has to be ahead that is bent where nothing else is left.
_ACCUSED = 3.0
#: The share of what is a trifle beside a gap that is none where it was all that was left, and many times the noise.
_EXACT_TRIFLE, _PLAINLY = 0.25, 10.0
#: What healthy machines leave with their numbers re-tuned, at most, over the mean of their squares.
_SCATTER = 1.3
#: The true model's mean squared residual is at most so many times that of the likeliest one.
_ABOVE_BEST = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """What a channel says. `rest`: what is left of the excess over the noise, as a share of the excess before.

    `floor`: mean squared residual of the true model. `imitates`: not explained, because the design numbers had to move
    further than anybody believes. `slips`: what was accepted was recognised by its slips (`twin.judge.by_teeth`).
    """

    findings: Findings
    accepted: Fit
    explained: bool
    gap: bool
    rest: float
    floor: float = 1.0
    imitates: bool = False
    slips: Slips | None = None

    @property
    def names(self) -> tuple[str, ...]:
        return self.accepted.names if self.explained else ()

    @property
    def exact(self) -> bool:
        """Whether what was accepted leaves no more than the noise."""
        return self.accepted.mse <= EXACT * self.floor

    def rest_of(self, fit: Fit) -> float:
        """What `fit` leaves of the excess over the noise, as a share of the excess before."""
        return rest_of(self.findings, fit, self.floor)


def decide(findings: Findings, rules: DecisionRules, floor: float = 1.0) -> Decision:
    """Walks up from `none` and accepts larger hypotheses as long as they are worth it.

    `floor` is the mean squared residual of the true model, in units of the noise: above 1 where the driving pressure is
    itself uncertain.
    """
    floor = _likely_floor(findings, floor)
    accepted, instead = findings.none, None
    while (better := _better(findings, accepted, rules, floor)) is not None:
        if accepted is findings.none:
            plain = plainer(findings, better, rules)
            if not _worth(findings, accepted, plain, rules, floor):
                break
            instead, better = (instead_of(findings, better, plain, rules) if plain is not better else None), plain
        elif instead is not None:
            # wrong numbers are not enough: the effect that they were taken for gets its chance
            better, instead = instead, None
        accepted = better
    accepted = _fewer_unknowns(findings, _plainer_member(findings, accepted, rules), rules)
    accepted = _said(findings, accepted, rules)
    far = _UNBELIEVED if _imitates(accepted, rules, floor) else SHIFTED
    accepted = with_numbers(findings, accepted, rules.evidence, far)
    if rules.within == 0.0:  # what a healthy machine differs by from its design bends numbers, too
        accepted = _with(findings, accepted, nudged(accepted, floor), _ACCUSED)
    size = size_of(accepted)
    rest = rest_of(findings, accepted, floor)
    nothing_left = accepted.mse < rules.nothing_left * floor  # as far as the noise itself is known
    imitates = _imitates(accepted, rules, floor)
    enough = size > 0 and (rest < rules.unexplained or nothing_left)
    explained = enough and not imitates
    gap = explained or findings.none.mse > rules.quiet * floor
    return Decision(findings, accepted, explained, gap, rest, floor, enough and imitates)


def _imitates(fit: Fit, rules: DecisionRules, floor: float) -> bool:
    """Whether a hypothesis must bend the numbers beyond belief, and leaves something all the same."""
    return bent_by(fit) > rules.believed and fit.mse > EXACT * floor


def _better(findings: Findings, accepted: Fit, rules: DecisionRules, floor: float) -> Fit | None:
    """A larger hypothesis that is worth it. A pair may be needed before either of its members shows."""
    bigger = [findings.best_of_size(size_of(accepted) + k) for k in (1, 2)]
    return next((f for f in bigger if f is not None and _worth(findings, accepted, f, rules, floor)), None)


def _likely_floor(findings: Findings, floor: float) -> float:
    """The floor, no further above what the likeliest hypothesis leaves than the true one could be."""
    _, likeliest = findings.scored()[0]
    return max(1.0, min(floor, _ABOVE_BEST * likeliest.mse))


def rest_of(findings: Findings, fit: Fit, floor: float) -> float:
    """What `fit` leaves of the excess over the noise, as a share of the excess before (0 where there is none)."""
    before = max(findings.none.mse - floor, 0.0)
    return max(fit.mse - floor, 0.0) / before if before > 0.0 else 0.0


def _plainer_member(findings: Findings, fit: Fit, rules: DecisionRules) -> Fit:
    """`fit`, or the same with a wrong number in place of one effect, if what the effect does better is immaterial."""
    if len(fit.names) < 2:
        return fit
    near = [
        f
        for f in findings.fits
        if len(f.names) == len(fit.names) and f.mse <= fit.mse + rules.plain and len(set(fit.names) - set(f.names)) == 1
    ]
    near = [
        f for f in near if effects_of(f) < effects_of(fit) and findings.score(f) > findings.score(fit) - rules.evidence
    ]
    return max(near, key=findings.score) if near else fit


def _fewer_unknowns(findings: Findings, fit: Fit, rules: DecisionRules) -> Fit:
    """`fit`, or the same with a plain law in place of one free curve, if what the curve does better is immaterial.

    A profile through a dozen points that is a straight line is `spring_asymmetry`; a zero that each recording has of
    its own and that always goes the same way is a drift beside a zero error.
    """
    slack = min(rules.plain, rules.share * (findings.none.mse - 1.0))
    near = [
        f
        for f in findings.fits
        if len(f.space.unknowns) <= len(fit.space.unknowns) - FREE
        and f.mse <= fit.mse + slack
        and (_with_another(f, fit) or (lays_open(f, fit) and findings.score(f) > findings.score(fit) - rules.evidence))
    ]
    return max(near, key=findings.score) if near else fit


def _said(findings: Findings, fit: Fit, rules: DecisionRules) -> Fit:
    """`fit`, or a plainer effect with that number accused which `fit` moves as far without a word.

    A creep with two tails that are both far longer than the records is a gain that is too small, and makes the stem's
    lag its own; it leaves as little as a gain beside another lag.
    """
    effects, moved = effects_of(fit), {f"parameter:{n}" for n in shifted(fit, SHIFTED)}
    if len(fit.names) != 1 or not effects or not moved:
        return fit
    near = [
        f
        for f in findings.fits
        if len(f.names) == 2
        and len(effects_of(f) - effects) == 1
        and set(f.names) - effects_of(f) <= moved
        and len(f.space.unknowns) < len(fit.space.unknowns)
        and f.mse <= fit.mse + rules.plain
        and findings.score(f) > findings.score(fit) + rules.evidence
    ]
    return max(near, key=findings.score) if near else fit


def _with_another(f: Fit, fit: Fit) -> bool:
    """Whether `f` is `fit` with another effect in the place of one cause."""
    other = len(f.names) == len(fit.names) and len(set(fit.names) - set(f.names)) == 1
    return other and bool(effects_of(f) - effects_of(fit))


def with_numbers(findings: Findings, fit: Fit, evidence: float, far: float = SHIFTED) -> Fit:
    """`fit`, or the same effects with the design numbers accused that they had to move `far`.

    A number that rides along as a nuisance leaves no gap to be closed by accusing it; what it pays is its prior.
    """
    return _with(findings, fit, shifted(fit, far), evidence)


def _with(findings: Findings, fit: Fit, numbers: Sequence[str], evidence: float) -> Fit:
    moved, own = {f"parameter:{n}" for n in numbers}, set(fit.names)
    larger = [f for f in findings.fits if own < set(f.names) and set(f.names) - own <= moved]
    best = max(larger, key=findings.score, default=None)
    if best is None or size_of(fit) == 0 or findings.score(best) - findings.score(fit) <= evidence:
        return fit
    return best


def _worth(findings: Findings, small: Fit, large: Fit, rules: DecisionRules, floor: float) -> bool:
    """Whether the larger hypothesis earns its further causes."""
    # where it is known what the healthy machine leaves, nothing is gained by leaving less: a free curve takes of that
    # ... but for readings held by a clock of their own, by which repeats differ and what passes for noise with them
    held = any(c.form is not None and c.form.seen for c in small.space.causes)
    gain = small.mse - (max(large.mse, floor) if rules.within > 0.0 and not held else large.mse)
    before = max(findings.none.mse - floor, 0.0)
    left = max(small.mse - floor, 0.0)
    significant = findings.score(large) - findings.score(small) > rules.evidence
    # three causes are rare: what a third removes of a small rest is what a form that is not quite true had left
    # ... and so is the little that a second one removes beside a large gap, the less so if that leaves nothing
    # ... but for a number, of which no form can be at fault: what it clearly leaves is somebody else's
    numbers = bool(small.space.causes) and not effects_of(small)
    nothing_else = large.mse <= EXACT * floor and small.mse > _PLAINLY * floor
    trifle = (_EXACT_TRIFLE if nothing_else else 1.0) * rules.trifle
    trifle = 0.0 if numbers and small.mse > rules.quiet * floor else trifle
    tidy = gain > max(rules.complete * left, trifle * before) and size_of(large) < 3
    # numbers that nobody believes are part of what the smaller one leaves
    spares = spares_numbers(large, small)
    first = small is findings.none
    # what others leave beyond what any healthy machine does is no healthy machine's
    beyond = not first and small.mse > _SCATTER * rules.within
    least = min(rules.gain, rules.further) if beyond else rules.gain
    material = gain > max(least, floor - 1.0) and (gain > rules.share * before or tidy or spares)
    thorough = first or gain > rules.thorough * left or gain > rules.large_share * before
    # jumps that no model follows leave much, in which a bystander finds something
    if any(c.effect is not None and c.effect.erratic for c in small.space.causes) and large.mse > rules.quiet * floor:
        thorough = thorough and gain > rules.erratic * left
    return significant and material and thorough
