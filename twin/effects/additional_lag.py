"""The motion is of higher order than one lag."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.lags import lag_parameter
from twin.slots import S_LAG2_S, V_INERTIA_S, V_TAU_AFTER_S, V_TAU_BEFORE_S


def _lag(doc: str) -> tuple[Parameter]:
    # Filling a diaphragm chamber through its tubing: tenths of a second to seconds.
    return lag_parameter(doc, usual=(0.3, 3.0))


def _after(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_TAU_AFTER_S] += values[0]  # a stem with a mass has one, too


def _before(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_TAU_BEFORE_S] = values[0]


def _inertia(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_INERTIA_S] = values[0]


def _behind(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_LAG2_S] += values[0]  # a filter of two poles has it, too


EFFECT = Effect(
    name="additional_lag",
    stage="actuator",
    claim="The motion is of higher order than one lag.",
    equations="dv/dt = (w - v) / lag, dx/dt = (v - x) / tau; before: dq/dt = (p - q) / lag and w = play(q); "
    "behind: dx/dt = (v - x) / lag, v as x in the design; inertia: lag d2x/dt2 = (w - x) / tau - dx/dt",
    source="Seborg, Edgar, Mellichamp, Process Dynamics and Control, 2nd ed. (Wiley 2004), ch. 6",
    forms=(
        Form("after_play", _lag("second time constant, between play and stem"), _after),
        Form("before_play", _lag("time constant between measured pressure and force"), _before),
        Form("inertia", _lag("mass of what moves over its damping: how late the speed follows the pull"), _inertia),
        Form("behind_stem", _lag("time constant between what the air moves, at its rate limit, and the stem"), _behind),
    ),
    twins=("sensor_lag", "dead_time"),
    absorbs=("tau",),
    same_as={"after_play": ("sensor_lag",), "behind_stem": ("sensor_lag",)},
)
