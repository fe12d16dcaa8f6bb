"""What a diagnosis names is in the updated model, and can be read back."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from control.design import DesignModel, load_design, save_design
from tests.twin.judged import a_record
from twin.choose.stages import StageResult
from twin.diagnose import _final_plant, _model
from twin.diagnosis import Cause, Estimate
from twin.fit.case import Case, make_case
from twin.judge.verdict import Judgement
from twin.model.catalog import effects
from twin.model.effect import Effect, Form, Scales
from twin.model.insert import inserted_from
from twin.model.model_units import in_units_of
from twin.model.plant import Inserted, Plant
from twin.record.sensing import Sensing

FORMS = [(one, form) for one in effects().values() for form in one.forms]
NOTHING = Sensing((), {}, 0.0)
#: What `sense` accepts, as it does: estimates that are no parameters besides, and not always all parameters.
EVENTS = {
    "sensor_dropouts": Sensing(
        (), {"sensor_dropouts": {"rate": Estimate(0.01, (0, 1)), "size": Estimate(0.4, (0, 1))}}, 0.0
    ),
    "stale_samples": Sensing((), {"stale_samples": {"period": Estimate(0.7, (0.6, 0.8), "s")}}, 0.0),
    "uniform_steps": Sensing((), {"sensor_quantization": {"step": Estimate(0.01, (0.01, 0.01), "in")}}, 0.01),
    "on_change": Sensing((), {"sensor_quantization": {"step": Estimate(0.01, (0.01, 0.01), "in")}}, 0.0, band=0.01),
}


@pytest.fixture(scope="module")
def case() -> Case:
    return make_case([a_record(Plant(DesignModel()), n=200)], DesignModel())


def written(case: Case, fitted: tuple[Inserted, ...], sensing: Sensing, path: Path) -> DesignModel:
    """The updated model of a diagnosis that named what was `fitted` and what the readings showed, out of its file."""
    names = [one.effect for one in fitted]
    result = SimpleNamespace(causes=tuple(names), plant=lambda: Plant(case.base.design, fitted))
    named = tuple(Cause(name, "sensor", 0.97) for name in dict.fromkeys([*names, *sensing.accepted]))
    judgement = Judgement("effect", named, (), ())
    final = _final_plant(case, cast(StageResult, result), judgement, None, sensing)
    model, units = _model(final, case)
    save_design(model, path, "", units)
    return load_design(path)


def a_case_of(one: Effect, form: Form) -> Inserted:
    """Values that are no round numbers, and differ."""
    return Inserted(one.name, form, tuple(p.starts[0] * 1.0123 + 1e-5 * k for k, p in enumerate(form.parameters)))


@pytest.mark.parametrize(("one", "form"), FORMS, ids=[f"{one.name}-{form.name}" for one, form in FORMS])
def test_a_fitted_cause_is_written_with_its_units_and_read_back(
    one: Effect, form: Form, case: Case, tmp_path: Path
) -> None:
    given = a_case_of(one, form)
    model = written(case, (given,), NOTHING, tmp_path / "model.toml")
    assert inserted_from(model) == (given,)
    lines = (tmp_path / "model.toml").read_text().splitlines()
    for p in form.parameters:
        (line,) = [line for line in lines if line.startswith(f"{p.name} = ")][-1:]
        assert line.endswith(f"# {Scales().unit(p.kind)}")
    there_and_back = in_units_of(in_units_of(model, "kPa", "mm"), "psi", "in")
    assert inserted_from(there_and_back)[0].values == pytest.approx(given.values)


@pytest.mark.parametrize("name", EVENTS)
def test_what_only_the_readings_showed_is_written_and_read_back(name: str, case: Case, tmp_path: Path) -> None:
    sensing = EVENTS[name]
    (accepted,) = sensing.accepted
    (read,) = inserted_from(written(case, (), sensing, tmp_path / "model.toml"))
    assert read.effect == accepted
    for p, value in zip(read.form.parameters, read.values, strict=True):
        assert value == sensing.accepted[accepted][p.name].value
    assert name in (read.effect, read.form.name)


@pytest.mark.parametrize("name", EVENTS)
def test_what_the_readings_showed_stands_beside_what_was_fitted(name: str, case: Case, tmp_path: Path) -> None:
    stiction = a_case_of(effects()["stiction"], effects()["stiction"].forms[0])
    model = written(case, (stiction,), EVENTS[name], tmp_path / "model.toml")
    assert set(model.effects) == {"stiction", *EVENTS[name].accepted}


def test_a_fitted_refresh_is_not_replaced_by_the_seen_one(case: Case, tmp_path: Path) -> None:
    periodic = Inserted("stale_samples", effects()["stale_samples"].form("periodic"), (0.7, 0.25))
    assert inserted_from(written(case, (periodic,), EVENTS["stale_samples"], tmp_path / "model.toml")) == (periodic,)


def test_every_effect_that_is_known_by_events_is_among_them() -> None:
    known = {name for one in EVENTS.values() for name in one.accepted}
    assert {one.name for one in effects().values() if one.evidence == "events"} <= known
