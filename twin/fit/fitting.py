"""Fits one hypothesis to one channel: the best starts of a coarse look, each refined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice

import numpy as np

from logs.recording import FloatArray, Recording
from twin.fit.channel import Channel
from twin.fit.contest import followed, ranked, rough_unknowns
from twin.fit.larger_steps import Look
from twin.fit.least_squares import Minimum, descend, minimise
from twin.fit.space import Space, cause_starts
from twin.model.plant import Plant

#: How far off, in z, wrong numbers are also looked for: from their nominals the way may lead through a worse fit.
_FAR = {
    "deadband": (-0.6, 0.6),
    "offset": (-0.25, 0.25),
    "rate_limit": (-0.65, -0.45, 0.45),  # of one that was never met, only what lies below the fastest motion shows
    "tau": (-0.4, 0.4),
    "ep_tau": (-0.5, 0.5),
}
#: Shares of what the commands cover, by which a wider deadband is looked for, too: from one that is wider than that, in
#: which the stem never moves, no way leads back.
_OF_COMMANDS = (0.3, 0.7)
#: Sum of squares, noise = 1.
_CLEARLY = 9.0


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A fitted hypothesis. `mse` is the mean squared residual in units of the noise variance; `prior` its penalty."""

    space: Space
    z: FloatArray
    mse: float
    prior: float
    residuals: FloatArray
    normal: FloatArray
    evaluations: int

    @property
    def plant(self) -> Plant:
        return self.space.plant(self.z)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(c.name for c in self.space.causes)

    def values(self) -> FloatArray:
        """The unknowns in their units."""
        return np.array([u.centre + u.unit * v for u, v in zip(self.space.unknowns, self.z, strict=True)])

    def covariance(self, without: Sequence[int] = ()) -> FloatArray:
        """Of the unknowns in z, for residuals of their nominal noise; shape (unknowns, unknowns).

        Those in `without` are taken as known.
        """
        normal = self.normal + np.diag(1e-9 * np.maximum(np.diag(self.normal), 1e-9))
        normal[list(without)] = normal[:, list(without)] = 0.0
        return np.asarray(np.linalg.pinv(normal)) if self.z.size else np.zeros((0, 0))

    def deviations(self, scale: float = 1.0) -> FloatArray:
        """Standard deviations of the unknowns in their units, for residuals `scale` times their nominal noise."""
        units = np.abs([u.unit for u in self.space.unknowns])
        deviations: FloatArray = scale * np.sqrt(np.maximum(np.diag(self.covariance()), 0.0)) * units
        return deviations

    def errors(self, excess: float) -> FloatArray:
        """Standard errors of the unknowns in their units, where the sum of residuals over a slope scatters `excess`
        times as much (as a variance) as independent ones of their nominal noise would.

        The prior is as sure as it says: it counts once. But the fit has weighed the data against it as if they were
        independent, and so the error is that of this estimate (a sandwich), and not the spread that data of less weight
        would leave: where both say as much and `excess` is 50 that is 3.6 times too narrow.
        Source: Huber, Proc. 5th Berkeley Symp. 1 (1967) 221.
        """
        if not self.z.size:
            return np.zeros(0)
        prior = np.diag(self.space.spreads**-2.0)
        normal = self.normal if np.any(self.normal) else prior
        bread = np.linalg.pinv(normal, hermitian=True)
        variances = np.diag(bread @ (excess * (normal - prior) + prior) @ bread)
        errors: FloatArray = np.sqrt(np.maximum(variances, 0.0)) * np.abs([u.unit for u in self.space.unknowns])
        return errors


def fit(
    channel: Channel,
    space: Space,
    starts: Sequence[FloatArray],
    *,
    rounds: int = 12,
    refine: int = 1,
    weights: FloatArray | None = None,
    anchor: tuple[FloatArray, FloatArray] | None = None,
    look: Look | None = None,
) -> Fit:
    """Fits `space` from the best `refine` of the `starts` (vectors in z). `weights` (0..1 per row) holds rows out.

    `anchor`: where the unknowns are believed to be (z) and how surely (standard deviations in z); their prior, no
    narrower than ever, stands there too. `look`: where starts are compared and slopes taken, if nothing is weighed.
    """
    spreads = space.spreads
    root = None if weights is None else np.sqrt(weights)
    centre = np.zeros_like(spreads) if anchor is None else anchor[0]

    def residuals(z: FloatArray) -> FloatArray:
        r = channel.residuals(space.plant(z))
        held = [] if anchor is None else [(z - anchor[0]) / anchor[1]]
        return np.concatenate([r if root is None else r * root, (z - centre) / spreads, *held])

    quick = look if look is not None and look.larger else None
    about = partial(quick.slopes, space) if quick else None
    compared = partial(quick.residuals, space) if quick else residuals
    in_order = ranked(compared, starts)
    first = followed(compared, space, in_order, refine)
    others = [*_in_motion(channel, space, first, in_order[refine:]), *_slower(space, first, in_order[refine:])]
    rough = rough_unknowns(space)
    minima = []
    for start in [*first, *others]:
        z = descend(residuals, start, rough, space.lower, space.upper) if rough.size else start
        minima.append(minimise(residuals, z, space.lower, space.upper, space.steps, rounds, about))
    # what was looked for further off has to be better by more than noise makes a number that does not matter
    best = minima[min(range(len(minima)), key=lambda k: minima[k].cost + (_CLEARLY if k >= refine else 0.0))]
    return _finished(channel, space, best, weights, sum(m.evaluations for m in minima) + len(starts))


def evaluated(channel: Channel, space: Space, z: FloatArray) -> Fit:
    """The hypothesis as it is at `z`, without a fit: it knows no errors of its unknowns."""
    residuals = channel.residuals(space.plant(z))
    mse = float(residuals @ residuals) / max(channel.rows, 1)
    return Fit(space, z, mse, float(np.sum((z / space.spreads) ** 2)), residuals, np.zeros((z.size, z.size)), 1)


def _in_motion(
    channel: Channel, space: Space, first: Sequence[FloatArray], others: Sequence[FloatArray]
) -> list[FloatArray]:
    """The best of the `others` in which something moves, where it does in none of the `first`.

    A model that never moves may well be off by less than one that moves by too much, and no way leads on from there.
    """
    if not others or not all(channel.stands(space.plant(z)) for z in first):
        return []
    return list(islice((z for z in others if not channel.stands(space.plant(z))), 1))


def _slower(space: Space, first: Sequence[FloatArray], others: Sequence[FloatArray]) -> list[FloatArray]:
    """The best of the `others` with a rate limit below the design's, where none of the `first` has one.

    A limit that is never met makes no difference, so that no way leads from there to one that is.
    """
    if "rate_limit" not in space.numbers:
        return []
    at = space.numbers.index("rate_limit")
    lower = (z for z in others if z[at] < 0.0)
    return [] if any(z[at] < 0.0 for z in first) else list(islice(lower, 1))


def _finished(channel: Channel, space: Space, best: Minimum, weights: FloatArray | None, used: int) -> Fit:
    data = best.residuals[: channel.use.size]
    prior = float(np.sum((best.z / space.spreads) ** 2))
    rows = channel.rows if weights is None else float(np.sum(weights * channel.use))
    return Fit(space, best.z, float(data @ data) / max(rows, 1.0), prior, data, best.normal, used)


def starts_of(space: Space, known: Sequence[Fit] = (), records: Sequence[Recording] = ()) -> list[FloatArray]:
    """Start vectors of a space: design numbers at their nominals, effects at each of their starts.

    Causes that one of the `known` fits has in the same form start where it ended (the first that has it counts), and
    the design numbers start as in the first of them. A form may read its starts from the `records`.
    """
    heads = _number_starts(space, known[0].space.numbers if known else (), records)
    for cause in space.causes:
        if cause.form is None:
            continue
        block = next((b for f in known if (b := _known_block(f, cause.name, cause.form.name)) is not None), None)
        options = cause_starts(cause, space.scales, records) if block is None else [block]
        heads = [np.concatenate([head, option]) for head in heads for option in options]
    if known:
        for head in heads:
            copy_numbers(head, space, known[0])
    return heads


def _number_starts(space: Space, given: Sequence[str], records: Sequence[Recording]) -> list[FloatArray]:
    """Design numbers at their nominals; where nothing but they stand accused, they also start far off.

    A design that is wrong enough never moves, and then no small change of its numbers makes a difference. Those that
    are `given` a start elsewhere need none here: each combination is looked at once.
    """
    heads = [np.zeros(len(space.numbers))]
    if any(cause.form is not None for cause in space.causes):
        return heads
    accused = {c.name.removeprefix("parameter:") for c in space.causes} or set(space.numbers)
    for name, far in _FAR.items():
        if name in accused and name not in given:
            at = space.numbers.index(name)
            near = _within_commands(space, at, max(far), records) if name == "deadband" else ()
            heads = [_moved(head, at, z) for head in heads for z in (0.0, *near, *far)]
    return heads


def _within_commands(space: Space, at: int, far: float, records: Sequence[Recording]) -> tuple[float, ...]:
    """How much wider a deadband may be, in z of unknown `at`, that is well below `far` and shows in the records."""
    covered = max((float(np.ptp(r.command)) for r in records), default=0.0) / abs(space.unknowns[at].unit)
    return tuple(share * covered for share in _OF_COMMANDS if 0.02 < share * covered < 0.7 * far)


def _moved(head: FloatArray, at: int, z: float) -> FloatArray:
    moved = head.copy()
    moved[at] = z
    return moved


def _known_block(known: Fit, name: str, form: str) -> FloatArray | None:
    at = len(known.space.numbers)
    for cause in known.space.causes:
        if cause.form is None:
            continue
        count = len(cause.form.parameters)
        if cause.name == name and cause.form.name == form:
            return known.z[at : at + count]
        at += count
    return None


def copy_numbers(head: FloatArray, space: Space, known: Fit) -> None:
    """The design numbers of a start vector as they ended in another fit, as far as that has them."""
    for k, name in enumerate(space.numbers):
        if name in known.space.numbers:
            head[k] = known.z[known.space.numbers.index(name)]
