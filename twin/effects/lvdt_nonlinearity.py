"""The reading is a curved function of position."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import S_BOW, S_SWING


def _parameter(name: str, doc: str) -> Parameter:
    return Parameter(
        name=name,
        kind="fraction",
        lower=-0.25,
        upper=0.25,
        starts=(-0.01, 0.01),
        scale=0.02,
        doc=doc,
    )


_BOW = _parameter("bow", "excess of the reading at mid travel, fraction of travel")
_SWING = _parameter("swing", "amplitude of the S-shaped part, excess at 21 % of travel, fraction of travel")


def _bow(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_BOW] = values[0]


def _swing(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_SWING] = values[0]


def _both(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_BOW] = values[0]
    c.sensor[S_SWING] = values[1]


EFFECT = Effect(
    name="lvdt_nonlinearity",
    stage="sensor",
    claim="The reading is a curved function of position.",
    equations="y = x + travel (bow 4 xi (1 - xi) + swing 10.4 xi (1 - xi) (1 - 2 xi)), xi = x / travel",
    source="Herceg, Schaevitz Handbook of Measurement and Control (1972); Doebelin, Measurement Systems (McGraw-Hill)",
    forms=(Form("bow", (_BOW,), _bow), Form("swing", (_SWING,), _swing), Form("bow_and_swing", (_BOW, _SWING), _both)),
    twins=("nonlinear_spring", "flow_force"),
    absorbs=("compliance", "offset"),
)
