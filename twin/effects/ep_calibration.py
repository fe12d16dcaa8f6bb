"""The converter's pressure is off by a static gain error, a zero error, or both."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.ep_slots import EP_DRIFTS, EP_DRIFTS_S, EP_GAIN, EP_ZERO
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter

_GAIN = Parameter(
    name="gain",
    kind="fraction",
    lower=-0.3,
    upper=0.3,
    starts=(-0.004, 0.004),
    scale=0.03,
    doc="relative gain error, 0 = right",
)
_ZERO = Parameter(
    name="zero",
    kind="pressure",
    lower=-2.0,
    upper=2.0,
    starts=(-0.04, 0.04),
    scale=0.3,
    doc="pressure above the command at zero command",
)
_CHANGE = Parameter(
    name="change",
    kind="pressure",
    lower=-2.0,
    upper=2.0,
    starts=(-0.05, 0.05),
    scale=0.3,
    doc="by how much the zero moves in the end",
)
_SETTLING = Parameter(
    name="settling",
    kind="time",
    lower=10.0,
    upper=3600.0,
    starts=(60.0, 400.0),
    scale=300.0,
    doc="time constant with which it does, from the beginning of each recording",
    neutral=300.0,
    size=False,
)


def _both(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_GAIN] = 1.0 + values[0]
    c.ep[EP_ZERO] += values[1]


def _gain(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_GAIN] = 1.0 + values[0]


def _zero(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_ZERO] += values[0]


def _drifts(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_ZERO] += values[0]
    c.ep[[EP_DRIFTS, EP_DRIFTS_S]] = values[1:]


EFFECT = Effect(
    name="ep_calibration",
    stage="ep",
    claim="Pressure settles away from the command: a gain error, a zero error, or both.",
    equations="dp/dt = ((1 + gain) u + zero - p) / tau; a zero that drifts is no calibration, only told from it: "
    "zero + change (1 - exp(-t / settling))",
    source="IEC 61298-2, Process measurement and control devices, part 2: tests under reference conditions",
    forms=(
        Form("zero", (_ZERO,), _zero),
        Form("gain", (_GAIN,), _gain),
        Form("gain_and_zero", (_GAIN, _ZERO), _both),
        Form(
            "zero_drifts",
            (_ZERO, _CHANGE, _SETTLING),
            _drifts,
            by_pressure=True,
            outside="the zero of the converter or of its gauge drifts",
        ),
    ),
)
