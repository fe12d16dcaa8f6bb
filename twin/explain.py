"""What an effect looks like: its simulated signature, and which experiments bring it out.

The thesis's valve is driven through the experiments that `lostmotion sweep` knows, once without and once with the
effect at a clearly visible size, without noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from control.design import DesignModel
from control.experiment_catalog import make_experiment
from logs.recording import FloatArray
from twin.fit.numbers import NUMBERS, nominal, retuned
from twin.model.effect import Effect, Form
from twin.model.plant import Inserted, Plant, reading_response
from twin.model.timegrid import make_grid
from twin.replay.chain import chain_response

#: Experiments of `lostmotion sweep` that are tried; hold, the slowest to tell anything, last.
KINDS = ("staircase", "nested", "ramp", "steps", "random", "multisine", "hold")

_STEP_S = 0.05
_TANGENT = 1e-3


@dataclass(frozen=True, slots=True)
class Signature:
    """Readings without (`base_*`) and with the effect, pressure in psi and position in in, each of shape (n,)."""

    kind: str
    values: tuple[float, ...]
    time_s: FloatArray
    base_pressure: FloatArray
    base_position: FloatArray
    pressure: FloatArray
    position: FloatArray
    travel: float

    @property
    def residual_percent(self) -> FloatArray:
        """Reading with the effect less reading without it [% of travel]."""
        return 100.0 * (self.position - self.base_position) / self.travel


@dataclass(frozen=True, slots=True)
class Visibility:
    """How much of an effect an experiment shows: RMS [% of travel] as it is, and what re-tuning could not imitate."""

    kind: str
    duration_s: float
    rms_percent: float
    beyond_retuning_percent: float


def typical_values(form: Form) -> tuple[float, ...]:
    """A clearly visible size of each parameter, shapes at their usual values; in psi, in and s."""
    return tuple(
        p.neutral if not p.size else p.neutral + p.scale if p.neutral + p.scale <= p.upper else _middle(p.starts)
        for p in form.parameters
    )


def signature(effect: Effect, form: Form, kind: str) -> Signature:
    """The effect in one form on an experiment of `kind`."""
    design = DesignModel()
    values = typical_values(form)
    base = _response(Plant(design), kind)
    changed = _response(Plant(design, (Inserted(effect.name, form, values),)), kind)
    return Signature(kind, values, _excitation(kind)[0], *base, *changed, design.travel)


def visibilities(effect: Effect, form: Form) -> tuple[Visibility, ...]:
    """Every experiment of `KINDS`, those first that show most beyond what re-tuned design numbers could imitate."""
    found = []
    for kind in KINDS:
        one = signature(effect, form, kind)
        shown = one.residual_percent
        rest = shown - _tangents(kind) @ np.linalg.lstsq(_tangents(kind), shown, rcond=None)[0]
        found.append(Visibility(kind, float(one.time_s[-1]), _rms(shown), _rms(rest)))
    return tuple(sorted(found, key=lambda v: -v.beyond_retuning_percent))


def _middle(starts: tuple[float, ...]) -> float:
    return starts[len(starts) // 2]


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@cache
def _excitation(kind: str) -> tuple[FloatArray, FloatArray]:
    """Times of the rows and the command in force before each, both of shape (n,)."""
    schedule = make_experiment(kind).commands()
    return schedule.time_s, np.concatenate([schedule.command[:1], schedule.command[:-1]])


def _response(plant: Plant, kind: str) -> tuple[FloatArray, FloatArray]:
    time_s, command = _excitation(kind)
    grid = make_grid(time_s, _STEP_S)
    c = plant.coefficients(float(time_s[-1]))
    pressure, stem = chain_response(c, grid, command, float(command[0]), 0.0, 0.0)
    return pressure[grid.offsets], reading_response(c, grid, stem, pressure)


@cache
def _tangents(kind: str) -> FloatArray:
    """How the reading moves with each design number [% of travel per relative change], shape (n, numbers)."""
    design = DesignModel()
    base = _response(Plant(design), kind)[1]
    columns = []
    for name in NUMBERS:
        moved = retuned(design, {name: nominal(design, name) * (1.0 + _TANGENT)})
        columns.append((_response(Plant(moved), kind)[1] - base) / _TANGENT * 100.0 / design.travel)
    return np.column_stack(columns)
