"""A coarse reading that always rounds down is half a step off, whatever else is wrong with the valve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.trials import DESIGN, staircase, trial_of
from twin.events.scan import Events
from twin.events.tails import Tail
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.ready.rounding import rounding_down
from twin.record.sensing import Sensing

STEP_IN = 0.0021
LATE = Inserted("additional_lag", effect("additional_lag").form("behind_stem"), (0.3,))
LOPSIDED = Inserted("asymmetric_damping", effect("asymmetric_damping").form("two_lags"), (-0.2,))


def coarse(
    *inserted: Inserted, down: bool, design: DesignModel = DESIGN, to_psi: Sequence[float] = (3.0, 14.0)
) -> tuple[Recording, Sensing]:
    to_the_stops = np.repeat(to_psi, 400)
    trial, _ = trial_of(Plant(design, inserted), np.concatenate([staircase(), to_the_stops]))
    steps = trial.recording.position / STEP_IN
    position = STEP_IN * (np.floor(steps) if down else np.round(steps))
    none = np.zeros(position.size, dtype=bool)
    seen = Sensing((Events({}, none, none, Tail(0, np.empty(0))),), {"sensor_quantization": {}}, STEP_IN)
    return replace(trial.recording, position=position), seen


@pytest.mark.parametrize("inserted", [(), (LATE,)])
def test_rounding_down_is_half_a_step(inserted: tuple[Inserted, ...]) -> None:
    recording, seen = coarse(*inserted, down=True)
    (found,) = rounding_down([recording], Plant(DESIGN), seen)
    assert found.values == pytest.approx((-0.5 * STEP_IN,))


@pytest.mark.parametrize("inserted", [(), (LATE,), (LOPSIDED,)])
def test_rounding_to_the_nearest_is_nothing(inserted: tuple[Inserted, ...]) -> None:
    recording, seen = coarse(*inserted, down=False)
    assert rounding_down([recording], Plant(DESIGN), seen) == ()


def test_curves_that_are_half_a_step_off_are_no_rounding() -> None:
    """Between the stops they look like it; at the stops they do not."""
    shift = 0.5 * STEP_IN / DESIGN.compliance
    moved = replace(DESIGN, a1=DESIGN.a1 + shift, a2=DESIGN.a2 + shift)
    recording, seen = coarse(down=False, design=moved)
    assert rounding_down([recording], Plant(DESIGN), seen) == ()


def test_rests_that_all_round_the_same_way_are_no_rounding_down() -> None:
    """Rounding errors at few places have a mean, and a model that starts half a step off stays there for a while."""
    step_in = 0.0518
    trial, _ = trial_of(Plant(DESIGN), np.repeat([6.0, 8.8, 8.95, 9.3, 9.6, 9.3, 9.9, 6.3], 300))
    position = step_in * np.round(trial.recording.position / step_in)
    none = np.zeros(position.size, dtype=bool)
    seen = Sensing((Events({}, none, none, Tail(0, np.empty(0))),), {"sensor_quantization": {}}, step_in)
    assert rounding_down([replace(trial.recording, position=position)], Plant(DESIGN), seen) == ()


def test_rests_off_the_stops_that_all_round_up_are_no_rounding_up() -> None:
    """Each rest reads 0.45 steps too high, which rounding may make; half a step of zero would fit it better."""
    step_in = 0.0518
    places = step_in * (np.array([2.0, 4.0, 6.0, 8.0, 10.0]) - 0.45)
    trial, _ = trial_of(Plant(DESIGN), np.repeat(DESIGN.a1 + places / DESIGN.compliance, 400))
    part = trial.recording.slice(150, trial.recording.n)
    none = np.zeros(part.n, dtype=bool)
    seen = Sensing((Events({}, none, none, Tail(0, np.empty(0))),), {"sensor_quantization": {}}, step_in)
    coarse = replace(part, position=step_in * np.round(part.position / step_in))
    assert rounding_down([coarse], Plant(DESIGN), seen) == ()


@pytest.mark.parametrize(("down", "every"), [(True, 5), (False, 3)])
def test_a_stop_that_says_neither_leaves_it_to_the_rest_of_the_record(down: bool, every: int) -> None:
    """Read a quarter of a step low in the mean, it may be as well of a display that rounds as of one that cuts."""
    recording, seen = coarse(down=down, to_psi=[3.0])
    held = trial_of(Plant(DESIGN), recording.command)[1] < 0.1 * STEP_IN
    read = np.where(np.arange(recording.n) % every == 0, -STEP_IN, 0.0)
    found = rounding_down([replace(recording, position=np.where(held, read, recording.position))], Plant(DESIGN), seen)
    assert [one.values for one in found] == ([pytest.approx((-0.5 * STEP_IN,))] if down else [])


def test_a_larger_zero_error_is_no_rounding() -> None:
    recording, seen = coarse(down=False)
    off = replace(recording, position=recording.position - 3.0 * STEP_IN)
    error = Plant(DESIGN, (Inserted("lvdt_calibration", effect("lvdt_calibration").form("zero"), (-3.0 * STEP_IN,)),))
    assert rounding_down([off], error, seen) == ()


@pytest.mark.parametrize("place", [-0.45, 0.4, 0.45])
def test_a_stop_beside_the_steps_does_not_say_how_they_round(place: float) -> None:
    """It is read as the next code, which is nearly half a step away, and no zero error at all."""
    step_in = 0.02
    fine = trial_of(Plant(DESIGN), np.repeat([3.0, 9.3, 10.4, 6.2, 3.0], 400))[0].recording
    none = np.zeros(fine.n, dtype=bool)
    seen = Sensing((Events({}, none, none, Tail(0, np.empty(0))),), {"sensor_quantization": {}}, step_in)
    beside = replace(fine, position=step_in * (np.round(fine.position / step_in - place) + place))
    assert rounding_down([beside], Plant(DESIGN), seen) == ()


@pytest.mark.parametrize(("rounds", "off"), [(np.round, 0.0), (np.floor, -0.5)])
def test_a_stop_beside_the_steps_says_what_no_rounding_can_make(rounds: np.ufunc, off: float) -> None:
    """Whatever else is wrong with the valve: here its curves are half a step from the design's."""
    step_in, place = 0.02, 0.31
    shift = 0.5 * step_in / DESIGN.compliance
    moved = Plant(replace(DESIGN, a1=DESIGN.a1 + shift, a2=DESIGN.a2 + shift))
    command = np.concatenate([np.repeat([3.0, 9.3, 10.4, 6.2, 3.0], 400), staircase()])
    fine = trial_of(moved, command)[0].recording
    none = np.zeros(fine.n, dtype=bool)
    quantized: dict[str, dict[str, float]] = {"sensor_quantization": {}}
    seen = Sensing((Events({}, none, none, Tail(0, np.empty(0))),), quantized, step_in)
    beside = replace(fine, position=step_in * (rounds(fine.position / step_in - place) + place))
    assert sum(one.values[0] for one in rounding_down([beside], Plant(DESIGN), seen)) == pytest.approx(off * step_in)
