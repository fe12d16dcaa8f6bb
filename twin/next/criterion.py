"""How far an experiment would drive two explanations apart, in units of the noise and beyond what re-fitting can hide.

The difference of the two predictions is whitened, and what either explanation could still change about its prediction
within what the records allow counts as noise: d' (I + V_a + V_b)^-1 d, with V the predictions' covariances.
Source: Buzzi-Ferraris, Forzatti, Emig, Hofmann, Chem. Eng. Sci. 39 (1984) 81 (the criterion with posterior spread).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from control.experiment import Experiment
from logs.recording import FloatArray
from twin.fit.fitting import Fit
from twin.fit.least_squares import minimise
from twin.model.plant import Plant, reading_response
from twin.model.timegrid import TimeGrid, make_grid
from twin.next.rivals import Rival
from twin.replay.chain import chain_response

#: Rows of an experiment while designs are compared: the difference of two explanations is slow.
_ROWS_S, _STEP_S = 0.25, 0.1


@dataclass(frozen=True, slots=True)
class Bed:
    """An experiment as commanded, in the record's pressure unit, on a time grid."""

    grid: TimeGrid
    command: FloatArray
    duration_s: float


@dataclass(frozen=True, slots=True)
class Scale:
    """What a difference is measured in: `sigma` of the channel's reading, the seconds one independent value takes,
    and `excess`, the mean squared residual of the best explanation in units of the noise variance."""

    channel: str
    sigma: float
    independent_s: float
    excess: float = 1.0


def lay_out(experiment: Experiment, pressure_scale: float, rows_s: float = _ROWS_S, step_s: float = _STEP_S) -> Bed:
    """The experiment's commands as a bed; `pressure_scale` turns its unit into the record's."""
    schedule = experiment.commands(rows_s)
    # a row holds the command in force over the interval that ends with it
    command = pressure_scale * np.concatenate([schedule.command[:1], schedule.command[:-1]])
    return Bed(make_grid(schedule.time_s, step_s), command, float(schedule.time_s[-1]))


def predict(plant: Plant, bed: Bed, channel: str) -> FloatArray:
    """Pressure or reading at the rows of the bed, from a valve that is open and at rest."""
    c = plant.coefficients(bed.duration_s)
    pressure, stem = chain_response(c, bed.grid, bed.command, float(bed.command[0]), 0.0, 0.0)
    return pressure[bed.grid.offsets] if channel == "pressure" else reading_response(c, bed.grid, stem, pressure)


@dataclass(frozen=True, slots=True)
class Distance:
    """`squared`: the criterion; `worth`: independent values in the experiment; `spread`: RMS of what re-fitting cannot
    hide, in the unit of the reading."""

    squared: float
    worth: float
    spread: float

    @property
    def gain(self) -> float:
        """Expected gain in log-evidence: the error variance is profiled out, as in `twin/search/score.py`."""
        return 0.5 * self.worth * float(np.log1p(self.squared / self.worth))


def bound(a: Plant, b: Plant, bed: Bed, scale: Scale) -> Distance:
    """The distance if neither explanation could be re-fitted: never less than `distance`."""
    return _distance(_difference(a, b, bed, scale), None, bed, scale)


def distance(a: Rival, b: Rival, bed: Bed, scale: Scale) -> Distance:
    """The distance of two explanations that are re-fitted to the records and the experiment together."""
    hidden = np.hstack([response(one, bed, scale) for one in (a, b)])
    return _distance(_difference(a.plant(), b.plant(), bed, scale), hidden, bed, scale)


def refitted(a: Rival, b: Rival, bed: Bed, scale: Scale) -> Distance:
    """What is left between `a` and `b` when `b` is really fitted to what `a` predicts, held to what the records allow.

    `distance` believes that predictions are linear in the unknowns; this does not.
    """
    weight, fit = _weight(bed, scale), b.fit
    wanted = predict(a.plant(), bed, scale.channel)

    def residuals(z: FloatArray) -> FloatArray:
        miss = weight * (wanted - predict(b.plant(z), bed, scale.channel))
        return np.concatenate([miss, np.linalg.solve(b.freedom, z - fit.z)]) if z.size else miss

    best = minimise(residuals, fit.z, fit.space.lower, fit.space.upper, fit.space.steps, rounds=4)
    return _distance(best.residuals, None, bed, scale)


def effect_distance(plain: Rival, with_effect: Plant, hidden: FloatArray, bed: Bed, scale: Scale) -> Distance:
    """The distance of a plant with an effect from the design, which `hidden` (see `response`) may re-tune."""
    return _distance(_difference(plain.plant(), with_effect, bed, scale), hidden, bed, scale)


def response(rival: Rival, bed: Bed, scale: Scale) -> FloatArray:
    """What re-fitting within the records' limits can do to the prediction, whitened, shape (n, unknowns)."""
    fit: Fit = rival.fit
    base = predict(rival.plant(), bed, scale.channel)
    columns = np.empty((base.size, fit.z.size))
    for k, step in enumerate(fit.space.steps):
        signed = -step if fit.z[k] + step > fit.space.upper[k] else step
        moved = fit.z.copy()
        moved[k] += signed
        columns[:, k] = (predict(rival.plant(moved), bed, scale.channel) - base) / signed
    return _weight(bed, scale) * columns @ rival.freedom


def _weight(bed: Bed, scale: Scale) -> float:
    """Factor that makes a difference at the rows independent values of unit variance."""
    rows_s = bed.duration_s / max(bed.command.size - 1, 1)
    return float(np.sqrt(rows_s / scale.independent_s / scale.excess)) / scale.sigma


def _difference(a: Plant, b: Plant, bed: Bed, scale: Scale) -> FloatArray:
    return _weight(bed, scale) * (predict(a, bed, scale.channel) - predict(b, bed, scale.channel))


def _distance(difference: FloatArray, hidden: FloatArray | None, bed: Bed, scale: Scale) -> Distance:
    squared = float(difference @ difference)
    if hidden is not None and hidden.shape[1]:
        along = hidden.T @ difference
        inner = np.eye(hidden.shape[1]) + hidden.T @ hidden
        squared -= float(along @ np.linalg.solve(inner, along))
    squared = max(squared, 0.0)
    spread = float(np.sqrt(squared / difference.size)) / _weight(bed, scale)
    return Distance(squared, max(bed.duration_s / scale.independent_s, 1.0), spread)
