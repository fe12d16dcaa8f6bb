"""What is none of the known effects is told from those that it resembles, and named in words only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lti, step

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO, a_record
from twin.choose.stages import driven_about
from twin.diagnose import Outcome, Settings, diagnose
from twin.fit.case import make_case
from twin.fit.channel import position_channel, predict_reading
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space
from twin.kernels.ep_slots import EP_DRIFTS, EP_DRIFTS_S, EP_ZERO
from twin.kernels.sensor_slots import S_JUMP, S_JUMP_S, S_ZERO
from twin.model.catalog import effect, effects
from twin.model.effect import Scales
from twin.model.place import Place
from twin.model.plant import Inserted, Plant, pressure_response, reading_response
from twin.model.timegrid import make_grid
from twin.search.search_rules import SearchRules

DESIGN = DesignModel()
ALIKE = "a damping that grows with the speed, the same both ways"
SNAPS = "the spring gives way at a place, and the stem snaps through"
ORIFICE = ("asymmetric_damping", "orifice_each_way", (1.5, 0.5))


def with_form(name: str, form: str, *values: float) -> Plant:
    return Plant(DESIGN, (Inserted(name, effect(name).form(form), values),))


def answered(*records: Recording) -> Outcome:
    return diagnose(list(records), DESIGN, settings=Settings(search=SearchRules(most=1)))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("plant", "words"),
    [
        (with_form("lvdt_drift", "jump", 0.02, 0.43), "the zero of the reading jumps"),
        (with_form("dead_time", "rings", 0.35, 0.25), "the converter swings to its goal"),
        (
            with_form("ep_calibration", "zero_drifts", 0.01, 0.06, 120.0),
            "the zero of the converter or of its gauge drifts",
        ),
        (with_form("nonlinear_spring", "breaks", -0.2, 0.05, 0.6), "the spring changes all at once"),
        (with_form("nonlinear_spring", "snaps", 0.5, 0.45, 0.5), SNAPS),
        (with_form("nonlinear_spring", "stem_snaps", 0.7, 0.55, 0.5), SNAPS),
        (with_form("asymmetric_damping", "orifice_each_way", 1.5, 1.5), ALIKE),
        (with_form("asymmetric_damping", "orifice_within_stops", 1.5, 1.5), ALIKE),
        (with_form("lvdt_calibration", "picks_up", 0.02, 0.0), "the reading picks up the pressure or the command"),
        (with_form("sensor_lag", "leads", 0.5), "the reading picks up the speed of the stem"),
        (with_form("ep_rate_limit", "stroke", 0.2), "the stroke of the stem moves the pressure"),
        (
            with_form("linkage_lost_motion", "slips", 0.03, 0.015, 0.4),
            "a coupling between stem and gauge slips in quick moves",
        ),
    ],
)
def test_a_rival_that_explains_best_leaves_it_unexplained(plant: Plant, words: str) -> None:
    found = answered(a_record(plant)).diagnosis
    assert found.verdict == "unexplained" and not found.causes
    assert found.residual_signature["looks_like"]["what"] == words  # type: ignore[index]
    assert words in found.statement


def test_the_converters_zero_goes_where_it_settles() -> None:
    """Under a constant command, against the lag of an exponential in closed form, on rows and on fine steps."""
    time_s = 0.1 * np.arange(1500)
    grid, settling_s, tau_s = make_grid(time_s, 0.02), 25.0, DESIGN.ep_tau_s
    c = with_form("ep_calibration", "zero_drifts", 0.02, 0.3, settling_s).coefficients(150.0)
    delayed = with_form("dead_time", "pure_delay", 1e-6).coefficients(150.0)
    delayed.ep[[EP_ZERO, EP_DRIFTS, EP_DRIFTS_S]] = c.ep[[EP_ZERO, EP_DRIFTS, EP_DRIFTS_S]]
    slow, fast = np.exp(-time_s / settling_s), np.exp(-time_s / tau_s)
    expected = 0.32 - 0.3 * (settling_s * slow - tau_s * fast) / (settling_s - tau_s) - 0.02 * fast
    for one in (c, delayed):
        pressure = pressure_response(one, grid, np.full(1500, 8.0), 8.0)[grid.offsets]
        np.testing.assert_allclose(pressure - 8.0, expected, atol=1.2e-3)


def test_a_reading_picks_up_what_the_pressure_is_above_that_of_a_closing_stem() -> None:
    """A stem that friction holds stands still, and its reading does not."""
    time_s = 0.1 * np.arange(400)
    grid = make_grid(time_s, 0.05)
    pressure = np.interp(grid.offsets[-1] * np.linspace(0.0, 1.0, grid.n_fine), [0, grid.offsets[-1]], [8.0, 10.5])
    c = with_form("lvdt_calibration", "picks_up", 0.05, 0.002).coefficients(40.0)
    reading = reading_response(c, grid, np.full(grid.n_fine, 0.3), pressure)
    expected = 0.302 + 0.05 * DESIGN.compliance * (pressure[grid.offsets] - DESIGN.a1)
    np.testing.assert_allclose(reading, expected, atol=1e-12)


def test_a_reading_picks_up_the_speed_of_the_stem() -> None:
    """On fine steps of two sizes: it is on the reading as long as the stem moves, and gone when it stands."""
    time_s = np.append(0.1 * np.arange(200), 19.9 + 0.5 * np.arange(1, 100))
    grid = make_grid(time_s, 0.03)
    t = grid.fine_time_s
    stem = 0.02 * np.clip(t - 5.0, 0.0, 20.0)
    reading = reading_response(with_form("sensor_lag", "leads", 0.4).coefficients(70.0), grid, stem, np.zeros(t.size))
    moves = (time_s > 5.2) & (time_s < 24.8)
    stands = (time_s < 4.9) | (time_s > 25.2)
    np.testing.assert_allclose(reading[moves], stem[grid.offsets][moves] + 0.4 * 0.02, atol=1e-12)
    np.testing.assert_allclose(reading[stands], stem[grid.offsets][stands], atol=1e-12)


def test_a_coupling_slips_where_the_stem_is_quick() -> None:
    """A quick stroke up loses a tenth, a slow one down nothing, a quick one down a twentieth of its way."""
    time_s = np.append(0.1 * np.arange(400), 39.9 + 0.5 * np.arange(1, 100))
    grid = make_grid(time_s, 0.03)
    stem = np.interp(grid.fine_time_s, [0.0, 5.0, 8.0, 10.0, 30.0, 39.9, 41.9], [0.1, 0.1, 0.4, 0.4, 0.2, 0.2, 0.0])
    c = with_form("linkage_lost_motion", "slips", 0.1, 0.05, 0.5).coefficients(90.0)
    reading = reading_response(c, grid, stem, np.zeros(stem.size))
    gone = np.interp(time_s, [5.0, 8.0, 39.9, 41.9], [0.0, 0.03, 0.03, 0.02])
    np.testing.assert_allclose(reading, stem[grid.offsets] - gone, atol=1e-12)


def test_a_stroke_takes_pressure_that_the_converter_gives_back() -> None:
    """Of a stem that runs evenly, against the lag of a ramp in closed form; the converter goes on where it stands."""
    time_s = 0.1 * np.arange(200)
    grid = make_grid(time_s, 0.01)
    stem = 0.02 * np.clip(grid.fine_time_s - 5.0, 0.0, 10.0)
    c = with_form("ep_rate_limit", "stroke", 0.2).coefficients(20.0)
    pressure = pressure_response(c, grid, np.full(200, 8.0), 8.0, stem)[grid.offsets]
    per_in, tau_s = 0.2 / DESIGN.compliance, DESIGN.ep_tau_s
    runs, stands = np.clip(time_s - 5.0, 0.0, 10.0), np.clip(time_s - 15.0, 0.0, None)
    taken = per_in * 0.02 * tau_s * -np.expm1(-runs / tau_s) * np.exp(-stands / tau_s)
    np.testing.assert_allclose(pressure, 8.0 - taken, atol=2e-4)


def test_where_the_stem_begins_goes_by_what_its_reading_picks_up() -> None:
    """A record that begins in the middle of the band: the stem is where the reading is, less what it picks up."""
    record = a_record(Plant(DESIGN))
    middle = replace(record, command=np.full(record.n, 9.0), pressure=np.full(record.n, 9.0))
    plant = with_form("lvdt_calibration", "picks_up", 0.05, 0.0)
    picked_in = 0.05 * DESIGN.compliance * (9.0 - DESIGN.a1)
    case = make_case([replace(middle, position=np.full(record.n, 0.15 + picked_in))], DESIGN)
    np.testing.assert_allclose(predict_reading(plant, case.trials[0]), 0.15 + picked_in, atol=1e-9)


@pytest.mark.thorough
def test_what_it_resembles_is_named_as_before() -> None:
    steady = ("ep_calibration", "gain_and_zero", (0.006, -0.06))
    spread = ("distributed_hysteresis", "uniform", (0.4,))
    slow = ("creep", "one_tail", (0.15, 8.0))
    alike = (
        slow,
        ("lvdt_drift", "warm_up", (0.02, 150.0)),
        ("dead_time", "pure_delay", (0.5,)),
        ORIFICE,
        steady,
        spread,
        ("ep_rate_limit", "orifices", (0.5, 0.5, 0.8)),
    )
    for name, form, values in alike:
        found = answered(a_record(with_form(name, form, *values))).diagnosis
        assert [c.name for c in found.causes] == [name]


@pytest.mark.thorough
def test_beside_a_cause_that_explains_without_it_a_rival_is_not_heard() -> None:
    """A small jump beside a large lag: the lag is named."""
    large = Inserted("additional_lag", effect("additional_lag").form("behind_stem"), (0.9,))
    plant = with_form("lvdt_drift", "jump", 0.001, 0.5)
    found = diagnose([a_record(Plant(DESIGN, (large, *plant.inserted)))], DESIGN, (), UP_TO_TWO).diagnosis
    assert {c.name for c in found.causes} & {"additional_lag", "sensor_lag"}


def test_what_is_a_rival() -> None:
    rivals = {(e.name, f.name) for e in effects().values() for f in e.forms if f.outside}
    snaps = {("nonlinear_spring", "snaps"), ("nonlinear_spring", "stem_snaps")}
    alike, drifts = ("asymmetric_damping", "orifice_alike"), ("ep_calibration", "zero_drifts")
    picks_up = ("lvdt_calibration", "picks_up")
    assert rivals == {
        ("lvdt_drift", "jump"),
        ("lvdt_drift", "jump_each"),
        ("dead_time", "rings"),
        alike,
        ("asymmetric_damping", "alike_within_stops"),
        drifts,
        picks_up,
        ("sensor_lag", "leads"),
        ("ep_rate_limit", "stroke"),
        ("linkage_lost_motion", "slips"),
        *snaps,
        ("nonlinear_spring", "breaks"),
    }


@pytest.mark.thorough
def test_no_rival_is_in_an_updated_model() -> None:
    record = a_record(with_form("lvdt_drift", "jump", 0.02, 0.43))
    assert not answered(record).model.effects


def test_the_swing_is_of_second_order_before_the_lag() -> None:
    time_s = np.arange(0.0, 8.01, 0.05)
    grid = make_grid(time_s, 0.02)
    command = np.where(time_s > 0.0, 9.0, 6.0)
    got = pressure_response(with_form("dead_time", "rings", 0.4, 0.3).coefficients(8.0), grid, command, 6.0)
    _, want = step(lti([1.0], np.polymul([0.16, 0.24, 1.0], [DESIGN.ep_tau_s, 1.0])), T=time_s)
    assert np.max(np.abs(got[grid.offsets] - 6.0 - 3.0 * want)) < 1e-3


def test_a_jump_happens_once_in_all_recordings() -> None:
    plant = with_form("lvdt_drift", "jump", 0.02, 0.5)
    at = [Place(k, 3, before_s=100.0 * k, all_s=300.0) for k in range(3)]
    first, second, third = (plant.coefficients(100.0, p).sensor for p in at)
    assert second[S_JUMP_S] == pytest.approx(50.0) and first[S_JUMP_S] == pytest.approx(150.0)
    assert third[S_ZERO] == 0.02 and third[S_JUMP] == 0.0
    shared = replace(at[2], since_s=400.0, span_s=500.0)
    assert plant.coefficients(100.0, shared).course_s == (400.0, 500.0)


@pytest.mark.thorough
def test_a_zero_that_jumps_in_each_recording_is_no_drift() -> None:
    """After 30 s in one and in the other; in a part of a recording that began before, sooner."""
    plant = with_form("lvdt_drift", "jump_each", 0.02, 30.0)
    whole, part = (plant.coefficients(100.0, p).sensor for p in (Place(1, 3), Place(1, 3, within_s=20.0)))
    assert (whole[S_JUMP], whole[S_JUMP_S], part[S_JUMP_S]) == (0.02, 30.0, 10.0)
    past = plant.coefficients(100.0, Place(1, 3, within_s=40.0)).sensor
    assert (past[S_JUMP], past[S_ZERO]) == (0.0, 0.02)
    records = [replace(a_record(plant), name=name) for name in ("first", "second")]
    found = answered(records[0], replace(records[1], position=records[1].position + 2e-4)).diagnosis
    assert found.verdict == "unexplained" and not found.causes
    assert "the zero of the reading jumps each time" in found.statement


@pytest.mark.parametrize("at_s", [40.0, 95.0, 207.0, 410.0])
def test_a_jump_in_each_recording_is_found_wherever_it_is(at_s: float) -> None:
    """Too far from every start it would leave so much that a drift explained it better."""
    drift = effect("lvdt_drift")
    plant = with_form("lvdt_drift", "jump_each", 0.015, at_s)
    case = make_case([a_record(plant, seed=seed, n=2400) for seed in (1, 2)], DESIGN, ())
    channel = position_channel(driven_about(case.base, case), case.sigma_y)
    cause = Cause(drift.name, drift, drift.form("jump_each"))
    space = make_space(case.base, (cause,), channel.numbers, case.scales)
    found = fit(channel, space, starts_of(space, [], case.recordings), rounds=6)
    assert found.values()[-1] == pytest.approx(at_s, abs=1.0)
    assert found.mse < 5.0


def a_fit(causes: tuple[Cause, ...], mse: float) -> Fit:
    space = make_space(Plant(DESIGN), causes, (), Scales())
    return Fit(space, np.zeros(len(space.unknowns)), mse, 0.0, np.zeros(1), np.zeros((1, 1)), 1)
