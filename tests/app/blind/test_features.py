from __future__ import annotations

import json

import numpy as np
import pytest

from app.blind.features import decision_features
from control.design import DesignModel
from logs.recording import Recording
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from twin.diagnose import Settings, diagnose
from twin.search.search_rules import SearchRules


@pytest.mark.thorough
def test_a_delay_shows_in_the_pressure_channel_alone() -> None:
    command = np.repeat([0.0, 12.0, 6.0, 11.0, 7.0], 120)
    time_s = 0.1 * np.arange(command.size)
    pressure, position = record(make_physics("thesis", 4, effects={"dead_time": 0.8}), time_s, command)
    recording = Recording("x", time_s, command, position, pressure)
    outcome = diagnose([recording], DesignModel(), (), Settings(search=SearchRules(most=1, threads=1)))
    features = decision_features(outcome)
    json.dumps(features, allow_nan=False)
    first, second = features["pressure"], features["position"]
    assert isinstance(first, dict) and isinstance(second, dict)
    assert first["accepted"] == ["dead_time"] and first["score_gap_to_rival"] > 0.0
    assert first["none_mse"] > 50.0 and first["accepted_mse"] < 2.0
    assert second["accepted"] == [] and second["none_mse"] < 3.0
    assert first["without"]["dead_time"]["mse"] > 1.2 * first["accepted_mse"] and second["without"] == {}
    assert first["best"][0]["score"] >= first["best"][1]["score"]
