"""The same channel in larger steps, for looks at what is worth a fit, and for the slopes of one.

Both ask in which direction something moves the residual. That is a difference of two simulations, in which what larger
steps miss is nearly the same and goes away, so that they need not be as fine as those that a fit is judged by.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from logs.recording import FloatArray
from twin.fit.channel import Channel
from twin.fit.compiled import at_all_rows
from twin.fit.least_squares import jacobian
from twin.fit.space import Space
from twin.fit.trial import Trial
from twin.model.timegrid import QUICK, TimeGrid, make_grid
from twin.record.rows import Rows, kept_rows, thinned

#: Steps are so many times larger at the most, as long as there are about so many left.
LARGER = 5.0
LEAST_STEPS = 10_000
_WORTHWHILE = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A `channel` in larger steps, and which `rows` of the `whole` one it has (int64, shape (rows,))."""

    channel: Channel
    rows: Rows
    whole: Channel

    @property
    def larger(self) -> bool:
        """Whether its steps are larger at all."""
        return self.channel is not self.whole

    def residuals(self, space: Space, z: FloatArray) -> FloatArray:
        """Of the channel in larger steps and the priors of `space`, at its unknowns `z`."""
        return np.concatenate([self.channel.residuals(space.plant(z)), z / space.spreads])

    def slopes(self, space: Space, z: FloatArray) -> FloatArray:
        """About the Jacobian of the residuals and the priors of `space` at `z`, as a fit has them."""
        residuals = partial(self.residuals, space)
        few = jacobian(residuals, z, residuals(z), space.steps, space.upper)
        return at_all_rows(few, self.rows, self.whole.use)


def in_larger_steps(channel: Channel, larger: float = LARGER, least: int = LEAST_STEPS) -> Look:
    """`channel` in steps up to `larger` times as long, about `least` of them if it has more, else as it is.

    Where a row is a step already, rows are left out.
    """
    steps = sum(trial.grid.n_fine - 1 for trial in channel.trials)
    factor = min(larger, steps / least)
    if factor < _WORTHWHILE:
        return Look(channel, np.arange(channel.use.size), channel)
    kept = [_kept(trial, factor) for trial in channel.trials]
    begins = np.cumsum([0, *(trial.recording.n for trial in channel.trials)])[:-1]
    rows = np.concatenate([begin + some for begin, some in zip(begins, kept, strict=True)])
    trials = tuple(_in_steps(trial, some, factor) for trial, some in zip(channel.trials, kept, strict=True))
    few = replace(channel, trials=trials, measured=channel.measured[rows], use=channel.use[rows])
    return Look(few, rows, channel)


def _per_row(trial: Trial) -> float:
    return float(np.mean(np.diff(trial.grid.time_s)) / trial.grid.typical_s)


def _kept(trial: Trial, factor: float) -> Rows:
    every = round(factor / _per_row(trial))
    return kept_rows(trial.recording.command, trial.recording.n // max(every, 1))


def _in_steps(trial: Trial, rows: Rows, factor: float) -> Trial:
    """The trial at some of its rows, in longer steps."""
    few = thinned(trial.recording, rows)
    per_row = max(1, round(_per_row(trial) / factor))
    step_s, quick_s = 1.01 * float(np.median(np.diff(few.time_s))) / per_row, QUICK * trial.grid.typical_s
    grid = make_grid(few.time_s, step_s, few.command, quick_s)
    return replace(
        trial,
        recording=few,
        grid=grid,
        use_p=trial.use_p[rows],
        use_y=trial.use_y[rows],
        false=trial.false[rows],
        vague=trial.vague[rows],
        pressure=_at(trial.pressure, trial.grid, grid),
        stem=_at(trial.stem, trial.grid, grid),
        fresh=None if trial.fresh is None else trial.fresh.kept(rows, trial.recording.time_s),
    )


def _at(values: FloatArray | None, fine: TimeGrid, grid: TimeGrid) -> FloatArray | None:
    return None if values is None else np.interp(grid.fine_time_s, fine.fine_time_s, values)
