"""Every effect that is found keeps the contract; nothing here knows a particular one, except the vocabulary's names."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.ep_slots import EP_ATMOSPHERE
from twin.model.catalog import effect, effects
from twin.model.effect import Effect, Form, Parameter, Scales
from twin.model.place import Place
from twin.model.plant import Inserted, Plant, pressure_response, reading_response, stem_response
from twin.model.timegrid import make_grid
from twin.replay.chain import takes_air

VOCABULARY = {
    "ep": "dead_time ep_calibration ep_deadband fill_exhaust_asymmetry ep_rate_limit supply_saturation",
    "actuator": "stiction spring_asymmetry nonlinear_spring asymmetric_damping friction_in_motion creep "
    "distributed_hysteresis position_dependent_friction friction_drift reduced_travel additional_lag flow_force",
    "sensor": "lvdt_calibration lvdt_nonlinearity lvdt_drift linkage_lost_motion sensor_lag stale_samples "
    "sensor_quantization sensor_dropouts",
}
FORMS = [(e, f) for e in effects().values() for f in e.forms]
PARAMETERS = [(e, f, p) for e, f in FORMS for p in f.parameters]
#: Effects that change single readings by chance, so that the expected trajectory does not change.
WITHOUT_TRAJECTORY = {"sensor_dropouts"}
REFERENCE = Scales()


def label(value: object) -> str:
    return getattr(value, "name", "")


@cache
def excitation() -> tuple[FloatArray, FloatArray]:
    """Both stops for long, a slow ramp, large and small steps with reversals inside; 240 s at 5 Hz."""
    rng = np.random.default_rng(11)
    time_s = np.arange(1200) * 0.2
    levels = np.repeat(np.concatenate([[5.0, 5.0, 20.0, 20.0, 20.0, 5.0], rng.uniform(5.5, 12.5, 24)]), 30)
    ramp = 9.0 + 3.0 * np.sin(np.arange(300) / 30.0)
    return time_s, np.concatenate([levels, ramp])


@cache
def response(
    effect_name: str,
    form: Form | None,
    values: tuple[float, ...],
    scales: Scales = REFERENCE,
    place: Place | None = None,
) -> FloatArray:
    """Pressure and reading at the rows, shape (2, 1200)."""
    d = DesignModel()
    design = DesignModel(
        d.ep_tau_s * scales.time,
        d.a1 * scales.pressure,
        d.a2 * scales.pressure,
        d.compliance * scales.position / scales.pressure,
        d.tau_s * scales.time,
        d.rate_limit * scales.position / scales.time,
        d.travel * scales.position,
        pressure_unit=scales.pressure_unit,
        position_unit=scales.position_unit,
    )
    plant = Plant(design, () if form is None else (Inserted(effect_name, form, values),))
    time_s, command = excitation()
    time_s, command = time_s * scales.time, command * scales.pressure
    grid = make_grid(time_s, 0.05 * scales.time)
    c = plant.coefficients(float(time_s[-1]), place)
    stem = None
    for _ in range(1 + takes_air(c.ep)):  # one round is enough to see that a stem acts back
        pressure = pressure_response(c, grid, command, float(command[0]), stem)
        stem = stem_response(c, grid, pressure, 0.0, 0.0)
    return np.array([pressure[grid.offsets], reading_response(c, grid, stem, pressure)])


def typical(form: Form) -> list[float]:
    return [p.starts[-1] for p in form.parameters]


def test_the_vocabulary_is_complete() -> None:
    for stage, names in VOCABULARY.items():
        assert {n for n in names.split() if effect(n).stage == stage} == set(names.split())


def test_every_file_is_an_effect_of_its_name() -> None:
    files = {path.stem for path in (Path(__file__).parents[3] / "twin" / "effects").glob("[a-z]*.py")}
    assert files == set(effects())


@pytest.mark.parametrize("one", effects().values(), ids=label)
def test_words(one: Effect) -> None:
    assert one.claim.endswith(".")
    assert one.equations
    assert any(c.isdigit() for c in one.source) or "McGraw-Hill" in one.source
    assert set(one.twins) <= set(effects()) - {one.name}
    assert len({f.name for f in one.forms}) == len(one.forms) > 0


@pytest.mark.parametrize(("one", "form", "p"), PARAMETERS, ids=label)
def test_numbers_of_a_parameter(one: Effect, form: Form, p: Parameter) -> None:
    assert p.doc
    assert p.scale > 0.0
    assert p.lower < p.upper
    assert p.lower <= p.neutral <= p.upper
    assert p.starts
    assert all(p.lower <= start <= p.upper for start in p.starts)
    assert not p.size or p.neutral not in p.starts
    free_sign = p.size and p.lower < p.neutral < p.upper
    several = (
        sum(other.size for other in form.parameters) > 4
    )  # one start of many sizes together, or there are too many
    assert not free_sign or several or min(p.starts) < p.neutral < max(p.starts)  # tried on both sides
    assert Scales().unit(p.kind)
    assert Scales().factor(p.kind) == 1.0


@pytest.mark.parametrize(("one", "form"), FORMS, ids=label)
def test_neutral_changes_nothing(one: Effect, form: Form) -> None:
    if not any(p.size for p in form.parameters):
        # only an effect that is there or not has no size
        assert form.seen or any(not other.parameters for other in one.forms)
        return
    values = tuple(p.neutral if p.size else p.starts[0] for p in form.parameters)
    np.testing.assert_allclose(response(one.name, form, values), response("", None, ()), atol=1e-9)


@pytest.mark.parametrize(("one", "form"), FORMS, ids=label)
def test_every_start_changes_the_response(one: Effect, form: Form) -> None:
    stage_row = 0 if one.stage == "ep" else 1
    for k, p in enumerate(form.parameters):
        for start in p.starts:
            values = typical(form)
            values[k] = start
            place = Place(k // 2, form.apart // 2) if form.apart else None
            change = response(one.name, form, tuple(values), place=place) - response("", None, ())
            assert np.isfinite(change).all()
            changed = one.name not in WITHOUT_TRAJECTORY and not form.seen  # in readings, of which there are none here
            assert (np.abs(change[stage_row]).max() > 1e-6) == changed, (p.name, start)
    if not form.parameters and not form.seen:
        assert np.abs(response(one.name, form, ()) - response("", None, ()))[stage_row].max() > 1e-3


@pytest.mark.parametrize(("one", "form"), FORMS, ids=label)
def test_a_stage_leaves_the_signals_before_it_alone(one: Effect, form: Form) -> None:
    with_it = response(one.name, form, tuple(typical(form)))
    assert one.stage == "ep" or np.array_equal(with_it[0], response("", None, ())[0])


@pytest.mark.parametrize(("one", "form"), FORMS, ids=label)
def test_pure_and_repeatable(one: Effect, form: Form) -> None:
    values = typical(form)
    before = list(values)
    first = response.__wrapped__(one.name, form, tuple(values))
    Plant(DesignModel(), (Inserted(one.name, form, tuple(values)),)).coefficients(10.0)
    again = response.__wrapped__(one.name, form, tuple(values))
    assert values == before
    assert np.array_equal(first, again)
    assert np.array_equal(response.__wrapped__("", None, ()), response("", None, ()))


@pytest.mark.parametrize(("one", "form"), FORMS, ids=label)
def test_other_units_are_the_same_physics(one: Effect, form: Form) -> None:
    """A valve in kPa, mm and minutes with values scaled by their kinds reads the same, in kPa and mm."""
    scales = Scales(pressure=6.894757, position=25.4, time=1.0 / 64.0, pressure_unit="kPa", position_unit="mm")
    values = tuple(v * scales.factor(p.kind) for v, p in zip(typical(form), form.parameters, strict=True))
    other = response(one.name, form, values, scales) / np.array([[scales.pressure], [scales.position]])
    off = np.abs(other - response(one.name, form, tuple(typical(form))))
    # Where the response jumps, rounding may move a jump by one fine step; an atmosphere is rounded in either unit.
    rounded = (
        Plant(DesignModel(), (Inserted(one.name, form, tuple(typical(form))),)).coefficients(10.0).ep[EP_ATMOSPHERE]
    )
    assert np.quantile(off, 0.9) < (1e-6 if rounded else 1e-9)
    assert all(p.smooth for p in form.parameters) <= (off.max() < 1e-6)


@pytest.mark.parametrize(("one", "form"), FORMS, ids=label)
def test_bounds_are_safe(one: Effect, form: Form) -> None:
    for k, p in enumerate(form.parameters):
        for bound in (p.lower, p.upper):
            values = typical(form)
            values[k] = bound
            assert np.isfinite(response(one.name, form, tuple(values))).all(), (p.name, bound)
