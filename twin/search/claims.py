"""What hypotheses claim: how much, which of them say the same, what they had to bend to say it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri

from logs.recording import FloatArray
from twin.fit.fitting import Fit
from twin.fit.space import SHIFTED, Cause
from twin.search.needless import without_needless
from twin.search.score import yardstick_for
from twin.search.screen import Prospect

#: How often chance alone leaves sizes nearer to nothing than what counts as a size.
_SURE = 0.95
#: Mean squared residual over the floor up to which a signal is explained to its noise.
EXACT = 1.1
#: Relative move of a design number from which it is suspected beside laws that explain a signal to its noise; and the
#: standard deviations of its prior that it has to be off by.
NUDGED, _DEVIATIONS = 0.03, 3.0
#: Numbers of a law, at the most.
_LAW = 5
#: A steady gauge shows every little that it is off by.
_CONVERTER = "ep_tau"


def some_of_each(ranked: Sequence[Prospect], causes: int, forms: int) -> list[Prospect]:
    """The first of `ranked`: so many causes, each in its `forms` best forms."""
    kept: dict[str, list[Prospect]] = {}
    for prospect in ranked:
        name = prospect.causes[-1].name
        if name in kept or len(kept) < causes:
            kept.setdefault(name, []).append(prospect)
    return [prospect for some in kept.values() for prospect in some[:forms]]


def size_of(fit: Fit) -> int:
    """How much a hypothesis claims: its effects and accused numbers; wrong numbers alone are one claim together."""
    effects = sum(1 for c in fit.space.causes if c.effect is not None)
    return len(fit.space.causes) if effects else min(len(fit.space.causes), 1)


def hollow(fit: Fit, phi: float) -> bool:
    """Whether an effect of the hypothesis has no size: its sizes together no further from nothing than 95 % of chance.

    Its nuisances then do what it takes the credit for. `phi`: residual samples worth one independent one.
    """
    if not any(c.form is not None for c in fit.space.causes):
        return False
    at, shapes = len(fit.space.numbers), _shapes(fit)
    covariance = phi * max(fit.mse, 1.0) * fit.covariance(without=shapes)
    for cause in fit.space.causes:
        parameters = cause.form.parameters if cause.form is not None else ()
        sizes = [(at + k, p.smooth) for k, p in enumerate(parameters) if p.size]
        at += len(parameters)
        # where the response jumps no slope says how sure a size is
        if sizes and all(smooth for _, smooth in sizes) and _is_nothing(fit, covariance, [k for k, _ in sizes]):
            return True
    return False


def _shapes(fit: Fit) -> list[int]:
    """The unknowns that are no sizes: where there is no effect nobody can know its time constant, nor has to."""
    causes = [c.form.parameters for c in fit.space.causes if c.form is not None]
    return [len(fit.space.numbers) + k for k, p in enumerate([p for some in causes for p in some]) if not p.size]


def _is_nothing(fit: Fit, covariance: FloatArray, which: list[int]) -> bool:
    """Whether these unknowns, each of which may be unsure alone, are together no further from 0 than chance takes them
    in 95 of 100 cases.

    Source: Wald, Trans. Am. Math. Soc. 54 (1943) 426.
    """
    sizes = fit.z[which]
    distance = float(sizes @ np.linalg.pinv(covariance[np.ix_(which, which)]) @ sizes)
    return distance < float(chdtri(len(which), 1.0 - _SURE))


def best_forms(fits: Sequence[Fit], use: np.ndarray, none: Fit) -> list[Fit]:
    """Of the same causes in different forms only the best: a wrong form must not lose to a wrong cause.

    By the yardstick by which causes are compared, too. One that took every residual sample for an independent one would
    choose the form with most numbers, which then loses by them to a wrong cause. `use`: the rows that count;
    `none`: the hypothesis of no cause. A rival from outside that a known form does without is no better one.
    """
    fits = without_needless(fits, none)
    if not fits:
        return []
    ranked = sorted(fits, key=yardstick_for(fits, use).score)
    return list({tuple(sorted(one.names)): one for one in ranked}.values())  # the last of the same causes stays


def suspected(fit: Fit) -> list[tuple[Cause, ...]]:
    """The design numbers that an effect hypothesis had to move far: each one, and all of them."""
    if all(c.effect is None for c in fit.space.causes):
        return []
    moved = sorted(set(shifted(fit, SHIFTED)) | set(nudged(fit)), key=fit.space.numbers.index)
    far = [Cause(f"parameter:{n}") for n in moved if f"parameter:{n}" not in fit.names]
    far = [c for c in far if not same_claim(fit, c)]
    return [*((c,) for c in far), *([tuple(far)] if len(far) > 1 else [])]


def shifted(fit: Fit, far: float) -> list[str]:
    """The design numbers that a hypothesis moves `far`."""
    return [n for n, z in zip(fit.space.numbers, fit.z, strict=False) if abs(z) > far]


def nudged(fit: Fit, floor: float = 1.0) -> list[str]:
    """The design numbers that laws have to move clearly, if less than `SHIFTED`, to leave no more than the noise.

    A wrong form bends numbers and leaves something. Where nothing is left, and no twin of another shape could have bent
    them, they are off themselves. `floor`: mean squared residual of the true model.
    """
    if fit.mse > EXACT * floor or not all(_lawful(c) for c in fit.space.causes):
        return []
    moved = zip(fit.space.numbers, fit.z, fit.space.spreads, strict=False)
    return [n for n, z, spread in moved if abs(z) > max(NUDGED, _DEVIATIONS * spread) and n != _CONVERTER]


def _lawful(cause: Cause) -> bool:
    """Whether a cause is a law of few numbers that nothing else resembles, or a number."""
    if cause.effect is None or cause.form is None:
        return True
    curve = cause.form.free or bool(cause.form.outside) or len(cause.form.parameters) > _LAW
    return not (curve or cause.effect.erratic or cause.effect.same_as.get(cause.form.name))


def same_claim(parent: Fit, cause: Cause) -> bool:
    """Whether a cause has no meaning beside one of the parent."""
    return not all(together(one, cause) for one in parent.space.causes)


def together(one: Cause, other: Cause) -> bool:
    """Whether two causes both mean something: not where one has the other's signature, or absorbs its number."""
    return not (_takes(one, other) or _takes(other, one))


def _takes(a: Cause, b: Cause) -> bool:
    """Whether `b` beside `a` would only mend the form of `a`."""
    if a.effect is None:
        return False
    if b.effect is None:
        return b.name.removeprefix("parameter:") in a.effect.absorbs
    return any(b.name in names for names in a.effect.same_as.values())
