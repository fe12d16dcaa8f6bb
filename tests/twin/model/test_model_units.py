"""A design model in the units of a recording."""

from __future__ import annotations

import pytest

from control.design import DesignModel
from hal.errors import BadInput
from twin.model.model_units import in_units_of


def test_every_number_and_every_effect_is_converted() -> None:
    psi = DesignModel(effects={"stiction": {"form": "one_jump", "breakaway": 1.0}, "lvdt_drift": {"rate": 1e-4}})
    metric = in_units_of(psi, "kPa", "mm")
    assert metric.a1 == pytest.approx(8.78 * 6.894757, rel=1e-6)
    assert metric.compliance == pytest.approx(0.19 * 25.4 / 6.894757, rel=1e-6)
    assert (metric.travel, metric.rate_limit) == pytest.approx((0.5625 * 25.4, 0.12 * 25.4))
    assert (metric.tau_s, metric.ep_tau_s) == (psi.tau_s, psi.ep_tau_s)
    assert metric.effects["stiction"] == {"form": "one_jump", "breakaway": pytest.approx(6.894757, rel=1e-6)}
    assert metric.effects["lvdt_drift"]["rate"] == pytest.approx(25.4e-4)


@pytest.mark.parametrize(
    ("model", "record", "sentence"),
    [
        (
            "in",
            "percent",
            r"position in \[in\], the recording in \[percent\].*--units 'position=percent\(0..0.5625 in\)'",
        ),
        ("percent", "in", r"position in \[percent\], the recording in \[in\].*identify a model from such a recording"),
    ],
)
def test_percent_beside_another_unit_asks_for_the_range(model: str, record: str, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        in_units_of(DesignModel(position_unit=model), "psi", record)


def test_a_model_in_absolute_pressure_is_refused() -> None:
    with pytest.raises(BadInput, match=r"\[psia\], which is not 0 where \[psi\] is"):
        in_units_of(DesignModel(pressure_unit="psia"), "psi", "in")


def test_there_and_back() -> None:
    back = in_units_of(in_units_of(DesignModel(), "bar", "cm"), "psi", "in")
    assert back.a2 == pytest.approx(5.82)
    assert back.pressure_unit == "psi"


def test_the_same_unit_under_another_name_is_no_conversion() -> None:
    assert in_units_of(DesignModel(pressure_unit="psig"), "psi", "in") == DesignModel()


@pytest.mark.parametrize("unit", ["percent", "furlong"])
def test_what_cannot_be_converted(unit: str) -> None:
    with pytest.raises(BadInput, match=unit):
        in_units_of(DesignModel(pressure_unit=unit), "psi", "in")
