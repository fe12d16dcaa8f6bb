"""What a recording does not say of the time before it: where plays and the core stand, where the stem is going."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import Recording
from twin.fit.beginning import beginning
from twin.fit.channel import predict_reading
from twin.fit.trial import make_trial
from twin.kernels.play import common_start
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, core_at, reading_at
from twin.model.timegrid import make_grid
from twin.replay.simulate import Start, moving_to, remembers, simulate_recording, start_of

DESIGN = DesignModel()
LINES = (0.0, 1.0, DESIGN.compliance * (np.arange(2.0) - DESIGN.a1), DESIGN.compliance * (np.arange(2.0) - DESIGN.a2))
STOPS = (0.0, DESIGN.travel)


def inserted(name: str, form: str, *values: float) -> Inserted:
    return Inserted(name, effect(name).form(form), values)


def recorded(plant: Plant, command: np.ndarray) -> Recording:
    """What the plant reads, from open, with no noise."""
    time_s = np.arange(command.size) * 0.1
    blank = Recording("made", time_s, command, np.zeros(command.size))
    pressure, position = simulate_recording(plant, blank, start=Start(command[0], 0.0, 0.0))
    return replace(blank, pressure=pressure, position=position)


@settings(deadline=None)  # the first call compiles
@given(
    st.lists(st.floats(0.0, 1.4), min_size=2, max_size=12),
    st.floats(4.0, 13.0),
    st.floats(0.0, 1.0),
    st.floats(-0.3, 0.3),
)
def test_elements_at_one_place_put_out_what_is_asked_where_the_pressure_lets_them(
    widths: list[float], force: float, share: float, wider: float
) -> None:
    spreads = np.array(widths) - np.mean(widths)
    weights = np.full(spreads.size, 1.0 / spreads.size)
    bounds = [
        np.clip(DESIGN.compliance * (force + sign * (spreads + wider) - a), *STOPS)
        for sign, a in ((-1.0, DESIGN.a1), (1.0, DESIGN.a2))
    ]
    bottom, top = np.minimum(*bounds), np.maximum(*bounds)  # a width below nothing would turn them round
    asked = float(weights @ (bottom + share * (top - bottom)))
    if np.any(bounds[0] > bounds[1]):
        return
    at = common_start(force, wider, STOPS, LINES, spreads, weights, asked)
    assert weights @ np.clip(at, bottom, top) == pytest.approx(asked, abs=1e-9)


def test_one_play_stays_where_it_is_said_to_be() -> None:
    assert common_start(9.0, 0.0, STOPS, LINES, np.zeros(1), np.ones(1), 0.3) == 0.3


@pytest.mark.parametrize("beside", [(), (inserted("friction_in_motion", "full"),)])
def test_a_spread_of_plays_at_rest_stays_at_rest(beside: tuple[Inserted, ...]) -> None:
    """A record that begins after an inner reversal: narrow plays are at their bounds, wide ones are not."""
    plant = Plant(DESIGN, (inserted("distributed_hysteresis", "uniform", 0.9), *beside))
    command = np.concatenate([np.full(600, 11.0), np.full(600, 9.0), np.full(300, 8.9), np.full(300, 7.0)])
    whole = recorded(plant, command)
    part = whole.slice(1100, 1800)
    _, position = simulate_recording(plant, part)
    assert np.abs(position - part.position)[:90].max() < 2e-4
    assert np.abs(position - part.position).max() < 0.03 * DESIGN.travel  # what wide ones remember is lost
    assert np.ptp(part.position) > 0.1 * DESIGN.travel


def test_the_core_of_a_loose_linkage_starts_where_it_is_read() -> None:
    """At a stop inside the travel the core may stand beyond it, on the far side of the play."""
    loose, stop = inserted("linkage_lost_motion", "play", 0.012), inserted("reduced_travel", "lower_stop", 0.03)
    plant = Plant(DESIGN, (stop, loose))
    record = recorded(plant, np.concatenate([np.full(200, 5.0), np.full(300, 11.0)]))
    stem_in = 0.03 * DESIGN.travel
    seen = replace(record, position=np.where(record.time_s < 20.0, stem_in - 0.005, record.position))
    trial = make_trial(seen, 0.02)
    for position in (simulate_recording(plant, seen)[1], predict_reading(plant, trial)):
        assert position[0] == pytest.approx(stem_in - 0.005, abs=1e-6)
        assert position[-1] == pytest.approx(record.position[-1], abs=1e-4)
    far = replace(record, position=np.where(record.time_s < 20.0, stem_in - 0.05, record.position))
    assert simulate_recording(plant, far)[1][0] == pytest.approx(stem_in - 0.006, abs=1e-6)


def test_where_a_valve_was_going_is_known_as_a_reading() -> None:
    """With a sensor that reads a tenth too much the stem goes a tenth less far."""
    plant = Plant(DESIGN, (inserted("lvdt_calibration", "gain", 0.1),))
    record = recorded(plant, np.concatenate([np.full(400, 11.2), np.full(30, 7.1), np.full(400, 8.0)]))
    part = record.slice(445, 830)  # coasting in the middle of the deadband, to where no pressure says
    trial = make_trial(part, 0.02, begun=beginning(Plant(DESIGN), part, make_grid(part.time_s, 0.02)))
    assert trial.begun.play == pytest.approx(part.position[-1], abs=0.001 * DESIGN.travel)
    assert np.abs(predict_reading(plant, trial) - part.position).max() < 0.006 * DESIGN.travel


def test_a_valve_that_moves_off_slower_than_designed_was_not_on_its_way_elsewhere() -> None:
    """At rest at half of the travel; the command steps in the first row, and the stem goes at its own rate limit."""
    slow = Plant(replace(DESIGN, rate_limit=0.6 * DESIGN.rate_limit))
    rest = np.concatenate([np.full(300, 10.3), np.full(100, 9.0), np.full(60, 13.0)])
    made = recorded(slow, rest)
    part = made.slice(399, made.n)
    grid = make_grid(part.time_s, 0.02)
    assert start_of(Plant(DESIGN), part, grid).play != start_of(Plant(DESIGN), part, grid).position
    assert moving_to(Plant(DESIGN), part, grid) is None


@example("leaves_range_open", -0.04, 0.9)
@given(st.sampled_from(["leaves_range_closed", "leaves_range_open"]), st.floats(-0.04, 0.04), st.floats(0.3, 0.9))
def test_where_the_core_stands_is_found_beyond_its_linear_range_too(form: str, bend: float, straight: float) -> None:
    c = Plant(DESIGN, (inserted("lvdt_nonlinearity", form, bend, straight),)).coefficients(1.0)
    for x in np.linspace(0.0, DESIGN.travel, 7):
        assert core_at(c, reading_at(c, float(x))) == pytest.approx(x, abs=2e-4)


@pytest.mark.parametrize("form", ["one_tail", "pull_tails"])
def test_what_tails_have_of_what_was_before_is_part_of_the_start(form: str) -> None:
    """A creeping valve, recorded from a rest on that is not yet over; the same from a true rest remembers nothing."""
    plant = Plant(DESIGN, (inserted("creep", form, 0.1, 40.0),))
    whole = recorded(plant, np.repeat([4.0, 13.0, 4.0, 10.0, 4.0, 11.0], 600))
    part = whole.slice(1400, whole.n)  # 20 s after it was vented: open, but for its tails
    grid = make_grid(part.time_s, 0.02)
    assert remembers(Plant(DESIGN), part, grid)
    assert not remembers(Plant(DESIGN), whole, make_grid(whole.time_s, 0.02))
    assert not remembers(Plant(DESIGN), whole.slice(1202, whole.n), make_grid(whole.time_s[1202:], 0.02))  # it moves
    _, again = simulate_recording(plant, part)
    assert np.abs(again - part.position).max() < 0.006 * DESIGN.travel
    start = replace(start_of(plant, part, grid), remembers=False)
    _, forgetful = simulate_recording(plant, part, start=start)
    assert np.abs(forgetful - part.position).max() > 0.02 * DESIGN.travel


def test_a_stem_that_moves_from_the_second_row_on_starts_where_it_was_read_first() -> None:
    plant = Plant(DESIGN)
    whole = recorded(plant, np.append(np.repeat([13.0, 9.0], 150), np.repeat([6.0, 11.0] * 8, 48)))
    part = whole.slice(299, whole.n)  # the command steps in the second row, and the stem never rests
    noisy = replace(part, position=part.position + np.random.default_rng(8).normal(0.0, 5e-4, part.n))
    slow = replace(noisy, **{key: getattr(noisy, key)[::3] for key in ("time_s", "command", "position", "pressure")})
    assert make_trial(slow, 0.02).start_position == pytest.approx(DESIGN.travel, abs=0.002)
    rest = replace(noisy, position=np.full(part.n, 0.2) + np.random.default_rng(9).normal(0.0, 5e-4, part.n))
    assert make_trial(rest, 0.02).start_position == pytest.approx(0.2, abs=2e-4)


def test_a_stem_that_lags_behind_a_ramp_is_held_by_nothing() -> None:
    """It stands off where the pressure has it for as long as the ramp lasts, and so does the design's."""
    ramp = np.concatenate([np.linspace(4.0, 13.0, 450), np.linspace(13.0, 4.0, 450)])
    for plant in (Plant(DESIGN), Plant(DESIGN, (inserted("creep", "one_tail", 0.03, 60.0),))):
        for row in (250, 750):
            part = recorded(plant, ramp).slice(row, 900)
            assert not remembers(Plant(DESIGN), part, make_grid(part.time_s, 0.02))


def test_a_gauge_that_hums_starts_where_it_swings_about() -> None:
    """Before the command changes a hum comes back, and a pressure that still settles does not."""
    command, rng = np.repeat([11.0, 8.0], [60, 200]), np.random.default_rng(4)
    time_s = 0.1 * np.arange(command.size)
    settles = 11.0 - 0.3 * np.exp(-time_s / 0.8)
    read = 11.0 + 0.13 * np.sin(4.0 * time_s) + rng.normal(0.0, 0.01, time_s.size)
    for pressure, start, within in ((read, 11.0, 0.03), (settles, 10.7, 0.04)):
        blank = Recording("made", time_s, command, np.full(command.size, 0.4), pressure)
        assert make_trial(blank, 0.02).start_pressure == pytest.approx(start, abs=within)
    spiked = settles.copy()
    spiked[[20, 30]] = 10.0  # two false readings are no swing
    blank = Recording("made", time_s, command, np.full(command.size, 0.4), spiked)
    assert make_trial(blank, 0.02).start_pressure == pytest.approx(10.7, abs=0.04)


def test_a_first_reading_that_is_alone_is_not_where_it_starts() -> None:
    """4.7 of its deviations: half a percent of travel at which a stem at rest stood until it moved."""
    command, rng = np.repeat([11.0, 8.0], [60, 200]), np.random.default_rng(4)
    time_s = 0.1 * np.arange(command.size)
    position = 0.42 + rng.normal(0.0, 4e-4, command.size)
    position[0] = 0.42 - 4.7 * 4e-4
    blank = Recording("made", time_s, command, position, None)
    assert make_trial(blank, 0.02).start_position == pytest.approx(0.42, abs=2e-4)
    moving = replace(blank, position=0.42 + 0.002 * np.arange(command.size))  # a stem under way starts at its first
    assert make_trial(moving, 0.02).start_position == pytest.approx(0.42, abs=1e-6)
