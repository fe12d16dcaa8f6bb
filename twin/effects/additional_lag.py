"""The motion is of higher order than one lag."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.sensor_slots import S_LAG2_S, S_MASS_DAMPING, S_MASS_NATURAL_S, S_THRICE_S
from twin.kernels.valve_slots import V_INERTIA_S, V_TAU_AFTER_S, V_TAU_BEFORE_S
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter
from twin.model.lags import DAMPING, lag_parameter, natural_s


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


def _thrice(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_THRICE_S] = values[0] / 3.0


def _mass(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_MASS_NATURAL_S, S_MASS_DAMPING]] = natural_s(*values), values[1]


EFFECT = Effect(
    name="additional_lag",
    stage="actuator",
    claim="The motion is of higher order than one lag.",
    equations="dv/dt = (w - v) / lag, dx/dt = (v - x) / tau; before: dq/dt = (p - q) / lag and w = play(q); "
    "behind: dx/dt = (v - x) / lag, v as x in the design; inertia: lag d2x/dt2 = (w - x) / tau - dx/dt; "
    "three_behind: a third of it, three times over; mass_on_spring: T^2 d2x/dt2 + 2 damping T dx/dt = v - x, "
    "lag = 2 damping T",
    source="Seborg, Edgar, Mellichamp, Process Dynamics and Control, 2nd ed. (Wiley 2004), ch. 6",
    forms=(
        Form("after_play", _lag("second time constant, between play and stem"), _after, share=0.35),
        Form("before_play", _lag("time constant between measured pressure and force"), _before, share=0.1),
        Form(
            "inertia",
            _lag("mass of what moves over its damping: how late the speed follows the pull"),
            _inertia,
            share=0.15,
        ),
        Form(
            "behind_stem",
            _lag("time constant between what the air moves, at its rate limit, and the stem"),
            _behind,
            share=0.3,
        ),
        Form("three_behind", _lag("time constants of three equal lags together"), _thrice, share=0.03),
        Form("mass_on_spring", (*_lag("mean delay behind what the air moves"), DAMPING), _mass, share=0.07),
    ),
    twins=("sensor_lag", "dead_time"),
    absorbs=("tau",),
    same_as=dict.fromkeys(("after_play", "behind_stem", "three_behind", "mass_on_spring"), ("sensor_lag",)),
)
