"""Effects of the same signature: which of the two is named, and how sure that is."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record, judged
from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.choose.twins import _more_usual, settled, with_usual_twins
from twin.choose.usual import log_usual
from twin.choose.weigh import Weights, _sets, weigh
from twin.fit.space import Cause
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import simulate_recording
from twin.search.claims import together


@cache
def late(lag_s: float) -> Decision:
    """What the position says of a valve whose reading follows its stem late."""
    lag = Inserted("sensor_lag", effect("sensor_lag").form("first_order"), (lag_s,))
    return judged(a_record(Plant(DesignModel(), (lag,))))[0].decisions[-1]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("lag_s", "name", "twin"), [(0.08, "sensor_lag", "additional_lag"), (6.0, "additional_lag", "sensor_lag")]
)
def test_of_twins_the_one_of_the_more_usual_size_is_named(lag_s: float, name: str, twin: str) -> None:
    decision = settled(late(lag_s), DecisionRules(), Weights())
    assert decision.names == (name,)
    weighed = weigh(decision, Weights())
    assert 0.55 < weighed.probability[name] <= Weights().twin_ceiling
    assert 0.1 < weighed.probability[twin] < weighed.probability[name]
    assert weighed.sets == ((name, twin),)


@pytest.mark.thorough
def test_what_the_record_says_comes_first() -> None:
    decision = late(6.0)
    fits = {f.names[0]: f for f in decision.findings.fits if len(f.names) == 1}
    short, long = fits["sensor_lag"], fits["additional_lag"]
    accepted = replace(decision, accepted=short)
    for share, usual in ((1.0, True), (1.2, False)):
        other = replace(long, residuals=share * short.residuals)
        assert _more_usual(accepted, ("sensor_lag", [short]), ("additional_lag", [other]), Weights()) is usual


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("effect_name", "form", "lag_s", "named"),
    [
        ("sensor_lag", "first_order", 0.25, "sensor_lag"),  # as long as a valve's; but that would have to be behind it
        ("additional_lag", "after_play", 0.25, "additional_lag"),
        ("additional_lag", "after_play", 0.1, "additional_lag"),  # as short as a filter's
        ("additional_lag", "inertia", 0.4, "additional_lag"),
    ],
)
def test_a_record_that_tells_the_forms_apart_tells_the_twins_apart(effect_name, form, lag_s, named) -> None:
    """Full strokes at the highest speed, onto both stops: what lags before the stem does not lag as one behind it."""
    lag = Inserted(effect_name, effect(effect_name).form(form), (lag_s,))
    decision = settled(judged(a_record(Plant(DesignModel(), (lag,))))[0].decisions[-1], DecisionRules(), Weights())
    assert decision.names == (named,)


@pytest.mark.thorough
def test_a_twin_is_tried_in_the_form_that_is_one_and_counts_once() -> None:
    decision = settled(late(6.0), DecisionRules(), Weights())
    rivals = [f for f in decision.findings.fits if f.names == ("additional_lag",)]
    assert len(rivals) == 1
    cause = rivals[0].space.causes[0]
    assert cause.form is not None and cause.form.name in effect("additional_lag").same_as


@pytest.mark.thorough
def test_how_usual_a_size_is() -> None:
    fits = {f.names[0]: f for f in late(6.0).findings.fits if len(f.names) == 1}
    assert log_usual(fits["sensor_lag"]) < log_usual(fits["additional_lag"])  # 6 s is long for a filter
    assert log_usual(fits["stiction"]) == 0.0  # nothing is known of it


@pytest.mark.thorough
def test_creep_has_no_sharp_offset_beside_it() -> None:
    """What gives way under the whole force has moved the curves too, by as much as has crept before the record."""
    creep = Inserted("creep", effect("creep").form("force_tail"), (0.06, 40.0))
    moved = DesignModel(a1=8.78 - 0.12, a2=5.82 - 0.12)
    _, judgement = judged(a_record(Plant(moved, (creep,))))
    assert [c.name for c in judgement.causes] == ["creep"]
    form = Cause("creep", effect("creep"), effect("creep").form("force_tail"))
    assert not together(form, Cause("parameter:offset"))
    assert together(form, Cause("parameter:rate_limit"))


@pytest.mark.thorough
def test_twins_of_whose_sizes_nothing_is_known_stay_as_the_record_has_them() -> None:
    bow = Inserted("nonlinear_spring", effect("nonlinear_spring").form("bow"), (0.3,))
    decision = judged(a_record(Plant(DesignModel(), (bow,))))[0].decisions[-1]
    assert decision.names == ("nonlinear_spring",)
    assert with_usual_twins(decision, replace(Weights(), temperature=1e9)) is decision


def test_a_lag_of_the_stem_and_one_of_the_sensor_add_up_in_any_order() -> None:
    filtered = Inserted("sensor_lag", effect("sensor_lag").form("first_order"), (0.2,))
    late_stem = Inserted("additional_lag", effect("additional_lag").form("behind_stem"), (0.5,))
    record = a_record(Plant(DesignModel()))
    readings = {
        names: simulate_recording(Plant(DesignModel(), parts), record)[1]
        for names, parts in {
            "both": (filtered, late_stem),
            "turned": (late_stem, filtered),
            "stem": (late_stem,),
            "sensor": (filtered,),
        }.items()
    }
    assert np.array_equal(readings["both"], readings["turned"])
    for alone in ("stem", "sensor"):
        assert np.abs(readings["both"] - readings[alone]).max() > 0.005


@pytest.mark.thorough
def test_a_set_holds_each_name_once_however_many_forms_of_it_come_near() -> None:
    decision = settled(late(6.0), DecisionRules(), Weights())
    near = [f for f in decision.findings.fits if f.names == ("sensor_lag",)]
    several = replace(decision, findings=replace(decision.findings, fits=(*decision.findings.fits, *near, *near)))
    assert weigh(several, Weights()).sets == (("additional_lag", "sensor_lag"),)
    apart = replace(near[0], residuals=1.0001 * near[0].residuals)
    fits = [decision.accepted, near[0], apart]
    found = _sets(decision, fits, np.array([0.4, 0.3, 0.3]), Weights())
    assert found == (("additional_lag", "sensor_lag"),)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "form", "values"),
    [
        ("flow_force", "stem_hump", (0.25,)),
        ("flow_force", "peak", (0.25, 0.9)),
        ("flow_force", "stem_peak", (-0.25, -0.9)),
        ("nonlinear_spring", "hardens", (0.5,)),
        ("nonlinear_spring", "bow_and_swing", (0.05, 0.2)),
    ],
)
def test_a_push_between_the_ends_is_the_fluids_and_one_that_grows_or_turns_is_the_springs(name, form, values) -> None:
    one = Inserted(name, effect(name).form(form), values)
    decision = settled(judged(a_record(Plant(DesignModel(), (one,))))[0].decisions[-1], DecisionRules(), Weights())
    assert decision.names == (name,)
    [members] = weigh(decision, Weights()).sets
    assert set(members) >= {"flow_force", "nonlinear_spring"}
