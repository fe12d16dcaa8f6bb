"""Sizes in the units of whoever asked: what is converted, by how much, and what is left alone."""

from __future__ import annotations

import numpy as np
import pytest

from logs.recording import Recording
from logs.spoken import HOUSE, Spoken, of_its_file, spoken_by, spoken_in

BAR = 0.0689475729


def recording(**written: str) -> Recording:
    column = np.zeros(3)
    return Recording("r", np.arange(3.0), column, column, meta={"written": written} if written else {})


@pytest.mark.parametrize(
    ("unit", "said", "factor"),
    [
        ("psi", "bar", BAR),
        ("in", "mm", 25.4),
        ("in/psi", "mm/bar", 25.4 / BAR),
        ("psi/in", "bar/mm", BAR / 25.4),
        ("psi/s", "bar/s", BAR),
        ("s/psi", "s/bar", 1.0 / BAR),
        ("s", "s", 1.0),
        ("1", "1", 1.0),
        ("percent", "percent", 1.0),
    ],
)
def test_a_size_is_converted_by_its_unit(unit: str, said: str, factor: float) -> None:
    spoken = Spoken("bar", "mm")
    assert spoken.unit(unit) == said
    assert spoken.value(2.0, unit) == pytest.approx(2.0 * factor, rel=1e-8)


def test_who_speaks_as_the_house_gets_its_numbers_to_the_last_bit() -> None:
    assert HOUSE.is_house and HOUSE.value(0.1 + 0.2, "in/psi") == 0.1 + 0.2 and HOUSE.written(1 / 3, "psi") == 1 / 3
    assert not Spoken("bar", "in").is_house


def test_a_text_has_digits_and_unit_and_no_unit_for_a_share() -> None:
    assert Spoken("kPa", "mm").text(0.498, "psi", 3) == "3.43 kPa"
    assert Spoken("kPa", "mm").text(0.25, "1", 3) == "0.25"


def test_a_unit_with_a_stroke_of_its_own_is_put_into_brackets_beside_another() -> None:
    assert Spoken("kgf/cm^2", "mm").unit("in/psi") == "mm/(kgf/cm^2)"
    assert Spoken("kgf/cm^2", "mm").unit("psi") == "kgf/cm^2"


def test_a_written_number_has_no_digits_of_the_factor() -> None:
    assert Spoken("bar", "mm").written(0.56250000000000011, "in") == 14.2875


@pytest.mark.parametrize(
    ("pressure", "position", "said"),
    [
        ("psig", "inches", HOUSE),
        ("", "", HOUSE),
        ("percent", "fraction", HOUSE),
        ("kpa", "mm", Spoken("kPa", "mm")),
        ("bara", "cm", Spoken("bar", "cm")),
        ("mA(4..20=0.2..1 bar)", "percent(0..14.3 mm)", Spoken("bar", "mm")),
    ],
)
def test_what_was_written_says_how_to_speak(pressure: str, position: str, said: Spoken) -> None:
    assert spoken_in(pressure, position) == said


def test_files_are_answered_alike_only_if_they_are_alike() -> None:
    bar, kpa, run = recording(command="bar", position="mm"), recording(command="kPa", position="mm"), recording()
    assert spoken_by([bar, bar, run]) == Spoken("bar", "mm")  # a run of this house follows the files
    assert spoken_by([bar, kpa]) == HOUSE == spoken_by([run])


def test_a_column_is_spoken_of_as_it_stands_in_its_file() -> None:
    assert of_its_file(recording(command="bar", position="mm")) == Spoken("bar", "mm")
    assert of_its_file(recording(command="bar", position="V(0..5=0..14 mm)")) == Spoken("bar", "in")
