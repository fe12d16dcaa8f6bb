"""Units and headers: what is understood, and that nothing is guessed."""

from __future__ import annotations

import pytest

from hal.errors import BadInput
from logs.roles import parse_pairs, split_header
from logs.units import Quantity, conversion


@pytest.mark.parametrize(
    ("text", "quantity", "value", "expected", "unit"),
    [
        ("kPa", "pressure", 100.0, 14.503774, "psi"),
        ("bar", "pressure", 1.0, 14.503774, "psi"),
        ("psig", "pressure", 9.0, 9.0, "psi"),
        ("psia", "pressure", 23.696, 9.0, "psi"),
        ("kPaa", "pressure", 101.325, 0.0, "psi"),
        ("bar(a)", "pressure", 2.01325, 14.503774, "psi"),
        ("mA(4..20=0..2 bara)", "pressure", 12.0, 14.503774 - 14.696, "psi"),
        ("inH2O", "pressure", 100.0, 3.61273, "psi"),
        ("mm", "position", 25.4, 1.0, "in"),
        ("µm", "position", 25_400.0, 1.0, "in"),
        ("ms", "time", 250.0, 0.25, "s"),
        ("min", "time", 2.0, 120.0, "s"),
        ("%", "position", 40.0, 40.0, "percent"),
        ("fraction", "position", 0.4, 40.0, "percent"),
        ("percent(3..15 psi)", "pressure", 25.0, 6.0, "psi"),
        ("fraction(0..2 in)", "position", 0.25, 0.5, "in"),
        ("mA(4..20=0.2..1 bar)", "pressure", 12.0, 8.7022642, "psi"),
        ("V(0..5=0..100 percent)", "position", 2.0, 40.0, "percent"),
        ("counts(0..65535=-1..1 in)", "position", 65535.0, 1.0, "in"),
    ],
)
def test_values_come_out_in_house_units(
    text: str, quantity: Quantity, value: float, expected: float, unit: str
) -> None:
    how = conversion(text, quantity)
    assert how.scale * value + how.shift == pytest.approx(expected, rel=1e-4, abs=1e-4) and how.unit == unit


@pytest.mark.parametrize("unit", ["psia", "percent(3..15 psia)"])
def test_it_is_said_that_the_atmosphere_is_taken_off_an_absolute_pressure(unit: str) -> None:
    assert "14.696 psi of the atmosphere taken off" in conversion(unit, "pressure").said
    assert "atmosphere" not in conversion(unit.replace("psia", "kPa"), "pressure").said


@pytest.mark.parametrize(
    ("text", "quantity"),
    [("mA", "pressure"), ("V(3..15 psi)", "pressure"), ("V(5..5=0..1 in)", "position"), ("percent", "time"),
     ("kg", "pressure"), ("((", "position"), ("3", "position"), ("mm(1..2=3..4 psi)", "position")],
)  # fmt: skip
def test_what_is_no_such_unit_is_refused_by_name(text: str, quantity: Quantity) -> None:
    with pytest.raises(BadInput):
        conversion(text, quantity)


@pytest.mark.parametrize(
    ("header", "label", "unit"),
    [
        ("pressure [kPa]", "pressure", "kPa"),
        ("Pressure (bar)", "pressure", "bar"),
        ("pressure_psi", "pressure", "psi"),
        ("actuator pressure/kPa", "actuator pressure", "kPa"),
        ("Pressure, mbar", "pressure", "mbar"),
        ("pressure_%", "pressure", "%"),
        ("pressure", "pressure", ""),
        ("pressure_raw", "pressure raw", ""),
        ("ep_pressure", "ep pressure", ""),
    ],
)
def test_headers_are_split_at_their_unit_only(header: str, label: str, unit: str) -> None:
    column = split_header(header, "pressure")
    assert (column.label, column.unit, column.header) == (label, unit, header)


def test_pairs_take_quotes_for_commas_and_refuse_twice() -> None:
    assert parse_pairs('time=t,command="Soll, kPa"', "--map") == {"time": "t", "command": "Soll, kPa"}
    with pytest.raises(BadInput, match="given twice"):
        parse_pairs("time=a,time=b", "--map")
