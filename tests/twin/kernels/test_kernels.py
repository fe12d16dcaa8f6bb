"""The compiled passes against a plain Python valve, effect by effect, and against themselves on a very fine grid."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.plain_valve import PlainValve
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, pressure_response, reading_response, stem_response
from twin.model.timegrid import make_grid

TRAVEL = 0.5625
DESIGN = DesignModel()


@cache
def excitation(period_s: float) -> tuple[FloatArray, FloatArray]:
    """Steps of all sizes, then a slow swing with inner reversals; 60 s."""
    rng = np.random.default_rng(7)
    time_s = np.arange(round(60.0 / period_s)) * period_s
    steps = rng.uniform(5.0, 13.0, 12)[np.minimum((time_s / 3.0).astype(int), 11)]
    swing = 9.0 + 3.5 * np.sin(time_s / 4.0) + 0.8 * np.sin(time_s / 1.1)
    return time_s, np.where(time_s < 30.0, steps, swing)


def run(plant: Plant, time_s: FloatArray, command: FloatArray, step_s: float, x0: float = 0.1) -> FloatArray:
    """Pressure and reading at the rows, shape (2, n)."""
    grid = make_grid(time_s, step_s)
    c = plant.coefficients(float(time_s[-1] - time_s[0]))
    pressure = pressure_response(c, grid, command, float(command[0]))
    return np.array(
        [pressure[grid.offsets], reading_response(c, grid, stem_response(c, grid, pressure, x0, x0), pressure)]
    )


def plant_with(name: str, form: str, *values: float) -> Plant:
    return Plant(DESIGN, (Inserted(name, effect(name).form(form), values),))


def bow(w: float) -> float:
    return 0.4 * 4.0 * (w / TRAVEL) * (1.0 - w / TRAVEL)


def peak(w: float) -> float:
    opening = 1.0 - w / TRAVEL
    return 0.4 * 8.0 * opening * (1.0 - opening) ** 2


def spot(w: float) -> float:
    return 0.3 * float(np.exp(-0.5 * ((w / TRAVEL - 0.5) / 0.15) ** 2))


def softer(x: float) -> float:
    return 0.3 * (x / TRAVEL - 0.5)


TABLE = (0.01, -0.02, 0.0, 0.015, 0.03, 0.0, -0.03, 0.01, 0.0, 0.02, -0.01)


def tabled(x: float, _t: float) -> float:
    where = 12.0 * x / DESIGN.travel
    k = min(max(int(where), 0), 11)
    entries = (0.0, *TABLE, 0.0)
    return x + DESIGN.travel * (entries[k] + (where - k) * (entries[k + 1] - entries[k]))


def curved(x: float, _t: float) -> float:
    return x + TRAVEL * 0.02 * 4.0 * (x / TRAVEL) * (1.0 - x / TRAVEL)


def kinked(x: float, _t: float) -> float:
    return x + TRAVEL * 0.02 * min(x / TRAVEL / 0.7, (1.0 - x / TRAVEL) / 0.3)


def smaller(w: float) -> float:
    spring, all_of_it, share = w / 0.19, TRAVEL / 0.19, -0.15 * w / TRAVEL
    return (7.3 + spring + share * (7.3 + all_of_it)) / (1.0 + share) - 7.3 - spring


def tighter(w: float) -> float:
    return 1.48 / (1.0 - 0.15 * w / TRAVEL) - 1.48


WAVE = tuple(0.01 * np.sin(0.2 * np.pi * np.arange(1, 11)))  # one period over the 59.9 s


def waving(x: float, t: float) -> float:
    return x + 0.01 * float(np.sin(2.0 * np.pi * t / 59.9))


def steeper(x: float, _t: float) -> float:
    return 1.03 * x + 0.01


SAME = {
    "design": (Plant(DESIGN), PlainValve()),
    "dead_time": (plant_with("dead_time", "pure_delay", 0.4), PlainValve(delay=0.4)),
    "ep_calibration": (plant_with("ep_calibration", "gain_and_zero", 0.05, -0.2), PlainValve(gain=1.05, zero=-0.2)),
    "ep_deadband": (plant_with("ep_deadband", "hold", 0.5), PlainValve(hold_band=0.5)),
    "fill_exhaust": (plant_with("fill_exhaust_asymmetry", "two_lags", 0.4), PlainValve(rise=1.4, fall=0.6)),
    "ep_rate_limit": (plant_with("ep_rate_limit", "symmetric", 0.5), PlainValve(pressure_rate=2.0)),
    "supply": (plant_with("supply_saturation", "ceiling", 10.5), PlainValve(supply=10.5)),
    "sinking": (plant_with("supply_saturation", "sinking", 12.5, 0.4, 20.0), PlainValve(tank=12.5)),
    "sinking_cut_off": (
        plant_with("supply_saturation", "sinking_cut_off", 12.5, 0.4, 20.0),
        PlainValve(tank=12.5, tank_cuts=True),
    ),
    "soft": (plant_with("supply_saturation", "soft", 11.5, 0.6), PlainValve(supply=11.5, knee=0.6)),
    "overlap": (plant_with("ep_deadband", "overlap", 0.3), PlainValve(overlap=0.3)),
    "dispersed": (plant_with("dead_time", "dispersed", 0.4, 0.5), PlainValve(delay=0.4, mixed=0.2)),
    "quick": (plant_with("fill_exhaust_asymmetry", "quick_exhaust", 1.5, 0.3), PlainValve(quick=1.5, crack=0.3)),
    "clogged": (plant_with("fill_exhaust_asymmetry", "clogged", 0.3), PlainValve(clog_fall=0.3)),
    "clogged_supply": (plant_with("fill_exhaust_asymmetry", "clogged", -0.3), PlainValve(clog_rise=0.3)),
    "leaking": (plant_with("ep_deadband", "overlap_leaking", 0.3, 0.1), PlainValve(overlap=0.3, leak=0.1)),
    "cut_off": (plant_with("supply_saturation", "cut_off", 10.5), PlainValve(cut_off=10.5)),
    "held_stem": (plant_with("stiction", "held_stem", 0.4, 4e-3), PlainValve(held=0.076, stick_speed=4e-3)),
    "pressed": (
        plant_with("stiction", "held_stem_pressed", 0.4, 4e-3),
        PlainValve(held=0.076, stick_speed=4e-3, pressed=0.076),
    ),
    "spring": (plant_with("spring_asymmetry", "hinged_open", 0.1), PlainValve(k1=0.19 / 0.9, k2=0.19 / 1.1)),
    "nonlinear_spring": (plant_with("nonlinear_spring", "bow", 0.4), PlainValve(bend=bow)),
    "area_kept": (plant_with("nonlinear_spring", "area_kept", -0.15), PlainValve(bend=smaller, widen=tighter)),
    "friction_spot": (plant_with("position_dependent_friction", "spot", 0.3, 0.5, 0.15), PlainValve(widen=spot)),
    "spring_breaks": (
        plant_with("nonlinear_spring", "breaks", -0.6, 0.2, 0.5),
        PlainValve(breaks_s=29.95, takes=-0.6, stiffens=0.2),
    ),
    "flow_at_stem": (plant_with("flow_force", "stem_square", 0.4), PlainValve(push=lambda x: 0.4 * (x / TRAVEL) ** 2)),
    "flow_drop": (
        plant_with("flow_force", "stem_drop", 0.4, 0.3),
        PlainValve(push=lambda x: 0.4 / (1.0 + ((1.0 - x / TRAVEL) / 0.3) ** 2)),
    ),
    "flow_jet": (
        plant_with("flow_force", "stem_jet", 0.4, 0.25),
        PlainValve(push=lambda x: 1.6 * (1.0 - x / TRAVEL) * float(np.exp(1.0 - (1.0 - x / TRAVEL) / 0.25))),
    ),
    "flow_hump": (plant_with("flow_force", "stem_hump", 0.4), PlainValve(push=bow)),
    "flow_peak": (plant_with("flow_force", "stem_peak", 0.4, 1.0), PlainValve(push=peak)),
    "peak": (plant_with("flow_force", "peak", 0.4, 1.0), PlainValve(bend=peak)),
    "spring_at_stem": (plant_with("nonlinear_spring", "stem_bow", 0.4), PlainValve(push=bow)),
    "soft_at_stem": (plant_with("nonlinear_spring", "stem_slope", 0.3), PlainValve(stretch=softer)),
    "spot_at_stem": (plant_with("position_dependent_friction", "stem_spot", 0.3, 0.5, 0.15), PlainValve(grip=spot)),
    "drift": (plant_with("friction_drift", "linear", 0.01), PlainValve(grow=lambda t: 0.01 * t)),
    "cold": (
        plant_with("friction_drift", "from_cold", 0.4, 30.0),
        PlainValve(grow=lambda t: 0.4 * np.exp(-t / 30.0)),
    ),
    "sudden": (plant_with("friction_drift", "sudden", 0.4, 0.5), PlainValve(grow=lambda t: 0.4 * (t >= 29.9))),
    "gradual": (
        plant_with("friction_drift", "gradual", 0.4, 30.0, 6.0),
        PlainValve(grow=lambda t: 0.4 / (1.0 + np.exp((30.0 - t) / 6.0))),
    ),
    "easing": (
        plant_with("friction_drift", "sudden_easing", 0.4, 0.5, 0.6, 30.0),
        PlainValve(grow=lambda t: 0.4 * (1.0 - 0.6 * (1.0 - np.exp(-(t - 29.95) / 30.0))) * (t >= 29.9)),
    ),
    "damping": (plant_with("asymmetric_damping", "two_lags", 0.3), PlainValve(tau_close=3.51, tau_open=1.89)),
    "in_motion": (plant_with("friction_in_motion", "full"), PlainValve(in_motion=True)),
    "stiction": (plant_with("stiction", "one_jump", 0.6), PlainValve(breakaway=0.6)),
    "second_lag": (plant_with("additional_lag", "after_play", 0.8), PlainValve(second_lag=0.8)),
    "creep": (plant_with("creep", "one_tail", 0.2, 20.0), PlainValve(creep=0.2, creep_tau=20.0)),
    "upper_stop": (plant_with("reduced_travel", "upper_stop", 0.2), PlainValve(high=0.8 * TRAVEL)),
    "lower_stop": (plant_with("reduced_travel", "lower_stop", 0.1), PlainValve(low=0.1 * TRAVEL)),
    "lvdt_gain": (plant_with("lvdt_calibration", "gain_and_zero", 0.03, 0.01), PlainValve(reading=steeper)),
    "lvdt_bow": (plant_with("lvdt_nonlinearity", "bow", 0.02), PlainValve(reading=curved)),
    "lvdt_kink": (plant_with("lvdt_nonlinearity", "kink", 0.02, 0.7), PlainValve(reading=kinked)),
    "lvdt_drift": (plant_with("lvdt_drift", "linear", 2e-4), PlainValve(reading=lambda x, t: x + 2e-4 * t)),
    "lvdt_root": (plant_with("lvdt_drift", "root", 0.3), PlainValve(reading=lambda x, t: x + 0.3 * (t / 810.0) ** 0.5)),
    "lvdt_table": (plant_with("lvdt_nonlinearity", "table", *TABLE), PlainValve(reading=tabled)),
    "lvdt_wander": (plant_with("lvdt_drift", "wander", *WAVE), PlainValve(reading=waving)),
    "linkage": (plant_with("linkage_lost_motion", "play", 0.02), PlainValve(sensor_play=0.02)),
    "sensor_lag": (plant_with("sensor_lag", "first_order", 0.6), PlainValve(sensor_lag=0.6)),
}  # fmt: skip


@pytest.mark.parametrize("name", SAME)
def test_same_as_plain_python(name: str) -> None:
    plant, plain = SAME[name]
    time_s, command = excitation(0.1)
    p, y = run(plant, time_s, command, 0.01)
    plain_p, plain_y = plain.run(time_s, command, 0.1)
    assert np.abs(p - plain_p).max() < 0.02  # one Euler step of 2 ms against the largest slope, 27 psi/s, and change
    # A jump of the plain valve lands late by up to one Euler step of pressure: 27 psi/s * 2 ms * 0.19 in/psi.
    assert np.abs(y - plain_y).max() < (0.018 if name == "stiction" else 0.003) * TRAVEL


@pytest.mark.parametrize("period_s", [0.02, 0.1, 0.5])
def test_integration_error_of_the_step_that_simulate_uses(period_s: float) -> None:
    from twin.replay.simulate import step_for

    time_s, command = excitation(period_s)
    _, used = run(Plant(DESIGN), time_s, command, step_for(DESIGN))
    _, exact = run(Plant(DESIGN), time_s, command, 5e-4)
    assert np.abs(used - exact).max() < 2e-4 * TRAVEL


@pytest.mark.parametrize(("ep_tau_s", "tau_s"), [(0.05, 2.7), (0.01, 1.0), (1.0, 0.5), (0.3, 0.05), (2.0, 8.0)])
def test_integration_error_of_other_valves(ep_tau_s: float, tau_s: float) -> None:
    from twin.replay.simulate import step_for

    design = DesignModel(ep_tau_s=ep_tau_s, tau_s=tau_s)
    time_s, command = excitation(0.5)
    _, used = run(Plant(design), time_s, command, step_for(design))
    _, exact = run(Plant(design), time_s, command, 2e-4)
    assert np.abs(used - exact).max() < 2e-4 * TRAVEL


def test_jittered_times_are_as_good_as_regular_ones() -> None:
    rng = np.random.default_rng(3)
    time_s, command = excitation(0.1)
    jittered = time_s + np.concatenate([[0.0], rng.uniform(-0.03, 0.03, time_s.size - 1)])
    _, coarse = run(Plant(DESIGN), jittered, command, 0.02)
    _, fine = run(Plant(DESIGN), jittered, command, 5e-4)
    assert np.abs(coarse - fine).max() < 2e-4 * TRAVEL
