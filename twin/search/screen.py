"""Which further causes are worth a full fit: a look at each from where the smaller hypothesis ended.

One simulation per start of the further cause gives the direction in which it moves the residual; what is left of that
direction once the unknowns of the smaller hypothesis have followed tells how much of the squares the cause could take
away. Exact where the response is linear in the cause's size, and good enough elsewhere to leave most causes out.
Source: the score (gradient) test, Rao, Proc. Cambridge Phil. Soc. 44 (1948) 50.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from logs.recording import FloatArray
from twin.fit.channel import Channel
from twin.fit.fitting import Fit, starts_of
from twin.fit.larger_steps import Look
from twin.fit.least_squares import jacobian
from twin.fit.space import Cause, Space, cause_starts, make_space
from twin.model.plant import Plant

#: Starts of a form that are looked at besides the one where it ended alone; forms with more are looked at there only.
_MOST_STARTS = 24
#: Sizes about the best start at which a form whose response jumps is looked at once more: its valleys are narrow.
_ZOOM = (0.6, 0.7, 0.8, 0.9, 1.12, 1.25, 1.4)
#: The size of a cause is taken to be at most so many times that of the start.
_LARGEST = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class Prospect:
    """A hypothesis with the start that promises most, and by how much it would lower the sum of squares `before`."""

    causes: tuple[Cause, ...]
    space: Space
    start: FloatArray
    gain: float
    before: float

    @property
    def own(self) -> FloatArray:
        """Where the unknowns of the last cause start."""
        last = self.causes[-1].form
        return self.start[self.start.size - (len(last.parameters) if last is not None else 0) :]

    @property
    def left(self) -> float:
        """What it promises to leave of the sum of squares."""
        return self.before - self.gain


@dataclass(frozen=True, slots=True, eq=False)
class Screen:
    """The smaller hypothesis at its end: unknowns `z`, residuals `r` (channel and prior), what it can still follow.

    `channel` is in larger steps than the one that was fitted, and `at` the residuals that it has there.
    """

    channel: Channel
    base: Plant
    space: Space
    z: FloatArray
    at: FloatArray
    r: FloatArray
    basis: FloatArray

    def prospect(self, causes: tuple[Cause, ...], known: Sequence[Fit], near: Prospect | None = None) -> Prospect:
        """The best start of the last of `causes`, which the smaller hypothesis does not have.

        `near`: where only its start is looked at (see `prospects`).
        """
        space = make_space(self.base, causes, self.space.numbers, self.space.scales)
        best = Prospect(causes, space, self.z, -1.0, float(self.r @ self.r))
        for option in _options(space, known) if near is None else [near.own]:
            best = self._better(best, option)
        for option in _zoomed(causes[-1], best.start[self.z.size :]):
            best = self._better(best, option)
        return best

    def _better(self, best: Prospect, option: FloatArray) -> Prospect:
        """The better of `best` and the same hypothesis at another value of its last cause."""
        start = np.concatenate([self.z, option])
        gain = self._gain(self.channel.residuals(best.space.plant(start)))
        return replace(best, start=start, gain=gain) if gain > best.gain else best

    def directions(self, cause: Cause, known: Sequence[Fit]) -> list[tuple[FloatArray, FloatArray]]:
        """(values of the cause's own unknowns, direction in which they move the residual) for each of its starts.

        The direction is what is left of it once the unknowns of the smaller hypothesis have followed.
        """
        space = make_space(self.base, (*self.space.causes, cause), self.space.numbers, self.space.scales)
        ends = [np.concatenate([self.z, option]) for option in _options(space, known)]
        return [(z[self.z.size :], self._direction(self.channel.residuals(space.plant(z)))) for z in ends]

    def _direction(self, moved: FloatArray) -> FloatArray:
        direction = self._way(moved)
        rest: FloatArray = direction - self.basis @ (self.basis.T @ direction)
        return rest

    def _way(self, moved: FloatArray) -> FloatArray:
        """The direction before the unknowns follow."""
        way = np.zeros(self.r.size)
        np.subtract(moved, self.at, out=way[: moved.size])
        return way

    def _gain(self, moved: FloatArray) -> float:
        """How much of the squares the direction toward `moved` could take away; 0 if it leads away."""
        # The length of what `_direction` leaves; `r` has nothing along the basis, so `along` needs no following.
        way = self._way(moved)
        followed = self.basis.T @ way
        length = max(float(way @ way - followed @ followed), 0.0)
        along = -float(self.r @ way)
        if length <= 0.0 or along <= 0.0:
            return 0.0
        size = min(along / length, _LARGEST)
        return 2.0 * size * along - size**2 * length


def make_screen(look: Look, base: Plant, parent: Fit) -> Screen:
    """Prepares to look beyond `parent`, with all design numbers of the channel as nuisances."""
    space = make_space(base, parent.space.causes, look.channel.numbers, parent.space.scales)
    z = starts_of(space, [parent])[0]
    residuals = partial(look.residuals, space)
    at = residuals(z)
    basis, triangle = np.linalg.qr(jacobian(residuals, z, at, space.steps, space.upper))
    size = np.abs(np.diag(triangle))
    basis = basis[:, size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300)]
    r = np.concatenate([parent.residuals[look.rows], z / space.spreads])  # as they were fitted: larger steps miss more
    return Screen(look.channel, base, space, z, at[: look.rows.size], r - basis @ (basis.T @ r), basis)


def prospects(
    screen: Screen, todo: Iterable[tuple[Cause, ...]], known: Sequence[Fit], seen: Sequence[Prospect] = ()
) -> list[Prospect]:
    """All hypotheses of `todo`, the most promising first.

    `seen`: what was found beyond another smaller hypothesis, all starts looked at. Of a last cause that is among them
    only its best start there is looked at.
    """
    near = {_form_of(p.causes): p for p in reversed(seen) if p.gain > 0.0}  # the first one of each stays
    found = [screen.prospect(causes, known, near.get(_form_of(causes))) for causes in todo]
    return sorted(found, key=lambda p: -p.gain)


def _form_of(causes: tuple[Cause, ...]) -> tuple[str, str]:
    """The last cause by its name and its form's."""
    last = causes[-1]
    return last.name, last.form.name if last.form is not None else ""


def _options(space: Space, known: Sequence[Fit]) -> list[FloatArray]:
    """Values of the last cause's unknowns that are looked at."""
    last = space.causes[-1]
    if last.form is None:
        return []
    alone = make_space(space.base, (last,), (), space.scales)
    ended = [f for f in known if [(c.name, c.form) for c in f.space.causes] == [(last.name, last.form)]]
    options = starts_of(alone, ended) if ended else []
    # without the record those of what jumps are no use, and those of a table too many
    few = len(last.form.parameters) == 1 and last.form.parameters[0].smooth
    own = cause_starts(last, space.scales, dense=False) if few or last.form.starts_for is None else []
    return options + (own if len(own) <= _MOST_STARTS or not options else [])


def _zoomed(cause: Cause, values: FloatArray) -> list[FloatArray]:
    """The values with a size to which the response jumps made smaller and larger; empty for smooth forms."""
    rough = [] if cause.form is None else [not p.smooth and p.size for p in cause.form.parameters]
    if not any(rough) or not values.size:
        return []
    return [np.where(rough, factor * values, values) for factor in _ZOOM]
