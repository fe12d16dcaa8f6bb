"""From fitted hypotheses to accepted causes: the fewest causes that explain the gap, or the admission that none does.

A further cause is accepted only if it is significant (tempered log-evidence), material (its share of the gap) and
thorough (it removes most of what the smaller hypothesis left); a wrong form of the right cause leaves a rest, and a
flexible bystander always finds something in that rest.
"""

from __future__ import annotations

from dataclasses import dataclass

from twin.choose.claims import hollow, size_of
from twin.choose.findings import Findings
from twin.choose.idle import idle
from twin.choose.reform import bent_by, lays_open
from twin.fit.fitting import Fit
from twin.fit.space import SHIFTED

#: Squares of the design numbers' moves, in their priors' deviations, that nobody believes; and the share of them that a
#: larger hypothesis may need to count as sparing the numbers.
_BENT, _STRAIGHTER = 50.0, 0.2
#: By how many unknowns a free curve exceeds a law.
_FREE = 5
#: Mean squared residual over the floor up to which a signal is explained to its noise.
_EXACT = 1.1
#: What healthy machines leave with their numbers re-tuned, at most, over the mean of their squares.
_SCATTER = 1.3
#: The true model's mean squared residual is at most so many times that of the likeliest one.
_ABOVE_BEST = 1.5


@dataclass(frozen=True, slots=True)
class DecisionRules:
    """Thresholds, chosen on the calibration bank and never on published blind trials (docs/calibration.md).

    Gains are in units of the noise variance: 1 means as large as the noise itself. `gain` is raised to what a healthy
    machine leaves, where that is known; `further` is what a cause beside others has to gain where they leave more.
    `share` of the gap is what a further cause has to explain, or, if it explains nearly all of the rest, `trifle`.
    """

    gain: float = 0.15
    further: float = 0.15
    evidence: float = 12.0
    share: float = 0.02
    trifle: float = 0.0005
    thorough: float = 0.55
    complete: float = 0.8
    erratic: float = 0.7
    large_share: float = 0.2
    unexplained: float = 0.2
    nothing_left: float = 1.15
    plain: float = 0.05
    plain_share: float = 0.005
    quiet: float = 2.0
    within: float = 0.0  # mean squared residual that the healthy machine leaves, where that is known (`Margin`)


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """What a channel says. `rest`: what is left of the excess over the noise, as a share of the excess before.

    `floor`: mean squared residual of the true model.
    """

    findings: Findings
    accepted: Fit
    explained: bool
    gap: bool
    rest: float
    floor: float = 1.0

    @property
    def names(self) -> tuple[str, ...]:
        return self.accepted.names if self.explained else ()

    @property
    def exact(self) -> bool:
        """Whether what was accepted leaves no more than the noise."""
        return self.accepted.mse <= _EXACT * self.floor

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
            instead, better = (better if plain is not better else None), plain
        elif instead is not None:
            # wrong numbers are not enough: the effect that they were taken for gets its chance
            better, instead = instead, None
        accepted = better
    accepted = _fewer_unknowns(findings, _plainer_member(findings, accepted, rules), rules)
    accepted = _with_numbers(findings, accepted, rules)
    size = size_of(accepted)
    rest = rest_of(findings, accepted, floor)
    nothing_left = accepted.mse < rules.nothing_left * floor  # as far as the noise itself is known
    explained = size > 0 and (rest < rules.unexplained or nothing_left)
    gap = explained or findings.none.mse > rules.quiet * floor
    return Decision(findings, accepted, explained, gap, rest, floor)


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


def plainer(findings: Findings, fit: Fit, rules: DecisionRules) -> Fit:
    """Wrong design numbers alone instead of `fit`, if what `fit` does better is immaterial: the plainer cause wins.

    So is whatever it does better than the healthy machine would.
    Several numbers are no plainer than one effect: they have to have the better evidence too, unless the effect is
    idle beside the numbers that it brings along. Its place is another's, then, that spares the numbers their moves.
    """
    if size_of(fit) > 1:
        return fit
    slack = slack_of(findings, rules)
    alone = [f for f in findings.fits if f.names and all(c.effect is None for c in f.space.causes)]
    near = [f for f in alone if f.mse <= max(fit.mse + slack, rules.within)]
    spares = not idle(findings, fit, slack)
    if spares:
        near = [f for f in near if len(f.names) == 1 or findings.score(f) >= findings.score(fit)]
    if not near:
        return fit
    least = min(near, key=lambda f: (len(f.names), -findings.score(f)))
    # a further number has to be worth as much as any further cause
    fewer = [f for f in alone if set(f.names) < set(least.names) and f.mse <= least.mse + rules.gain]
    least = min(fewer, key=lambda f: (len(f.names), -findings.score(f)), default=least)
    return least if spares or len(least.names) == 1 else _sparing(findings, fit, least, slack)


def _sparing(findings: Findings, idler: Fit, numbers: Fit, slack: float) -> Fit:
    """The likeliest effect that does as well as an idle one without moving the numbers, or the several `numbers`.

    A gain of an unmeasured pressure moves three numbers at once, and is one cause.
    """
    near = [f for f in findings.fits if size_of(f) == 1 and _effects(f) and f.mse <= idler.mse + slack]
    near = [f for f in near if findings.score(f) > findings.score(numbers) and not hollow(f, findings.phi)]
    likely = sorted(near, key=findings.score, reverse=True)
    return next((f for f in likely if not idle(findings, f, slack)), numbers)


def slack_of(findings: Findings, rules: DecisionRules) -> float:
    """By how much more of the noise variance a plain hypothesis may leave."""
    return max(rules.plain, rules.plain_share * (findings.none.mse - 1.0))


def _plainer_member(findings: Findings, fit: Fit, rules: DecisionRules) -> Fit:
    """`fit`, or the same with a wrong number in place of one effect, if what the effect does better is immaterial."""
    if len(fit.names) < 2:
        return fit
    near = [
        f
        for f in findings.fits
        if len(f.names) == len(fit.names) and f.mse <= fit.mse + rules.plain and len(set(fit.names) - set(f.names)) == 1
    ]
    near = [f for f in near if _effects(f) < _effects(fit) and findings.score(f) > findings.score(fit) - rules.evidence]
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
        if len(f.space.unknowns) <= len(fit.space.unknowns) - _FREE
        and f.mse <= fit.mse + slack
        and (_with_another(f, fit) or lays_open(f, fit))
    ]
    return max(near, key=findings.score) if near else fit


def _with_another(f: Fit, fit: Fit) -> bool:
    """Whether `f` is `fit` with another effect in the place of one cause."""
    other = len(f.names) == len(fit.names) and len(set(fit.names) - set(f.names)) == 1
    return other and bool(_effects(f) - _effects(fit))


def _effects(fit: Fit) -> set[str]:
    return {c.name for c in fit.space.causes if c.effect is not None}


def _with_numbers(findings: Findings, fit: Fit, rules: DecisionRules) -> Fit:
    """`fit`, or the same effects with the design numbers accused that they had to move far.

    A number that rides along as a nuisance leaves no gap to be closed by accusing it; what it pays is its prior.
    """
    moved = {f"parameter:{n}" for n, z in zip(fit.space.numbers, fit.z, strict=False) if abs(z) > SHIFTED}
    own = set(fit.names)
    larger = [f for f in findings.fits if own < set(f.names) and set(f.names) - own <= moved]
    best = max(larger, key=findings.score, default=None)
    if best is None or size_of(fit) == 0 or findings.score(best) - findings.score(fit) <= rules.evidence:
        return fit
    return best


def _worth(findings: Findings, small: Fit, large: Fit, rules: DecisionRules, floor: float) -> bool:
    """Whether the larger hypothesis earns its further causes."""
    # where it is known what the healthy machine leaves, nothing is gained by leaving less: a free curve takes of that
    gain = small.mse - (max(large.mse, floor) if rules.within > 0.0 else large.mse)
    before = max(findings.none.mse - floor, 0.0)
    left = max(small.mse - floor, 0.0)
    significant = findings.score(large) - findings.score(small) > rules.evidence
    # three causes are rare: what a third removes of a small rest is what a form that is not quite true had left
    # ... and so is the little that a second one removes beside a large gap
    tidy = gain > max(rules.complete * left, rules.trifle * before) and size_of(large) < 3
    # numbers that nobody believes are part of what the smaller one leaves
    spares = bent_by(small) > _BENT and bent_by(large) < _STRAIGHTER * bent_by(small)
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
