"""An effect that the design's file already has: it may have changed, and then it is the cause."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import a_record, judged
from twin.choose.rules import DecisionRules
from twin.fit.case import make_case
from twin.fit.channel import position_channel
from twin.fit.space import Cause, cause_starts, make_space
from twin.judge.detectable import detection_limits
from twin.judge.whereabouts import attributed
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.insert import inserted_from, plant_of
from twin.model.plant import Inserted, Plant
from twin.search.candidates import effect_causes

LAG = effect("sensor_lag").form("first_order")


def worn(lag_s: float) -> DesignModel:
    """The default design with a slow sensor, as `diagnose` writes it into a model file."""
    return replace(DesignModel(), effects={"sensor_lag": {"form": "first_order", "lag": lag_s}})


@pytest.fixture(scope="module")
def slow() -> Recording:
    return a_record(plant_of(worn(0.5)))


@pytest.mark.thorough
def test_what_the_design_has_and_the_valve_too_is_no_gap(slow: Recording) -> None:
    result, judgement = judged(slow, worn(0.5))
    assert judgement.verdict == "no_gap"
    assert result.plant() == plant_of(worn(0.5))


@pytest.mark.thorough
def test_what_grew_is_named_with_the_whole_of_its_size(slow: Recording) -> None:
    result, judgement = judged(slow, worn(0.2))
    assert [c.name for c in judgement.causes][:1] == ["sensor_lag"]
    [sensor] = [one for one in result.plant().inserted if one.effect == "sensor_lag"]
    assert sensor.values[0] == pytest.approx(0.5, abs=0.02)


@pytest.mark.thorough
def test_the_error_of_what_grew_is_put_down_to_its_own_stage(slow: Recording) -> None:
    result, _ = judged(slow, worn(0.2))
    found = attributed(result.case, result, ["sensor_lag"])
    assert found is not None
    shares = {stage: share.value for stage, share in found.items()}
    # what re-tuning moved before the sensor is no cause, and no share
    assert shares == pytest.approx({"ep": 0.0, "actuator": 0.0, "sensor": 1.0}, abs=1e-12)
    assert found["ep"].ci95 == (0.0, 0.0)


@pytest.mark.thorough
def test_nothing_is_attributed_to_a_cause_that_was_taken_back(slow: Recording) -> None:
    result, _ = judged(slow, worn(0.2))
    assert result.causes == ("sensor_lag",)
    assert attributed(result.case, result, []) is None


@pytest.mark.thorough
def test_what_went_away_is_named_too() -> None:
    result, judgement = judged(a_record(Plant(DesignModel())), worn(0.5))
    assert [c.name for c in judgement.causes][:1] == ["sensor_lag"]
    assert result.plant().inserted[0].values[0] == pytest.approx(0.0, abs=0.02)


def test_only_the_form_of_the_file_stands_trial(slow: Recording) -> None:
    design = worn(0.2)
    case = make_case([slow], design, inserted_from(design))
    channel = position_channel(case.trials, case.sigma_y)
    [cause] = [c for c in effect_causes(channel, case.base) if c.name == "sensor_lag"]
    assert cause == Cause("sensor_lag", effect("sensor_lag"), LAG, (0.2,))
    settled = Plant(DesignModel(), case.base.inserted)  # inserted for the record's sake: no file has it
    assert "sensor_lag" not in {c.name for c in effect_causes(channel, settled)}


def test_a_change_is_searched_from_what_the_design_has() -> None:
    base = plant_of(worn(0.2))
    cause = Cause("sensor_lag", effect("sensor_lag"), LAG, (0.2,))
    space = make_space(base, (cause,), (), Scales())
    assert space.plant(np.zeros(1)) == base
    lags = [space.plant(z).inserted[0].values[0] for z in cause_starts(cause, Scales())]
    assert lags == pytest.approx([0.1, 0.3, *LAG.parameters[0].starts])


@pytest.mark.thorough
def test_the_smallest_size_that_would_have_shown_is_that_of_a_change(slow: Recording) -> None:
    limits = []
    for record, design in ((a_record(Plant(DesignModel())), DesignModel()), (slow, worn(0.5))):
        result, _ = judged(record, design)
        case, channel = result.case, result.decisions[-1].findings.channel
        [test, *_] = detection_limits([channel], case.base, case.scales, [effect("sensor_lag")], DecisionRules())
        assert test.detection_limit is not None
        limits.append(test.detection_limit)
    assert 0.5 < limits[1] / limits[0] < 2.0


def test_one_effect_takes_the_place_of_another_of_its_name() -> None:
    base = plant_of(worn(0.2))
    more = Inserted("sensor_lag", LAG, (0.4,))
    assert base.having([more]).inserted == (more,)
    assert base.having([]).inserted == base.inserted


def test_numbers_that_say_how_an_effect_acts_are_settled_by_the_file() -> None:
    """Friction in motion is there or not; how soft it is in a design is no cause that could have changed."""
    design = replace(
        DesignModel(),
        effects={
            "friction_in_motion": {"form": "elastic", "presliding": 0.01, "beyond_lower": 0.0, "beyond_upper": 0.0}
        },
    )
    case = make_case([a_record(plant_of(design))], design, inserted_from(design))
    causes = effect_causes(position_channel(case.trials, case.sigma_y), case.base)
    assert "friction_in_motion" not in {c.name for c in causes}
    assert "distributed_hysteresis" in {c.name for c in causes}
    plain = effect_causes(position_channel(case.trials, case.sigma_y), Plant(DesignModel()))
    forms = {c.form.name for c in plain if c.name == "friction_in_motion" and c.form is not None}
    assert "partial" in forms and "elastic" not in forms
