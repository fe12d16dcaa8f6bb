"""Which two causes together are worth a full fit: their moves of the residual added up, for every pair at once.

A pair may be needed before either of its members shows: alone, each is outdone by causes that imitate part of both.
Each cause's start moves the residual in one direction; what two directions and the design numbers together could take
away is a small linear problem in inner products, so all pairs cost one simulation per start and a matrix product.
Exact where responses add up, good enough elsewhere to put the right pair among a dozen.
Source: the score (gradient) test, Rao, Proc. Cambridge Phil. Soc. 44 (1948) 50, in two directions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray
from twin.fit.fitting import Fit
from twin.fit.space import Cause, Space, make_space
from twin.search.screen import Screen

#: How far a start is scaled at the most.
_LARGEST = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class Move:
    """A cause at one of its starts: `values` of its own unknowns and the `direction` in which the residual moves."""

    cause: Cause
    values: FloatArray
    direction: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Two causes with the start that promises most, and by how much they would lower the sum of squares."""

    causes: tuple[Cause, ...]
    space: Space
    start: FloatArray
    gain: float


def promising_pairs(
    screen: Screen,
    causes: Iterable[Cause],
    ended: Sequence[Fit],
    together: Callable[[Cause, Cause], bool],
) -> list[Pair]:
    """The best start of every pair of names, the most promising first.

    `screen` stands where the hypothesis without causes ended; `ended` are the causes fitted alone; `together` says
    whether two causes mean something beside each other, whatever their forms.
    """
    moves = [move for cause in causes for move in _moves(screen, cause, ended)]
    if len(moves) < 2:
        return []
    directions = np.array([m.direction for m in moves])
    gram = directions @ directions.T
    along = -directions @ screen.r
    gains, sizes = _gains(gram, along)
    best = _best_of_each([m.cause for m in moves], gains, together)
    return [_pair(screen, moves[i], moves[j], float(sizes[i, j]), float(sizes[j, i]), gain) for gain, i, j in best]


def _best_of_each(
    causes: Sequence[Cause], gains: FloatArray, together: Callable[[Cause, Cause], bool]
) -> list[tuple[float, int, int]]:
    """Of every two names that mean something beside each other the best (gain, first, second), the best names first."""
    named = {c.name: c for c in causes}
    at = {name: k for k, name in enumerate(named)}
    apart = np.array([[a is not b and together(a, b) for b in named.values()] for a in named.values()])
    which = np.array([at[c.name] for c in causes])
    i, j = np.triu_indices(len(causes), 1)
    pays = apart[which[i], which[j]]
    i, j = i[pays], j[pays]
    order = np.lexsort((j, i, -gains[i, j]))
    low, high = np.minimum(which[i], which[j]), np.maximum(which[i], which[j])
    _, first = np.unique((low * len(named) + high)[order], return_index=True)
    pairs = order[first]
    return sorted(zip(gains[i, j][pairs].tolist(), i[pairs].tolist(), j[pairs].tolist(), strict=True), reverse=True)


def _moves(screen: Screen, cause: Cause, ended: Sequence[Fit]) -> list[Move]:
    """Where the starts of a cause move the residual once the design numbers have followed."""
    found = []
    for values, direction in screen.directions(cause, ended):
        length = float(np.linalg.norm(direction))
        if length > 0.0 and np.isfinite(length):
            found.append(Move(cause, values, direction))
    return found


def _gains(gram: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """For all pairs (i, j): the squares they could take away, and (at [i, j]) how far the start of i is scaled."""
    square = np.diag(gram)
    det = np.outer(square, square) - gram**2
    with np.errstate(divide="ignore", invalid="ignore"):
        sizes = (along[:, None] * square[None, :] - gram * along[None, :]) / det
        alone = np.clip(along / square, 0.0, _LARGEST)
    near = det <= 1e-6 * np.outer(square, square)  # one direction: the pair says nothing new
    sizes = np.clip(np.nan_to_num(sizes), 0.0, _LARGEST)
    # Where one of the two had to be cut off the other takes its best place beside that.
    with np.errstate(divide="ignore", invalid="ignore"):
        again = np.clip((along[:, None] - gram * sizes.T) / square[:, None], 0.0, _LARGEST)
    sizes = np.where(near, alone[:, None], np.nan_to_num(again))
    other = sizes.T
    gains = 2.0 * (sizes * along[:, None] + other * along[None, :])
    gains -= sizes**2 * square[:, None] + other**2 * square[None, :] + 2.0 * sizes * other * gram
    return np.where(near, 0.0, gains), sizes


def _pair(screen: Screen, first: Move, second: Move, size: float, other: float, gain: float) -> Pair:
    causes = (first.cause, second.cause)
    space = make_space(screen.base, causes, screen.space.numbers, screen.space.scales)
    own = [_scaled(first, size), _scaled(second, other)]
    return Pair(causes, space, np.concatenate([screen.z, *own]), gain)


def _scaled(move: Move, size: float) -> FloatArray:
    """The start with its sizes (not its shapes) scaled as far as the pair wants, within reason."""
    if move.cause.form is None:
        return move.values
    factor = min(max(size, 0.25), 2.0)
    return np.array(
        [v * (factor if p.size else 1.0) for v, p in zip(move.values, move.cause.form.parameters, strict=True)]
    )
