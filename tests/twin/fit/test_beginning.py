"""The pressure before the first row, where none was measured: found in how the stem moves off, and only a guess."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from twin.fit.beginning import beginning, start_notes
from twin.fit.case import make_case
from twin.fit.trial import SETTLE_S, make_trial
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.model.timegrid import make_grid
from twin.noise.coarse import Coarse
from twin.record.begun import Begun
from twin.record.under_way import under_way
from twin.replay.simulate import Start, simulate_recording

DESIGN = DesignModel()
NOISE = 0.001 * DESIGN.travel
#: The command falls in the row before the first; later there is another stroke, which has all of its delay.
COMMAND = np.concatenate([np.full(300, 11.2), np.full(400, 4.0), np.full(400, 12.0), np.full(400, 6.0)])


def recorded(plant: Plant, first: int, pressure: bool = False) -> Recording:
    """What is recorded from row `first` on."""
    time_s = np.arange(COMMAND.size) * 0.05
    blank = Recording("made", time_s, COMMAND, np.zeros(COMMAND.size))
    p, y = simulate_recording(plant, blank, start=Start(11.2, 0.4, 0.4))
    y = y + np.random.default_rng(8).normal(0.0, NOISE, y.size)
    return replace(blank, pressure=p if pressure else None, position=y).slice(first, COMMAND.size)


def begun(record: Recording, plant: Plant | None = None) -> Begun:
    return beginning(plant or Plant(DESIGN), record, make_grid(record.time_s, 0.02))


def test_a_command_that_fell_right_before_the_first_row_is_not_the_pressure_yet() -> None:
    record = recorded(Plant(DESIGN), 300)
    found = begun(record)
    fallen = 4.0 + 7.2 * np.exp(-0.05 / DESIGN.ep_tau_s)  # within the row
    assert found.pressure == pytest.approx(fallen, abs=0.1)
    assert 2.0 * DESIGN.tau_s < found.unsure_s < 20.0
    _, again = simulate_recording(DESIGN, record)
    assert np.std(again - record.position) < 1.05 * NOISE
    _, at_once = simulate_recording(DESIGN, record, start=Start(4.0, 0.46, 0.46))
    assert np.std(at_once - record.position) > 3.0 * NOISE


@pytest.mark.parametrize("first", [290, 450, 560])
def test_it_is_the_first_command_where_nothing_else_is_seen(first: int) -> None:
    """At rest before the step; on its way; at rest again."""
    assert begun(recorded(Plant(DESIGN), first)).pressure is None


@pytest.mark.parametrize("pressure", [True, False])
@pytest.mark.parametrize(
    ("first", "moves"), [(290, False), (300, True), (320, True), (380, True), (560, False), (690, False)]
)
def test_a_valve_is_under_way_while_the_command_stands_still_and_something_moves(
    first: int, moves: bool, pressure: bool
) -> None:
    record = recorded(Plant(DESIGN), first, pressure)
    assert under_way(DESIGN, record) is moves
    assert (begun(record).unsure_s > 0.0) is moves


@pytest.mark.parametrize(("left_of_travel", "moves"), [(0.006, True), (0.001, False)])
def test_the_end_of_a_motion_counts_while_a_quiet_gauge_shows_it(left_of_travel: float, moves: bool) -> None:
    """A stem 0.6 % of travel from where it comes to rest, with a lag of 2.7 s: as good as there to most eyes."""
    time_s = 0.1 * np.arange(300)
    chance = np.random.default_rng(2)
    rest_in, to_go_in = 0.3, left_of_travel * DESIGN.travel / -np.expm1(-1.5 / DESIGN.tau_s)
    position = rest_in + to_go_in * np.exp(-time_s / DESIGN.tau_s) + chance.normal(0.0, 3e-4 * DESIGN.travel, 300)
    assert under_way(DESIGN, Recording("late", time_s, np.full(300, 8.0), position, np.full(300, 8.0))) is moves


def test_false_readings_and_noise_move_nothing() -> None:
    record = recorded(Plant(DESIGN), 290, pressure=True)
    assert record.pressure is not None
    position, pressure = record.position.copy(), record.pressure + np.random.default_rng(9).normal(0.0, 0.2, record.n)
    position[[0, 27]], position[4] = 0.0, np.nan
    assert not under_way(DESIGN, replace(record, position=position, pressure=pressure))
    assert not under_way(DESIGN, record.slice(0, 4))


def test_the_lag_behind_the_gauge_is_no_part_of_the_first_reading() -> None:
    """What a chamber that fills slowly has left of an earlier command is in no reading: such rows count for nothing."""
    lag = Plant(DESIGN, (Inserted("additional_lag", effect("additional_lag").form("before_play"), (0.8,)),))
    record = recorded(lag, 303, pressure=True)
    use = make_trial(record, 0.02, begun=begun(record)).use_y
    _, again = simulate_recording(lag, record)
    off = again - record.position
    assert np.std(off[use]) < 1.05 * NOISE
    assert np.std(off[record.time_s - record.time_s[0] >= SETTLE_S]) > 3.0 * NOISE


def test_rows_that_feel_it_count_for_nothing_and_a_delay_is_seen_in_the_next_stroke() -> None:
    """A delay of the converter and a pressure that has yet to fall look alike in the first stroke."""
    late = Plant(DESIGN, (Inserted("dead_time", effect("dead_time").form("pure_delay"), (0.3,)),))
    record = recorded(late, 299)
    found = begun(record)
    assert found.pressure is not None
    trial = make_trial(record, 0.02, begun=found)
    assert trial.start_pressure == found.pressure
    since_s = record.time_s - record.time_s[0]
    assert not trial.use_y[since_s < found.unsure_s].any() and trial.use_y[since_s > found.unsure_s].all()
    assert make_trial(record, 0.02).use_y[since_s >= SETTLE_S].all()
    errors = [
        np.std((simulate_recording(plant, record)[1] - record.position)[trial.use_y]) for plant in (late, Plant(DESIGN))
    ]
    assert errors[0] < 1.05 * NOISE and errors[1] > 3.0 * NOISE


def test_a_recording_that_would_be_mostly_lost_is_kept() -> None:
    short = recorded(Plant(DESIGN), 300).slice(0, 420)
    found = begun(short)
    assert found.pressure is not None and found.unsure_s == 0.0


def test_what_a_coarse_reading_leaves_open_counts_for_nothing() -> None:
    """A stem under way, read in steps of 5 %: the first code is 2.5 % of travel off, and where it goes is not known."""
    record = recorded(Plant(DESIGN), 330, pressure=True)
    step = 0.05 * DESIGN.travel
    coarse = replace(record, position=step * np.round(record.position / step))
    found = beginning(Plant(DESIGN), coarse, make_grid(coarse.time_s, 0.02), Coarse(step, NOISE))
    assert 5.0 < found.unsure_s < 30.0
    use = make_trial(coarse, 0.02, begun=found).use_y
    _, model = simulate_recording(DESIGN, coarse)
    beyond = np.abs(model - coarse.position) > 0.5 * step + 3.0 * NOISE
    assert not (beyond & use).any()


def test_it_is_said_how_many_rows_that_costs() -> None:
    moving, still = (recorded(Plant(DESIGN), first, pressure=True) for first in (300, 290))
    trials = [make_trial(record, 0.02, begun=begun(record)) for record in (moving, still)]
    (note,) = start_notes(trials)
    assert note.what.startswith("1 of 2 recordings begin in a state")
    assert note.rows == np.count_nonzero(moving.time_s - moving.time_s[0] < trials[0].begun.unsure_s)
    assert start_notes(trials[1:]) == []


def test_a_coarse_reading_of_a_stem_at_rest_leaves_open_where_it_rests() -> None:
    record = recorded(Plant(DESIGN), 250, pressure=True)
    step = 0.05 * DESIGN.travel
    coarse = replace(record, position=step * np.round(record.position / step))
    assert not under_way(DESIGN, coarse)
    blurred, sharp = (make_case([coarse], DESIGN, step=step, sharp=sharp).trials[0] for sharp in (False, True))
    assert blurred.begun.unsure_s == 0.0
    assert 5.0 < sharp.begun.unsure_s < 30.0
    since_s = record.time_s - record.time_s[0]
    assert np.array_equal(sharp.use_y, since_s >= sharp.begun.unsure_s)
