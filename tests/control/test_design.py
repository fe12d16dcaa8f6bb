"""Design model files: what is wrong with one is said by its key."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from control.design import DesignModel, load_design, save_design
from hal.errors import BadInput


@pytest.fixture
def file(tmp_path: Path) -> Path:
    save_design(DesignModel(), tmp_path / "m.toml")
    return tmp_path / "m.toml"


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("a2 = 5.82\n", "", "valve.a2 is missing; a design model file needs it"),
        ("[valve]\n", "[walve]\n", "valve is missing"),
        ("a2 = 5.82", "a2 = 'x'", "(value 'x')"),
        ("a2 = 5.82", "a2 = {low = 1.0}", "valve.a2: Input should be a valid number"),
        ("tau = 0.3\n", "tau = -0.3\n", "ep.tau: Input should be greater than or equal to 0 (value -0.3)"),
    ],
)
def test_what_is_wrong_is_one_short_sentence(file: Path, old: str, new: str, sentence: str) -> None:
    file.write_text(file.read_text().replace(old, new))
    with pytest.raises(BadInput) as told:
        load_design(file)
    assert str(told.value).startswith(f"{file}: ")
    assert sentence in str(told.value)
    assert "{" not in str(told.value)


def test_a_file_that_is_no_toml_is_led_to_a_page_that_shows_one(file: Path) -> None:
    file.write_text("[valve\n")
    with pytest.raises(BadInput, match=r"not a TOML file .*; docs/model-format.md shows one$"):
        load_design(file)
    page = (Path(__file__).parents[2] / "docs" / "model-format.md").read_text(encoding="utf-8")
    file.write_text(page.split("```toml\n")[1].partition("```")[0])
    found = load_design(file)
    assert replace(found, effects={}) == DesignModel()
    assert found.effects == {"stiction": {"form": "one_jump", "breakaway": 0.35}}
