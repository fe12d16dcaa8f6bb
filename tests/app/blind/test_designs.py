from __future__ import annotations

import pytest

from app.blind.designs import baseline, margin
from control.design import DesignModel
from hal.errors import BadInput
from twin.model.insert import inserted_from


def test_the_thesis_family_is_its_design() -> None:
    assert baseline("thesis") == DesignModel() and margin("thesis").position == 0.0


def test_the_healthy_reference_valve_has_what_its_records_show_and_a_small_margin() -> None:
    design = baseline("reference")
    assert [one.effect for one in inserted_from(design)] == [
        "ep_rate_limit",
        "friction_in_motion",
        "stiction",
        "spring_asymmetry",
        "sensor_lag",
    ]
    assert margin("reference").pressure < 0.003
    assert design.a1 == pytest.approx(8.78, abs=0.1) and design.compliance == pytest.approx(0.19, rel=0.03)
    assert 0.0 < margin("reference").position < 0.003 * design.travel


def test_a_family_without_a_baseline_says_how_to_make_one() -> None:
    with pytest.raises(BadInput, match="blind_baseline"):
        baseline("positioner")
