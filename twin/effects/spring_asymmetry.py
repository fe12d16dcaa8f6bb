"""Different compliance closing and opening: the two curves of the hysteresis are not parallel."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.valve_slots import V_TAU_CLOSE_S, V_TAU_OPEN_S
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter


def _asymmetry(doc: str) -> tuple[Parameter]:
    return (
        Parameter(
            name="asymmetry",
            kind="fraction",
            lower=-0.45,
            upper=0.45,
            starts=(-0.08, -0.01, 0.01, 0.08),
            scale=0.08,
            doc=doc,
        ),
    )


def _hinged_open(c: Coefficients, values: Sequence[float]) -> None:
    # The stiffness, not the compliance, is split evenly: then the mean of the two curves does not move.
    c.close_gain = 1.0 / (1.0 - values[0])
    c.open_gain = 1.0 / (1.0 + values[0])


def _hinged_mid(c: Coefficients, values: Sequence[float]) -> None:
    _hinged_open(c, values)
    shift = 0.5 * c.design.travel / c.design.compliance * values[0]
    c.close_shift += shift
    c.open_shift -= shift


def _with_lags(c: Coefficients, values: Sequence[float]) -> None:
    # A time constant is drag over stiffness.
    _hinged_open(c, values)
    c.valve[V_TAU_CLOSE_S] /= 1.0 - values[0]
    c.valve[V_TAU_OPEN_S] /= 1.0 + values[0]


def _at_stem(c: Coefficients, values: Sequence[float]) -> None:
    # The same for friction in the force balance; a pull that a stop limits has pressure to spare.
    less = values[0] * c.xi * c.design.travel / c.design.compliance
    c.bend_at_stem(-less, less)


EFFECT = Effect(
    name="spring_asymmetry",
    stage="actuator",
    claim="The compliance differs between closing and opening (k1 != k2).",
    equations="closing p = a1 + w/k1, opening p = a2 + w/k2, 1/k1 = (1 - asymmetry)/k, 1/k2 = (1 + asymmetry)/k; "
    "with_lags: time constants in proportion to k1 and k2; at_stem: x in place of w where they differ from 1/k",
    source="Lustrino, MIT thesis (2009), section 2.1 (k1 and k2 measured, their mean used)",
    forms=(
        Form(
            "hinged_open",
            _asymmetry("half the difference of the stiffnesses, deadband kept fully open"),
            _hinged_open,
        ),
        Form(
            "hinged_mid", _asymmetry("half the difference of the stiffnesses, deadband kept at mid travel"), _hinged_mid
        ),
        Form("with_lags", _asymmetry("half the difference of the stiffnesses, felt in motion, too"), _with_lags),
        Form("at_stem", _asymmetry("half the difference of the stiffnesses that the stem feels"), _at_stem),
    ),
    twins=("position_dependent_friction",),
    absorbs=("compliance", "deadband", "offset"),
)
