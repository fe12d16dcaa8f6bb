"""What a reader sees is in that reader's units; what is computed and stored is not touched by it."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from control.design import DesignModel, load_design, save_design
from logs.spoken import Spoken
from tests.twin.report_example import diagnosis, series
from twin.diagnosis import Diagnosis, EffectTest
from twin.judge.moved import moved_numbers
from twin.model.model_units import as_spoken, in_units_of
from twin.next.file import explained
from twin.next.propose import _blind_words
from twin.report.answered import answered, series_answered
from twin.report.page import render
from twin.report.statement import statement

BAR = 0.0689475729
BAR_AND_MM = Spoken("bar", "mm")


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    return replace(diagnosis(series(60)), spoken=BAR_AND_MM)


def test_sizes_bins_and_limits_are_converted_with_their_units(found: Diagnosis) -> None:
    shown = answered(found, "psi", "in")
    name, given = next((n, e) for n, e in found.causes[0].parameters.items() if e.unit == "psi")
    said = shown.causes[0].parameters[name]
    assert said.unit == "bar"
    assert said.value == pytest.approx(given.value * BAR, rel=1e-8)
    assert said.ci95 == pytest.approx([end * BAR for end in given.ci95], rel=1e-8)
    assert found.where.position is not None and shown.where.position is not None
    assert shown.where.position[-1].high == pytest.approx(25.4 * found.where.position[-1].high)
    assert [b.share for b in shown.where.position] == [b.share for b in found.where.position]
    for before, after in zip(found.effects_tested, shown.effects_tested, strict=True):
        assert after.unit == BAR_AND_MM.unit(before.unit)
    assert shown.gap == found.gap and shown.ranking == found.ranking


def test_noise_and_signature_are_converted_where_a_unit_stands_beside(found: Diagnosis) -> None:
    swing = {"amplitude": 2.0, "frequency_hz": 0.5, "share": 0.25, "unit": "psi", "signal": "pressure"}
    noise = {"position": {"sigma": 0.001, "unit": "in", "correlation_samples": 1.5}}
    shown = answered(replace(found, noise=noise, residual_signature={"swings": swing}), "psi", "in")
    assert shown.noise == {"position": {"sigma": pytest.approx(0.0254), "unit": "mm", "correlation_samples": 1.5}}
    assert shown.residual_signature["swings"] == {**swing, "amplitude": pytest.approx(2.0 * BAR), "unit": "bar"}


def test_stored_numbers_are_those_of_the_computation(found: Diagnosis) -> None:
    plain = replace(found, spoken=Spoken()).to_json()
    asked = found.to_json()
    assert asked.pop("sentences_in") == {"pressure": "bar", "position": "mm"}
    assert plain.pop("sentences_in") == {"pressure": "psi", "position": "in"}
    assert asked == plain


def test_the_sentence_is_in_the_readers_units(found: Diagnosis) -> None:
    sentence = statement(found)
    assert re.search(r"\d bar", sentence) and "psi" not in sentence
    assert "psi" in statement(replace(found, spoken=Spoken()))


def test_the_page_and_its_figures_have_no_other_units(found: Diagnosis) -> None:
    shown = series_answered(series(60), BAR_AND_MM)
    page = render(replace(answered(found, "psi", "in"), statement=statement(found)), shown)
    assert "[bar]" in page
    told = page.partition('<h2><span class="n">6</span>')[0]  # the quality notes of the example are not ours
    assert "[psi]" not in told and not re.search(r"\d psi", told)


def test_what_is_drawn_keeps_its_percent_of_travel() -> None:
    given = series(20)
    shown = series_answered(given, BAR_AND_MM)
    assert np.allclose(shown.percent(shown.position), given.percent(given.position), rtol=1e-12)
    assert np.allclose(shown.command, given.command * BAR, rtol=1e-8)
    assert series_answered(given, Spoken()) is given


def test_a_design_that_was_given_in_bar_and_mm_comes_back_digit_by_digit(tmp_path: Path) -> None:
    file = tmp_path / "valve.toml"
    given = DesignModel(
        0.3, 0.60536, 0.40128, 69.995, 2.7, 3.048, 14.2875, "bar", "mm", {"stiction": {"breakaway": 0.0345}}
    )
    house = replace(in_units_of(given, "psi", "in"), spoken=BAR_AND_MM)
    assert house.a1 == pytest.approx(8.78, rel=1e-4)
    save_design(as_spoken(house), file)
    assert load_design(file) == given
    assert tomllib.loads(file.read_text())["units"] == {"pressure": "bar", "position": "mm", "time": "s"}


def test_moved_numbers_and_limits_of_an_experiment_are_said_likewise() -> None:
    design = DesignModel(spoken=BAR_AND_MM)
    (note,) = moved_numbers(design, replace(design, a1=9.78, a2=6.82), ())
    assert "offset 0.5723 instead of 0.5033 bar" in note.what
    test = EffectTest("stiction", True, "", "breakaway", 0.5, "psi", "one_jump")
    assert "above 0.034 bar" in _blind_words(["stiction"], [test], BAR_AND_MM)


def test_the_next_experiment_says_its_commands_in_both() -> None:
    text = 'kind = "ramp"\nlow = 4.0\nhigh = 13.0\n'
    first, rest = explained(text, BAR_AND_MM).split("\n", 1)
    assert rest == text
    assert first.startswith("# Commands are in psi") and first.endswith("psi are 0.276 to 0.896 bar.")
    assert explained(text, Spoken()) == text
