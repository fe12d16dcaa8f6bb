"""Forms whose equations are said in other terms than their coefficients."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.judged import a_record, judged
from tests.twin.kernels.test_kernels import excitation, run
from tests.twin.trials import trial_of
from twin.fit.channel import pressure_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.kernels.sensor import static_reading
from twin.kernels.sensor_slots import S_BOW, S_GAIN
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant, curve_tables

DESIGN = DesignModel()


def plant_with(*effects: tuple[str, str, tuple[float, ...]]) -> Plant:
    return Plant(DESIGN, tuple(Inserted(name, effect(name).form(form), values) for name, form, values in effects))


SHAPES = {
    "about_open": lambda xi: xi**2,
    "about_closed": lambda xi: (1.0 - xi) ** 2,
    "about_mid": lambda xi: (2.0 * xi - 1.0) ** 3,
    "cubed_about_open": lambda xi: xi**3,
    "cubed_about_closed": lambda xi: (1.0 - xi) ** 3,
}


@given(st.sampled_from(sorted(SHAPES)), st.floats(-0.2, 0.2), st.floats(0.0, 1.0))
def test_a_reading_bent_about_a_place_is_right_there(form: str, bend: float, xi: float) -> None:
    c = plant_with(("lvdt_nonlinearity", form, (bend,))).coefficients(1.0).sensor
    read = static_reading(np.array([xi * DESIGN.travel]), np.zeros(1), c)[0]
    assert read == pytest.approx(DESIGN.travel * (xi + bend * SHAPES[form](xi)), abs=1e-12)


@pytest.mark.parametrize("form", ["about_open", "about_closed"])
def test_the_same_curve_is_as_likely_in_whatever_number(form: str) -> None:
    """All that is curved in a reading bent about one end is a bow, of the same size at a standard deviation of each."""
    xi = np.linspace(0.0, 1.0, 21)

    def curved(name: str) -> FloatArray:
        values = tuple(p.scale for p in effect("lvdt_nonlinearity").form(name).parameters)
        c = plant_with(("lvdt_nonlinearity", name, values)).coefficients(1.0).sensor
        read = static_reading(xi * DESIGN.travel, np.zeros(xi.size), c)
        return np.asarray(np.diff(read, 2))

    np.testing.assert_allclose(np.abs(curved(form)), np.abs(curved("bow")), atol=1e-12)


@pytest.mark.parametrize("form", ["cubed_about_open", "cubed_about_closed"])
def test_a_cube_bows_at_a_standard_deviation_as_much_as_a_bow(form: str) -> None:
    (cube,), (bow,) = (effect("lvdt_nonlinearity").form(name).parameters for name in (form, "bow"))
    c = plant_with(("lvdt_nonlinearity", form, (cube.scale,))).coefficients(1.0).sensor
    assert abs(c[S_GAIN] * c[S_BOW]) == pytest.approx(bow.scale)


@pytest.mark.parametrize(
    ("form", "way"), [("leaves_range_closed", lambda xi: xi), ("leaves_range_open", lambda xi: 1 - xi)]
)
def test_a_reading_is_straight_within_its_range_and_off_by_the_bend_at_the_end(form: str, way: object) -> None:
    assert callable(way)
    c = plant_with(("lvdt_nonlinearity", form, (-0.02, 0.6))).coefficients(1.0).sensor
    for xi in (0.0, 0.2, 0.5, 0.8, 1.0):
        beyond = max(way(xi) - 0.6, 0.0) / 0.4
        read = static_reading(np.array([xi * DESIGN.travel]), np.zeros(1), c)[0]
        assert read == pytest.approx(DESIGN.travel * (xi - 0.02 * beyond**2), abs=1e-12)


@given(st.floats(-0.1, 0.1), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_cubic_reading_with_part_of_its_line(bend: float, line: float, xi: float) -> None:
    c = plant_with(("lvdt_nonlinearity", "cubic", (bend, line))).coefficients(1.0).sensor
    u = 2.0 * xi - 1.0
    read = static_reading(np.array([xi * DESIGN.travel]), np.zeros(1), c)[0]
    assert read == pytest.approx(DESIGN.travel * (xi + bend * (u**3 - line * u)), abs=1e-12)


def test_a_bent_reading_and_one_off_in_its_gain_add_up_in_any_order() -> None:
    bent, gain = ("lvdt_nonlinearity", "about_open", (0.05,)), ("lvdt_calibration", "gain", (0.03,))
    one, other = (plant_with(*order).coefficients(1.0).sensor for order in ((bent, gain), (gain, bent)))
    np.testing.assert_allclose(one, other)


@pytest.mark.parametrize(
    ("form", "share"), [("area_slope", lambda xi: xi - 0.5), ("area_bow", lambda xi: 4 * xi * (1 - xi))]
)
def test_a_larger_area_needs_less_pressure_for_spring_and_friction_alike(form: str, share: object) -> None:
    assert callable(share)
    first, step, closing, opening = curve_tables(plant_with(("nonlinear_spring", form, (0.05,))).coefficients(1.0))
    grid = first + step * np.arange(closing.size)
    for start_psi, table in ((DESIGN.a1, closing), (DESIGN.a2, opening)):
        for xi in (0.1, 0.5, 0.9):
            needed = (start_psi + xi * DESIGN.travel / DESIGN.compliance) / (1.0 + 0.05 * share(xi))
            assert np.interp(needed, grid, table) == pytest.approx(xi * DESIGN.travel, abs=2e-4)


def stem_to_closed(form: str) -> FloatArray:
    time_s = np.arange(600) * 0.05
    command = np.where(time_s < 1.0, 4.0, 13.5)
    return run(plant_with(("friction_in_motion", form, ())), time_s, command, 0.01, 0.0)[1]


def test_a_balance_beyond_the_stop_brings_the_stem_there_at_speed() -> None:
    soft = stem_to_closed("full")
    hit = stem_to_closed("full_hit")
    assert hit.max() == DESIGN.travel > soft.max()
    arrival = int(np.argmax(hit == DESIGN.travel))
    assert (hit[arrival] - hit[arrival - 1]) / 0.05 > 0.02  # in/s: no creeping up to the stop
    assert soft[arrival] < 0.97 * DESIGN.travel


@pytest.mark.parametrize("stop", ["upper_stop", "lower_stop", "upper_stop_hit", "lower_stop_hit"])
@pytest.mark.parametrize("friction", ["full_hit", "partial_hit"])
def test_a_stop_that_moved_moves_for_a_stem_that_meets_it_at_speed(stop: str, friction: str) -> None:
    moved = ("reduced_travel", stop, (0.1,))
    met = ("friction_in_motion", friction, (0.7,) if "partial" in friction else ())
    time_s, command = excitation(0.1)
    one, other = (run(plant_with(*order), time_s, command, 0.02)[1] for order in ((moved, met), (met, moved)))
    if not stop.endswith("_hit"):
        np.testing.assert_array_equal(one, other)
    low, high = (0.1, 1.0) if stop.startswith("lower") else (0.0, 0.9)
    for reading in (one, other):
        assert reading[50:].min() >= low * DESIGN.travel - 1e-12
        assert reading.max() <= high * DESIGN.travel + 1e-12
        assert min(abs(reading[50:].min() / DESIGN.travel - low), abs(reading.max() / DESIGN.travel - high)) < 1e-9


@pytest.mark.parametrize(("form", "beyond"), [("upper_seat", lambda xi: xi - 0.8), ("lower_seat", lambda xi: xi - 0.2)])
def test_against_a_seat_only_a_share_of_the_compliance_is_left(form: str, beyond: object) -> None:
    assert callable(beyond)
    seated = plant_with(("reduced_travel", form, (0.2, 0.25))).coefficients(1.0)
    first, step, closing, opening = curve_tables(seated)
    grid = first + step * np.arange(closing.size)
    within = (lambda xi: max(beyond(xi), 0.0)) if form == "upper_seat" else (lambda xi: min(beyond(xi), 0.0))
    for start_psi, table in ((DESIGN.a1, closing), (DESIGN.a2, opening)):
        for xi in (0.02, 0.1, 0.5, 0.9, 0.98):
            needed = start_psi + DESIGN.travel / DESIGN.compliance * (xi + within(xi) * (1.0 / 0.25 - 1.0))
            assert np.interp(needed, grid, table) == pytest.approx(xi * DESIGN.travel, abs=3e-3)


def test_a_band_of_friction_is_as_high_all_over_and_nothing_elsewhere() -> None:
    """A ring of scale, or a scored stretch: a bell through it misses the middle or the edges."""
    banded = plant_with(("position_dependent_friction", "band", (0.2, 0.6, 0.25))).coefficients(1.0)
    inside, outside = np.abs(banded.xi - 0.6) < 0.09, np.abs(banded.xi - 0.6) > 0.16
    np.testing.assert_allclose(banded.close_shift[inside], 0.2, atol=0.003)
    np.testing.assert_allclose(banded.open_shift[inside], -0.2, atol=0.003)
    np.testing.assert_allclose(banded.close_shift[outside], 0.0, atol=0.003)


def test_a_limit_of_the_converter_that_is_just_reached_is_found() -> None:
    """Ramps of 0.4 psi/s against limits of 0.35 and 0.3 psi/s, with starts at which none is met."""
    true = (1.0 / 0.35, 1.0 / 0.30)
    ramps = 8.0 + 2.0 * np.abs((np.arange(3000) * 0.02) % 2.0 - 1.0)  # 0.1 s rows: 0.4 psi/s
    form = effect("ep_rate_limit").form("up_and_down")
    trial, _ = trial_of(Plant(DESIGN, (Inserted("ep_rate_limit", form, true),)), ramps)
    channel = pressure_channel([trial], 0.02)
    space = make_space(Plant(DESIGN), (Cause("ep_rate_limit", effect("ep_rate_limit"), form),), ("ep_tau",), Scales())
    assert fit(channel, space, starts_of(space)).values()[-2:] == pytest.approx(true, rel=0.02)


@pytest.mark.parametrize("stiffer", [0.5, -0.3])
def test_from_where_a_second_spring_helps_each_psi_moves_less(stiffer: float) -> None:
    """On both curves, as far as the spring's rate is larger there, and no less before."""
    first, step, closing, opening = curve_tables(
        plant_with(("nonlinear_spring", "helper", (stiffer, 0.6))).coefficients(1.0)
    )
    psi = first + step * np.arange(closing.size)
    travel, rate = DESIGN.travel, 1.0 / DESIGN.compliance
    for curve, start_psi in ((closing, DESIGN.a1), (opening, DESIGN.a2)):
        x = travel * np.array([0.2, 0.5, 0.7, 0.9])
        needed_psi = start_psi + rate * (x + stiffer * np.maximum(x - 0.6 * travel, 0.0))
        assert np.interp(needed_psi, psi, curve) == pytest.approx(x, abs=2e-3 * travel)


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["cubed_about_open", "cubed_about_closed"])
def test_a_reading_that_falls_short_with_the_cube_is_one_cause(form: str) -> None:
    result, judgement = judged(a_record(plant_with(("lvdt_nonlinearity", form, (-0.1,)))))
    assert [cause.name for cause in judgement.causes] == ["lvdt_nonlinearity"]
    assert [each.form.name for each in result.plant().inserted] == [form]
