"""Pairs of effects in other forms than those that did best alone.

Alone an effect takes the form that also imitates some of what the other one does; beside the other it may be wrong, and
from there no change of a single form leads to the true pair.
"""

from __future__ import annotations

from collections.abc import Sequence

from twin.fit.fitting import Fit
from twin.fit.space import Cause
from twin.model.effect import Form
from twin.search.screen import Prospect

#: A hypothesis, and what one more cause makes of it.
Beyond = tuple[Fit, list[tuple[Cause, ...]]]

#: Squares of the design numbers' moves, in their priors' deviations, that nobody believes; and the share of them that a
#: larger hypothesis may need to count as sparing the numbers.
_BENT, _STRAIGHTER = 50.0, 0.2


def exactly(causes: Sequence[Cause]) -> frozenset[tuple[str, str]]:
    """A hypothesis by its causes and their forms."""
    return frozenset((c.name, c.form.name if c.form else "") for c in causes)


def bent_by(one: Fit) -> float:
    """How far a hypothesis moves the design numbers: squares of their priors' standard deviations."""
    count = len(one.space.numbers)
    moved = one.z[:count] / one.space.spreads[:count]
    return float(moved @ moved)


def spares_numbers(more: Fit, less: Fit) -> bool:
    """Whether without a further cause the numbers have to do what nobody believes, and with it hardly anything."""
    return bent_by(less) > _BENT and bent_by(more) < _STRAIGHTER * bent_by(less)


def in_laws(one: Fit, causes: Sequence[Cause]) -> list[tuple[Cause, ...]]:
    """A hypothesis with one effect that a curve hides which each recording has of its own, with a law for that curve,
    and in its place. What a free curve hides is looked for like any pair.

    `causes`: all candidates in all forms.
    """
    found = []
    for curve, hides in _hiding(one.space.causes):
        if curve.form is None or not curve.form.apart:
            continue
        rest = [c for c in one.space.causes if c is not curve]
        laws = [c for c in causes if c.name == curve.name and c.form and not (c.form.apart or c.form.outside)]
        hidden = [c for c in causes if c.name in hides and c.name not in one.names]
        found += [(*rest, other) for other in hidden]
        found += [(*rest, law, other) for law in laws for other in hidden]
    return found


def lays_open(larger: Fit, one: Fit) -> bool:
    """Whether `larger` has what a curve of `one` hides, and nothing else more."""
    more = set(larger.names) - set(one.names)
    hidden = {name for _, hides in _hiding(one.space.causes) for name in hides}
    return set(one.names) < set(larger.names) and len(more) == 1 and more <= hidden


def _hiding(causes: Sequence[Cause]) -> list[tuple[Cause, tuple[str, ...]]]:
    """Those of the causes that are curves, with the effects that they hide."""
    return [(c, c.effect.hides) for c in causes if c.effect and c.form and curved(c.form) and not c.form.outside]


def curved(form: Form) -> bool:
    """Whether a form is no law, but a free curve, or one of each recording's own."""
    return form.free or form.apart > 0


def in_other_forms(pairs: Sequence[Fit], tried: Sequence[Fit], most: int) -> list[list[Beyond]]:
    """For each of the best `most` of the pairs of effects: one effect alone in each of its forms, with the other effect
    in every form beside it, as far as `pairs` does not have them. `tried`: all causes alone in all forms.

    The effect with fewer forms goes first: there is one look for each.
    """
    known = {exactly(f.space.causes) for f in pairs}
    found = []
    effects = [f for f in pairs if all(c.form is not None for c in f.space.causes)]
    for pair in sorted(effects, key=lambda f: f.mse)[:most]:
        alone = [[f for f in tried if f.names == (name,)] for name in pair.names]
        first, second = sorted(alone, key=len)
        both = [(one, [(*one.space.causes, *other.space.causes) for other in second]) for one in first]
        new = [(one, [causes for causes in some if exactly(causes) not in known]) for one, some in both]
        found.append([(one, some) for one, some in new if some])
    return [some for some in found if some]


def least_left(looked: Sequence[Prospect], most: int) -> list[Prospect]:
    """Of each pair of causes the `most` forms that promise to leave least.

    A full fit of each cost half of a hard search (docs/decisions/large-records.md).
    """
    kept: dict[frozenset[str], list[Prospect]] = {}
    for one in sorted(looked, key=lambda p: p.left):
        kept.setdefault(frozenset(c.name for c in one.causes), []).append(one)
    return [one for some in kept.values() for one in some[:most]]


def better_of_each(fits: Sequence[Fit]) -> list[Fit]:
    """Of fits of the same hypothesis the better one, where the first of them stood."""
    best: dict[frozenset[tuple[str, str]], Fit] = {}
    for one in fits:
        key = exactly(one.space.causes)
        best[key] = min(best.get(key, one), one, key=lambda f: f.mse)
    return list(best.values())
