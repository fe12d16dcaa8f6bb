"""The zero of the reading moves gradually with time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from logs.recording import FloatArray, Recording
from twin.kernels.sensor_slots import (
    KNOTS,
    S_CYCLE_COS,
    S_CYCLE_S,
    S_CYCLE_SIN,
    S_DRIFT_AMP,
    S_DRIFT_RATE,
    S_DRIFT_TAU_S,
    S_JUMP,
    S_JUMP_S,
    S_KNOTS,
    S_ROOT,
    S_ROOT_SINCE_S,
    S_WANDER_S,
    S_ZERO,
)
from twin.model.anew import anew
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales
from twin.model.shapes import WHEN

_RATE = Parameter(
    name="rate",
    kind="position_rate",
    lower=-1e-3,
    upper=1e-3,
    starts=(-1e-5, 1e-5),
    scale=3e-5,
    doc="drift of the zero per second",
)
_CHANGE = Parameter(
    name="change",
    kind="position",
    lower=-0.15,
    upper=0.15,
    starts=(-0.004, 0.004),
    scale=0.01,
    doc="change of the zero in the end",
)
_QUARTER = replace(_CHANGE, doc="change of the zero over the first 300 time constants of the stem")
_SETTLING = Parameter(
    name="settling",
    kind="time",
    lower=10.0,
    upper=5000.0,
    starts=(60.0, 300.0),
    scale=150.0,
    doc="time constant of the warm-up",
    neutral=200.0,
    size=False,
)
_ZEROS = tuple(
    Parameter(
        name=f"zero_{k}",
        kind="position",
        lower=-0.15,
        upper=0.15,
        starts=(0.0005 * k,),
        scale=0.01,
        doc=f"zero after {k}/{KNOTS} of the recording",
    )
    for k in range(1, KNOTS + 1)
)


_THERE = replace(_CHANGE, name="there", doc="half of the way that the zero goes and comes back from, per period")
_ALONG = replace(
    _CHANGE, name="along", starts=(-0.0005, 0.0005), doc="the rest of the swing, a quarter of a period ahead"
)
_PERIOD = Parameter(
    name="period",
    kind="time",
    lower=60.0,
    upper=3000.0,
    starts=(120.0, 250.0, 600.0),
    scale=100.0,
    doc="period of the cycle",
    neutral=300.0,
    size=False,
)


#: Instants at which a jump is looked for: a start too far off finds no way to it.
_LOOKS = 48
#: The stem's time constant in which a zero creeps, of a design that says it has none [s].
_LEAST_S = 1e-3
#: Jump [in] that is looked for: so small that the moment which leaves least is that of a jump of any size.
_JUMP = 0.001
_STEP = replace(_CHANGE, name="zero", starts=(-_JUMP, _JUMP), doc="by how much the zero jumps")
_WHEN = replace(
    WHEN,
    starts=tuple(0.02 + 0.96 * (0.5 + k) / _LOOKS for k in range(_LOOKS)),
    doc="when it jumps, fraction of all recordings",
)


# from 0 on, so that it is looked for in shares of itself
_AFTER = replace(
    _SETTLING,
    name="after",
    lower=0.0,
    starts=(20.0, 40.0, 80.0),
    scale=100.0,
    doc="when it jumps in each recording",
    neutral=0.0,
    smooth=False,
)


def _linear(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_DRIFT_RATE] = values[0]
    c.sensor[S_ZERO] += values[0] * c.since_s


def _warm_up(c: Coefficients, values: Sequence[float]) -> None:
    left = c.to_come(*values)
    c.sensor[S_DRIFT_AMP], c.sensor[S_DRIFT_TAU_S] = left, values[1]
    c.sensor[S_ZERO] += values[0] - left


def _root(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_ROOT, S_ROOT_SINCE_S]] = values[0] / (300.0 * max(c.design.tau_s, _LEAST_S)) ** 0.5, c.since_s
    c.sensor[S_ZERO] += c.sensor[S_ROOT] * np.sqrt(c.since_s)


def _cycle(c: Coefficients, values: Sequence[float]) -> None:
    there, along, period_s = values
    phase = 2.0 * np.pi * c.since_s / period_s
    c.sensor[S_CYCLE_S] = period_s
    c.sensor[S_CYCLE_COS] = there * np.cos(phase) - along * np.sin(phase)
    c.sensor[S_CYCLE_SIN] = there * np.sin(phase) + along * np.cos(phase)
    c.sensor[S_ZERO] += there - c.sensor[S_CYCLE_COS]


def _swing(c: Coefficients, values: Sequence[float]) -> None:
    """About the design's zero, and not from it on: a room was as warm as on the day of calibration some other time."""
    _cycle(c, values)
    c.sensor[S_ZERO] -= values[0]


def _apart(c: Coefficients, values: Sequence[float]) -> None:
    """Each recording with a zero of its own: a curve through as many of the values as go round."""
    if c.place is None:
        return  # nobody knows the zero of another recording
    number, each = c.place.number, KNOTS // c.place.of
    if each < 2:
        c.sensor[S_ZERO] += values[number]
        return
    curve = np.polynomial.Polynomial(_through(each) @ np.array(values[each * number : each * (number + 1)]))
    whole_s = max(c.place.whole_s or c.duration_s, 1e-9)
    zeros = curve((c.place.within_s + c.duration_s * np.arange(KNOTS + 1) / KNOTS) / whole_s)
    c.sensor[S_ZERO] += zeros[0]
    _wander(c, (zeros[1:] - zeros[0]).tolist())


@cache
def _through(points: int) -> FloatArray:
    """Coefficients, over 0 to 1, of the polynomial through evenly spaced points: a matrix for their values."""
    return np.asarray(np.linalg.inv(np.vander(np.linspace(0.0, 1.0, points), increasing=True)), dtype=np.float64)


def _wander(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_WANDER_S] = c.duration_s / KNOTS
    c.sensor[S_KNOTS : S_KNOTS + KNOTS] = values


def _jump(c: Coefficients, values: Sequence[float]) -> None:
    before_s, all_s = c.course_s
    _step(c, values[0], values[1] * all_s - before_s)


def _jump_each(c: Coefficients, values: Sequence[float]) -> None:
    _step(c, values[0], values[1] - (c.place.within_s if c.place is not None else 0.0))


def _instants(records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    """All along the first recording, up and down."""
    size, whole_s = _JUMP * scales.position, records[0].duration_s
    return [(zero, (0.5 + k) / _LOOKS * whole_s) for k in range(_LOOKS) for zero in (size, -size)]


def _step(c: Coefficients, zero: float, at_s: float) -> None:
    if at_s <= 0.0:
        c.sensor[S_ZERO] += zero
    else:
        c.sensor[[S_JUMP, S_JUMP_S]] = zero, at_s


EFFECT = Effect(
    name="lvdt_drift",
    stage="sensor",
    claim="The zero of the reading moves gradually with time.",
    equations="y = x + rate t, or x + change (1 - exp(-t / settling)), or x + change (t / 300 tau)^0.5 (root), "
    "..._anew: the same, begun anew in each recording, though they share a clock; "
    "or x + there (1 - cos) + along sin (2 pi t / period), or x - there cos + along sin (swing), "
    "or x + a spline through its value at ten times, "
    "or x + a curve of each recording's own through up to five values (apart); a jump is no drift, only told from it",
    source="IEC 61298-3, Process measurement and control devices, part 3 (effects of influence quantities)",
    forms=(
        Form("linear", (_RATE,), _linear),
        Form("warm_up", (_CHANGE, _SETTLING), _warm_up),
        Form("root", (_QUARTER,), _root),
        Form("linear_anew", (_RATE,), anew(_linear), anew=True),
        Form("warm_up_anew", (_CHANGE, _SETTLING), anew(_warm_up), anew=True),
        Form("cycle", (_THERE, _ALONG, _PERIOD), _cycle),
        Form("swing", (_THERE, _ALONG, _PERIOD), _swing),
        Form("apart", _ZEROS, _apart, apart=KNOTS),
        Form("wander", _ZEROS, _wander, once=True),
        Form("jump", (_STEP, _WHEN), _jump, outside="the zero of the reading jumps"),
        Form(
            "jump_each",
            (_STEP, _AFTER),
            _jump_each,
            _instants,
            apart=KNOTS,
            outside="the zero of the reading jumps each time",
        ),
    ),
    drifts=True,
    twins=("friction_drift", "creep"),
    hides=("lvdt_calibration",),
)
