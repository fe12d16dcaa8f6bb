from __future__ import annotations

import pytest

from app.blind.sizes import check_sizes
from control.design import DesignModel
from sim_device.physics.catalog import imperfections, parameters
from sim_device.sealed import Cause, Label
from tests.app.blind.lines import said
from twin.model.catalog import effects


def answer(name: str, parameter: str, value: float, low: float, high: float) -> dict[str, object]:
    found = said("effect", (name, 0.9))
    found["causes"][0]["parameters"] = {parameter: {"value": value, "ci95": [low, high], "unit": ""}}
    return found


def truth(name: str, form: str, size: float, family: str = "thesis") -> Label:
    return Label("effect", family, 1, (Cause(name, "sensor", form, size, "", "large"),))


@pytest.mark.parametrize(
    ("name", "form", "size", "parameter", "value"),
    [
        ("dead_time", "default", 0.4, "delay", 0.4),
        ("lvdt_calibration", "zero", -0.02, "zero", -0.01125),
        ("reduced_travel", "open", 0.05625, "missing", 0.1),
        ("distributed_hysteresis", "even", 0.3, "spread", 0.34641),
        ("sensor_dropouts", "spike", 0.01, "rate", 0.01),
        ("fill_exhaust_asymmetry", "tau", 2.0, "asymmetry", -0.5),  # exhaust 3 tau, filling 1 tau
        ("fill_exhaust_asymmetry", "tau", -2.0, "asymmetry", 0.5),
        ("parameter:tau", "default", -0.2, "tau", 2.16),
        ("parameter:rate_limit", "default", 0.5, "rate_limit", 0.06),
        ("parameter:deadband", "default", 0.1, "deadband", 3.06),
    ],
)
def test_the_true_value_has_no_error(name: str, form: str, size: float, parameter: str, value: float) -> None:
    said_ = answer(name, parameter, value, value - 0.01, value + 0.01)
    (check,) = check_sizes(truth(name, form, size), said_, DesignModel())
    assert check.error == pytest.approx(0.0, abs=1e-5) and check.covered


def test_the_error_is_a_share_of_the_fault_and_not_of_the_number() -> None:
    said_ = answer("parameter:tau", "tau", 2.7 * 1.15, 3.0, 3.2)
    (check,) = check_sizes(truth("parameter:tau", "default", 0.1), said_, DesignModel())
    assert check.error == pytest.approx(0.5) and not check.covered


def test_what_was_not_named_or_has_another_parameter_is_not_compared() -> None:
    assert check_sizes(truth("dead_time", "default", 0.4), said("no_gap"), DesignModel()) == []
    said_ = answer("lvdt_calibration", "gain", 0.01, 0.0, 0.02)
    assert check_sizes(truth("lvdt_calibration", "zero", 0.01), said_, DesignModel()) == []


def test_every_compared_fault_exists_on_both_sides() -> None:
    from app.blind.sizes import _EFFECTS, _NUMBERS

    forms = {f"{i.name}/{form}" for f in ("thesis", "reference") for i in imperfections(f) for form in i.forms}
    for key, (parameter, _) in _EFFECTS.items():
        name = key.partition("/")[0]
        assert key in forms or any(form.startswith(f"{name}/") for form in forms if "/" not in key)
        assert any(p.name == parameter for form in effects()[name].forms for p in form.parameters)
    assert {f"parameter:{name}" for name in _NUMBERS} >= {p.name for p in parameters("thesis")}
