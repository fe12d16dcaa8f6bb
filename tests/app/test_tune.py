"""tune on the command line: numbers that follow the model, margins that are measured, a recommendation."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from app.commands.tune import command as tune
from app.commands.tune import span
from app.robustness import FACTORS, Job, lasting, open_plant
from control.analysis.loop import LinearLoop
from control.controller import make_controller
from control.design import DesignModel, save_design
from control.robustness import AXES, Margin, Plant, Subject, largest_cycle, scan
from control.tune import margins
from hal.errors import BadInput

DESIGN = DesignModel()


def asked(*words: str) -> dict[str, Any]:
    done = CliRunner().invoke(tune, [*words, "--processes", "1", "--json"], catch_exceptions=False)
    said: dict[str, Any] = json.loads(done.stdout)
    return said


def test_tune_follows_the_model(tmp_path: Path) -> None:
    model = tmp_path / "model.toml"
    save_design(DesignModel(compliance=0.095, a1=9.0, a2=7.0), model)
    said = asked(str(model), "-c", "if_then_line,overdrive")
    rows = said["controllers"]
    assert rows["if_then_line"]["settings"]["g"] == pytest.approx(1.0 / 0.095, rel=0.01)
    assert said["recommended"]["controller"] == "overdrive"
    for name, row in rows.items():
        make_controller(name, DESIGN, **row["settings"])


def test_margins_of_one_controller() -> None:
    measured = asked("-c", "scheduled_pi", "--margins")["controllers"]["scheduled_pi"]["measured"]
    assert set(measured) == set(AXES)
    assert 0.1 < measured["dead_time"]["bad"] < 3.0
    assert measured["softer"]["bad"] is None or measured["softer"]["bad"] > 1.1


def test_the_describing_function_is_the_more_optimistic_one() -> None:
    loop = LinearLoop("p_incremental", 1.36)
    subject = Subject("p_incremental", {"kp": 1.36}, DESIGN)
    found = lasting(Job(subject, "lasting_gain", Plant(DESIGN), (0,)))
    assert found.bad is not None and found.good is not None
    assert found.good == FACTORS[FACTORS.index(found.bad) - 1]
    assert 1.6 < found.bad <= margins(loop, DESIGN).gain


@pytest.mark.thorough
@pytest.mark.parametrize("plant", [Plant(DESIGN, dead_time_s=0.3), Plant(DESIGN, late_s=0.3)])
def test_delays_that_the_valve_has_already_are_in_its_lasting_margins(plant: Plant) -> None:
    """The first swing that lasts comes at the same 0.8 s in all, and is the same."""
    subject = Subject("pi", {"kp": 3.0, "ki": 4.0}, DESIGN)
    kind = "lasting_late" if plant.late_s else "lasting_dead_time"
    prompt, slow = (lasting(Job(subject, kind, each, (0,))) for each in (Plant(DESIGN), plant))
    assert prompt.bad == 0.8 and slow.bad == 0.5
    assert slow.swing == pytest.approx(prompt.swing)


def test_the_plant_of_a_margin_is_the_changed_one() -> None:
    """Where the scan says that it hunts, a valve of that compliance hunts; and the scan says it again."""
    subject = Subject("p_incremental", {"kp": 1.8}, DESIGN)
    found = scan(subject, AXES["softer"], Plant(DESIGN), (0,), open_plant)
    assert found.bad is not None
    softer = Plant(replace(DESIGN, compliance=found.bad * DESIGN.compliance))
    assert largest_cycle(subject, softer, 0, open_plant) == found.swing > 0.3
    assert found == scan(subject, AXES["softer"], Plant(DESIGN), (0,), open_plant)


@pytest.mark.parametrize(
    ("change", "said"),
    [({"a1": 7.0, "a2": 7.0}, "no deadband"), ({"pressure_unit": "percent"}, "convert the design model first")],
)
def test_tune_refuses_a_model_that_it_cannot_use(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    model = tmp_path / "model.toml"
    save_design(replace(DESIGN, **change), model)
    with pytest.raises(BadInput, match=said):
        CliRunner().invoke(tune, [str(model)], catch_exceptions=False)


def test_tune_refuses_an_unknown_controller() -> None:
    with pytest.raises(BadInput, match="does not exist"):
        CliRunner().invoke(tune, ["-c", "pid"], catch_exceptions=False)


def test_spans_read_as_they_are_meant() -> None:
    assert [span(Margin(0.3, 0.4)), span(Margin(None, 0.1)), span(Margin(3.0, None))] == [
        "0.3 | 0.4",
        "at 0.1",
        "none to 3",
    ]
