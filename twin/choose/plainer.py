"""Wrong design numbers instead of an effect that does hardly better: the plainer cause wins."""

from __future__ import annotations

from twin.choose.idle import idle
from twin.choose.rules import DecisionRules
from twin.fit.fitting import Fit
from twin.search.claims import hollow, size_of
from twin.search.findings import Findings

#: Noise variances, however large the gap: what numbers leave beyond that has another cause, for they have no form that
#: could be at fault. Of 75 that were right the worst left 1.74 in all (docs/calibration.md).
_MOST = 1.0


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
    if not spares or not effects_of(fit):
        least = _with_further(findings, least, [f for f in alone if f.mse <= fit.mse + rules.gain], rules)
    return least if spares or len(least.names) == 1 else _sparing(findings, fit, least, slack)


def _with_further(findings: Findings, least: Fit, whole: list[Fit], rules: DecisionRules) -> Fit:
    """The numbers `least`, or the fewest of the sets `whole` that hold them and do nearly all that these leave undone.

    Beside a number that is far off, what a second one does is little of the gap, and may be many times the noise.
    """
    larger = [f for f in whole if set(least.names) < set(f.names)]
    least_gain = max(rules.gain, rules.trifle * (findings.none.mse - 1.0))
    enough = [f for f in larger if least.mse - f.mse > max(least_gain, rules.complete * (least.mse - 1.0))]
    enough = [f for f in enough if findings.score(f) - findings.score(least) > rules.evidence]
    return min(enough, key=lambda f: (len(f.names), -findings.score(f)), default=least)


def instead_of(findings: Findings, fit: Fit, plain: Fit, rules: DecisionRules) -> Fit:
    """What gets its chance if the numbers `plain` are not enough: the effect `fit` that they were taken for.

    Or, where it is idle beside the numbers that it brings along, those.
    """
    slack = slack_of(findings, rules)
    more = [
        f for f in findings.fits if set(plain.names) < set(f.names) and not effects_of(f) and f.mse <= fit.mse + slack
    ]
    return max(more, key=findings.score) if more and idle(findings, fit, slack) else fit


def _sparing(findings: Findings, idler: Fit, numbers: Fit, slack: float) -> Fit:
    """The likeliest effect that does as well as an idle one without moving the numbers, or the several `numbers`.

    A gain of an unmeasured pressure moves three numbers at once, and is one cause.
    """
    near = [f for f in findings.fits if size_of(f) == 1 and effects_of(f) and f.mse <= idler.mse + slack]
    near = [f for f in near if findings.score(f) > findings.score(numbers) and not hollow(f, findings.phi)]
    likely = sorted(near, key=findings.score, reverse=True)
    return next((f for f in likely if not idle(findings, f, slack)), numbers)


def slack_of(findings: Findings, rules: DecisionRules) -> float:
    """By how much more of the noise variance a plain hypothesis may leave."""
    return max(rules.plain, min(rules.plain_share * (findings.none.mse - 1.0), _MOST))


def effects_of(fit: Fit) -> set[str]:
    """The names of the effects of a hypothesis, without its numbers."""
    return {c.name for c in fit.space.causes if c.effect is not None}
