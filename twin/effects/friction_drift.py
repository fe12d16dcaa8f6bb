"""The deadband changes with time: warm-up, wear, or a change that comes at once or gradually."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import exp

from logs.recording import Recording
from twin.kernels.valve_slots import (
    V_DRIFT_AMP,
    V_DRIFT_RATE,
    V_DRIFT_TAU_S,
    V_ON_STEM,
    V_STEP,
    V_STEP_EASES,
    V_STEP_EASES_S,
    V_STEP_TAKES_S,
    V_STEP_TIME_S,
    V_WEAR,
)
from twin.model.anew import anew
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales
from twin.model.shapes import WHEN

_RATE = Parameter(
    name="rate",
    kind="pressure_rate",
    lower=-0.02,
    upper=0.02,
    starts=(-1e-4, 1e-4),
    scale=1e-3,
    doc="growth of the half deadband per second",
)
_CHANGE = Parameter(
    name="change",
    kind="pressure",
    lower=-1.4,
    upper=2.5,
    starts=(-0.15, 0.15),
    scale=0.3,
    doc="change of the half deadband in the end",
)
_SETTLING = Parameter(
    name="settling",
    kind="time",
    lower=30.0,
    upper=5000.0,
    starts=(60.0, 300.0),
    scale=150.0,
    doc="time constant of the warm-up",
    neutral=200.0,
    size=False,
)
_EXCESS = replace(_CHANGE, name="excess", doc="by how much the half deadband is wider when the recordings begin")
_WEAR = Parameter(
    name="wear",
    kind="pressure_per_position",
    lower=-1.0,
    upper=1.0,
    starts=(-0.01, 0.01),
    scale=0.05,
    doc="growth of the half deadband per travelled distance",
)
_WHEN = replace(WHEN, starts=(0.2, 0.4, 0.6, 0.8), doc="when the change happens, fraction of the recording")


_MIDDLE = replace(
    _SETTLING,
    name="middle",
    lower=0.0,
    upper=20_000.0,
    starts=(40.0, 80.0),
    doc="when half of the change has come",
    neutral=0.0,
)
_TAKES = replace(
    _SETTLING, name="takes", lower=2.0, starts=(20.0, 60.0), doc="time constant with which it comes, and settles"
)
_EASES = Parameter(
    name="eases",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.5,),
    scale=0.5,
    doc="share of the change that is gone in the end",
    size=False,
)
_EASING = replace(_SETTLING, starts=(100.0, 500.0), doc="time constant with which that share goes")


#: Recordings up to which it goes on from one to the next.
_MANY = 50


def _linear(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_DRIFT_RATE] = values[0]
    c.widen(values[0] * c.since_s)


def _goes_on(c: Coefficients, values: Sequence[float]) -> None:
    _linear(c, values)
    c.widen(values[0] * (c.place.before_s if c.place is not None else 0.0))


def _warm_up(c: Coefficients, values: Sequence[float]) -> None:
    left = c.to_come(*values)
    c.valve[V_DRIFT_AMP], c.valve[V_DRIFT_TAU_S] = left, values[1]
    c.widen(values[0] - left)


def _from_cold(c: Coefficients, values: Sequence[float]) -> None:
    _warm_up(c, (-values[0], values[1]))
    c.widen(values[0])


def _wear(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_WEAR] = values[0]


def _sudden(c: Coefficients, values: Sequence[float]) -> None:
    before_s, all_s = c.course_s
    when_s = values[1] * all_s - before_s
    if when_s <= 0.0:
        c.widen(values[0])
    else:
        c.valve[V_STEP], c.valve[V_STEP_TIME_S] = values[0], when_s


def _gradual(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[[V_STEP, V_STEP_TIME_S, V_STEP_TAKES_S]] = values[0], values[1] - c.since_s, values[2]


def _middles(records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    """Either way, soon and late in the longest of the recordings, quickly and slowly."""
    size, lasts_s = 0.15 * scales.pressure, max(r.duration_s for r in records)
    shares = [(middle, takes) for middle in (0.2, 0.4, 0.6, 0.8) for takes in (0.04, 0.12)]
    return [(change, m * lasts_s, max(t * lasts_s, 2.0)) for m, t in shares for change in (size, -size)]


def _sudden_easing(c: Coefficients, values: Sequence[float]) -> None:
    change, when, eases, easing_s = values
    before_s, all_s = c.course_s
    since_s = before_s - when * all_s
    # a recording that begins after the change has the rest of it: what is left decays on
    left = 1.0 if since_s <= 0.0 else exp(-since_s / easing_s)
    stays = (1.0 - eases) + eases * left
    c.valve[[V_STEP, V_STEP_TIME_S]] = change * stays, max(-since_s, 0.0)
    c.valve[[V_STEP_EASES, V_STEP_EASES_S]] = (eases * left / stays if stays > 0.0 else 0.0), easing_s


def _on_stem(c: Coefficients, grown: float) -> None:
    """What friction has grown by, and `grown` before this recording [pressure], holds the stem, not what pulls it."""
    c.valve[V_ON_STEM] = c.design.compliance
    c.valve[V_STEP], c.valve[V_STEP_TIME_S] = grown, 0.0


def _linear_on_stem(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_DRIFT_RATE] = values[0]
    _on_stem(c, values[0] * c.since_s)


def _warm_up_on_stem(c: Coefficients, values: Sequence[float]) -> None:
    left = c.to_come(*values)
    c.valve[V_DRIFT_AMP], c.valve[V_DRIFT_TAU_S] = left, values[1]
    _on_stem(c, values[0] - left)


def _wear_on_stem(c: Coefficients, values: Sequence[float]) -> None:
    _wear(c, values)
    _on_stem(c, 0.0)


EFFECT = Effect(
    name="friction_drift",
    stage="actuator",
    claim="The deadband changes with time.",
    equations="half deadband = (a1 - a2)/2 + rate t, or + change (1 - exp(-t/settling)), + wear * distance, or a step; "
    "from_cold: + excess exp(-t/settling), of a design that was taken when it was warm; "
    "gradual: + change / (1 + exp((middle - t) / takes)), as packing that swells; "
    "sudden_easing: a step of which a share goes again, as packing that is tightened relaxes; "
    "..._anew: the same, begun anew in each recording, though they share a clock; "
    "goes_on: the rate from recording to recording, as they are given, though each has a clock of its own; "
    "on_stem: what it has grown by, s, does not widen the play but keeps the stem short: |w - x| less k s pulls it",
    source="Olsson, Astrom, Canudas de Wit, Gafvert, Lischinsky, Eur. J. Control 4 (1998) 176",
    forms=(
        Form("linear", (_RATE,), _linear),
        Form("goes_on", (_RATE,), _goes_on, apart=_MANY),
        Form("warm_up", (_CHANGE, _SETTLING), _warm_up),
        Form("from_cold", (_EXCESS, _SETTLING), _from_cold),
        Form("linear_anew", (_RATE,), anew(_linear), anew=True),
        Form("warm_up_anew", (_CHANGE, _SETTLING), anew(_warm_up), anew=True),
        Form("from_cold_anew", (_EXCESS, _SETTLING), anew(_from_cold), anew=True),
        Form("wear", (_WEAR,), _wear),
        Form("sudden", (_CHANGE, _WHEN), _sudden),
        Form("gradual", (_CHANGE, _MIDDLE, _TAKES), _gradual, _middles),
        Form("sudden_easing", (_CHANGE, _WHEN, _EASES, _EASING), _sudden_easing),
        Form("linear_on_stem", (_RATE,), _linear_on_stem),
        Form("warm_up_on_stem", (_CHANGE, _SETTLING), _warm_up_on_stem),
        Form("wear_on_stem", (_WEAR,), _wear_on_stem),
    ),
    drifts=True,
    twins=("lvdt_drift",),
    absorbs=("deadband",),
)
