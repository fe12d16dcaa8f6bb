"""The reading is low-pass filtered."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.sensor_slots import (
    S_DAMPING,
    S_LAG2_S,
    S_LAG3_S,
    S_LAG_S,
    S_LEADS_S,
    S_NATURAL_S,
    S_WINDOW_S,
    S_WINDOWS,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter
from twin.model.lags import DAMPING, lag_parameter, natural_s


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_LAG_S] = values[0]


def _twice(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_LAG_S] = 0.5 * values[0]
    c.sensor[S_LAG2_S] += 0.5 * values[0]


def _thrice(c: Coefficients, values: Sequence[float]) -> None:
    third = values[0] / 3.0
    c.sensor[S_LAG_S] = c.sensor[S_LAG3_S] = third
    c.sensor[S_LAG2_S] += third


def _second_order(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_NATURAL_S, S_DAMPING]] = natural_s(*values), values[1]


def _mean(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_WINDOW_S], c.sensor[S_WINDOWS] = 2.0 * values[0], float(values[0] > 0.0)


def _mean_twice(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_WINDOW_S], c.sensor[S_WINDOWS] = values[0], 2.0 * float(values[0] > 0.0)


def _lag(doc: str) -> tuple[Parameter]:
    return lag_parameter(doc, usual=(0.2, 3.0))


def _leads(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_LEADS_S] = values[0]


_LEAD = Parameter(
    name="lead",
    kind="time",
    lower=0.0,
    upper=8.0,
    starts=(0.1, 0.5),
    scale=0.5,
    doc="what the reading picks up of the speed of the stem, over that speed",
)

EFFECT = Effect(
    name="sensor_lag",
    stage="sensor",
    claim="The reading is low-pass filtered.",
    equations="dy/dt = (x - y) / lag; two_poles: half the lag, twice over, one behind the other; "
    "three_poles: a third, three times over; second_order: T^2 d2y/dt2 + 2 damping T dy/dt = x - y, lag = 2 damping T; "
    "running_mean: the mean over the last 2 lag; running_mean_twice: over the last lag, and that once more; a reading "
    "that leads is no lag, only told from what it resembles: y = x + lead dx/dt",
    source="Doebelin, Measurement Systems: Application and Design (McGraw-Hill), first- and second-order instruments; "
    "Oppenheim, Schafer, Discrete-Time Signal Processing, 3rd ed. (Pearson 2010), moving average",
    forms=(
        Form("first_order", _lag("time constant of the filter"), _apply, share=0.6),
        Form("two_poles", _lag("time constants of the two equal poles together"), _twice, share=0.15),
        Form("three_poles", _lag("time constants of the three equal poles together"), _thrice, share=0.05),
        Form("second_order", (*_lag("mean delay of the reading"), DAMPING), _second_order, share=0.1),
        Form(
            "running_mean",
            _lag("mean delay of the reading, half the window that it is averaged over"),
            _mean,
            share=0.07,
        ),
        Form(
            "running_mean_twice",
            _lag("mean delay of the reading, the window that it is averaged over"),
            _mean_twice,
            share=0.03,
        ),
        Form("leads", (_LEAD,), _leads, outside="the reading picks up the speed of the stem"),
    ),
    twins=("additional_lag", "dead_time"),
    absorbs=("tau",),
    same_as=dict.fromkeys(("first_order", "two_poles", "three_poles", "second_order"), ("additional_lag",)),
)
