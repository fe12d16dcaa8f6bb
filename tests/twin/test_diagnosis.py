"""The JSON of a diagnosis: the promised keys, strict values, groups that sum to one."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from logs.recording import DataNote
from twin.diagnosis import (
    Bin,
    Cause,
    Diagnosis,
    EffectTest,
    Estimate,
    Gap,
    NextExperiment,
    Ranked,
    Share,
    Where,
    write_diagnosis,
)
from twin.strict import json_ready

# as promised on the interfaces page
PROMISED = "verdict causes confusable ranking where gap next_experiment data_quality version"  # the interfaces page


def example() -> Diagnosis:
    return Diagnosis(
        verdict="effects",
        statement="Two causes.",
        causes=(
            Cause("creep", "actuator", 0.5),
            Cause("stiction", "actuator", 0.96, 3.4, {"breakaway": Estimate(1.9, (1.8, 2.0), "psi")}),
        ),
        ranking=(Ranked("stiction", 0.96, 0.16), Ranked("creep", 0.5, float("nan"))),
        gap=Gap(4.4, 3.1, 0.16, 0.14, Share(0.99, (0.98, 0.995))),
        where=Where(
            stage={"ep": Share(-0.1, (-0.2, 0.0)), "actuator_or_sensor": Share(1.1, (1.0, 1.2))},
            position=(Bin(0.0, 0.3, Share(1.0, (1.0, 1.0))),),
        ),
        confusable=(("nonlinear_spring", "lvdt_nonlinearity"),),
        next_experiment=NextExperiment("separates", "next.toml"),
        data_quality=(DataNote("NaN in position_in", "left out", 3, 17),),
        effects_tested=(EffectTest("dead_time", True, "", "delay", 0.02, "s"),),
        residual_signature={"shape": np.array([1.0, np.inf])},
        version="0.1.0",
    )


def test_promised_keys_and_values() -> None:
    document = example().to_json()
    assert set(PROMISED.split()) <= set(document)
    causes = document["causes"]
    assert isinstance(causes, list)
    assert [cause["name"] for cause in causes] == ["stiction", "creep"]  # by probability
    assert causes[0]["parameters"]["breakaway"] == {"value": 1.9, "ci95": [1.8, 2.0], "unit": "psi"}
    note = {"what": "NaN in position_in", "handled": "left out", "rows": 3, "first_row": 17}
    assert document["data_quality"] == [note]
    tested = document["effects_tested"]
    assert isinstance(tested, dict)
    assert set(tested["dead_time"]) == {"testable", "reason", "parameter", "detection_limit", "unit", "form"}
    where = document["where"]
    assert isinstance(where, dict)
    assert where["stage"]["ep"] + where["stage"]["actuator_or_sensor"] == pytest.approx(1.0)
    assert where["stage"]["ci95"]["ep"] == [-0.2, 0.0]
    assert where["direction"] is None
    assert where["position"] == [{"from": 0.0, "to": 0.3, "share": 1.0, "ci95": [1.0, 1.0]}]
    assert document["gap"] == {
        "unit": "percent_of_travel",
        "before": 4.4,
        "retuned": 3.1,
        "after": 0.16,
        "noise_floor": 0.14,
        "reducible_closed": 0.99,
        "ci95": [0.98, 0.995],
    }


def test_file_is_strict_json(tmp_path: Path) -> None:
    path = tmp_path / "diagnosis.json"
    write_diagnosis(example(), path)

    def refuse(text: str) -> None:
        raise AssertionError(text)

    read = json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)
    assert read["ranking"][1]["heldout_gap"] is None
    assert read["residual_signature"]["shape"] == [1.0, None]


def test_numbers_are_rounded_and_foreign_types_refused() -> None:
    assert json_ready({"a": (1 / 3, np.float64(2.0), np.int64(4), True)}) == {"a": [0.333333, 2.0, 4, True]}
    assert json_ready([NextExperiment("separates")]) == [{"why": "separates", "file": None}]
    with pytest.raises(TypeError, match="complex"):
        json_ready(1j)
