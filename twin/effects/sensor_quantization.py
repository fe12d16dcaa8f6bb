"""Coarse resolution of the reading: in steps, or reported only when it has changed enough."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.sensor_slots import S_BAND, S_SEEN, S_STEP
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_STEP] = values[0]


def _on_change(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_BAND, S_SEEN]] = values[0], 1.0


def _step(name: str, doc: str) -> Parameter:
    return Parameter(
        name=name,
        kind="position",
        lower=0.0,
        upper=0.1,
        starts=(0.001, 0.003, 0.01),
        scale=0.005,
        doc=doc,
        smooth=False,
    )


EFFECT = Effect(
    name="sensor_quantization",
    stage="sensor",
    claim="The reading has a coarse resolution.",
    equations="y = step * round(x / step); on_change: y = x once |x - y| > step, else as it was",
    source="Widrow, Kollar, Quantization Noise (Cambridge 2008); Miskowicz, Sensors 6 (2006) 49 (on change)",
    forms=(
        Form("uniform_steps", (_step("step", "distance of neighbouring readings"),), _apply),
        Form("on_change", (_step("step", "by how much it has to change to be reported"),), _on_change),
    ),
    evidence="events",
)
