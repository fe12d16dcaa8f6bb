"""The reading is off by a gain error, a zero error, or both."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.sensor_slots import S_GAIN, S_PICKS, S_PICKS_FROM, S_ZERO
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter

_GAIN = Parameter(
    name="gain",
    kind="fraction",
    lower=-0.4,
    upper=0.6,
    starts=(-0.01, 0.01),
    scale=0.03,
    doc="relative gain error, 0 = right",
)
_ZERO = Parameter(
    name="zero",
    kind="position",
    lower=-0.2,
    upper=0.2,
    starts=(-0.003, 0.003),
    scale=0.01,
    doc="reading at fully open",
)


#: Of what the pressure moves the stem by.
_PICKED = Parameter(
    name="picked_up",
    kind="fraction",
    lower=-0.3,
    upper=0.3,
    starts=(-0.01, 0.01),
    scale=0.03,
    doc="reading for each unit of pressure, as a share of the compliance",
)


def _both(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_GAIN] *= 1.0 + values[0]
    c.sensor[S_ZERO] += values[1]


def _gain(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_GAIN] *= 1.0 + values[0]


def _zero(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_ZERO] += values[0]


def _picks_up(c: Coefficients, values: Sequence[float]) -> None:
    """The bracket gives way to the pressure, or the wiring hears the command: the same but for the converter's lag."""
    c.sensor[S_PICKS] = values[0] * c.design.compliance
    c.sensor[S_PICKS_FROM] = c.design.a1
    c.sensor[S_ZERO] += values[1]


EFFECT = Effect(
    name="lvdt_calibration",
    stage="sensor",
    claim="The reading has a gain error, a zero error, or both.",
    equations="y = (1 + gain) x + zero",
    source="IEC 61298-2, Process measurement and control devices, part 2: tests under reference conditions",
    forms=(
        Form("zero", (_ZERO,), _zero),
        Form("gain", (_GAIN,), _gain),
        Form("gain_and_zero", (_GAIN, _ZERO), _both),
        Form("picks_up", (_PICKED, _ZERO), _picks_up, outside="the reading picks up the pressure or the command"),
    ),
    twins=("reduced_travel",),
)
