"""The live twin says tick by tick what the simulation says of the whole record, for every effect in every form."""

from __future__ import annotations

import time

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.live.twin import LiveTwin
from twin.model.catalog import effects
from twin.model.effect import Form, Scales
from twin.model.plant import Inserted, Plant
from twin.replay.chain import takes_air
from twin.replay.simulate import Start, simulate_recording

FORMS = [(name, form.name) for name, effect in effects().items() for form in effect.forms if not form.seen]


def jagged_record(n: int = 600) -> Recording:
    """Steps of all sizes, ramps and rests at an uneven period."""
    chance = np.random.default_rng(5)
    time_s = np.cumsum(0.1 + 0.03 * chance.uniform(-1.0, 1.0, n))
    levels = np.repeat(chance.uniform(4.0, 13.0, n // 60 + 1), 60)[:n]
    ramp = np.where((np.arange(n) // 120) % 2 == 0, 0.02 * (np.arange(n) % 60), 0.0)
    return Recording("jagged", time_s, levels + ramp, np.zeros(n))


def live(plant: Plant, record: Recording, start: Start) -> tuple[FloatArray, FloatArray]:
    twin = LiveTwin(plant, record.time_s[0], record.command[0], start, record.duration_s)
    rows = [(twin.pressure, twin.position)]
    rows += [twin.step(t, u) for t, u in zip(record.time_s[1:].tolist(), record.command[1:].tolist(), strict=True)]
    pressure, position = (np.array(column) for column in zip(*rows, strict=True))
    return pressure, position


def inserted(name: str, form: Form) -> Inserted:
    scales = Scales()
    values = tuple((p.starts[-1] if p.size else p.starts[0]) * scales.factor(p.kind) for p in form.parameters)
    return Inserted(name, form, values)


@pytest.mark.parametrize(("name", "form"), FORMS)
def test_equals_the_simulation_of_the_whole_record(name: str, form: str) -> None:
    plant = Plant(DesignModel(), (inserted(name, effects()[name].form(form)),))
    record, start = jagged_record(), Start(7.0, 0.1, 0.12)
    pressure, position = live(plant, record, start)
    whole_p, whole_y = simulate_recording(plant, record, start=start)
    # a replay of so little air goes over both until they agree, a live model block by block (see `twin.replay.chain`)
    close = 1e-3 if takes_air(plant.coefficients(record.duration_s).ep) else 1e-9
    assert np.max(np.abs(pressure - whole_p)) < close
    assert np.max(np.abs(position - whole_y)) < close
    assert np.ptp(position) > 0.1


def test_a_booster_that_takes_much_air_goes_block_by_block_in_a_replay_too() -> None:
    """Where going over air and stem does not settle, there is no difference at all between the two."""
    form = effects()["ep_rate_limit"].form("orifices")
    plant = Plant(DesignModel(), (Inserted("ep_rate_limit", form, (1.2, 1.2, 4.0)),))
    record, start = jagged_record(), Start(7.0, 0.1, 0.12)
    for mine, whole in zip(live(plant, record, start), simulate_recording(plant, record, start=start), strict=True):
        assert np.max(np.abs(mine - whole)) < 1e-9


@pytest.mark.parametrize("form", ["one_tail", "two_tails", "pull_tail", "pull_tails"])
def test_a_stem_held_by_its_tails_begins_where_it_was_read(form: str) -> None:
    plant = Plant(DesignModel(), (inserted("creep", effects()["creep"].form(form)),))
    record, start = jagged_record(), Start(4.0, 0.03, 0.03, remembers=True)
    _, position = live(plant, record, start)
    _, whole = simulate_recording(plant, record, start=start)
    assert np.max(np.abs(position - whole)) < 1e-9
    assert position[0] == pytest.approx(0.03)
    _, forgetful = simulate_recording(plant, record, start=Start(4.0, 0.03, 0.03))
    assert np.abs(whole - forgetful)[30:].max() > 0.005


@pytest.mark.parametrize(
    "names",
    [
        pytest.param([("sensor_lag", "leads"), ("linkage_lost_motion", "play")], id="pushed to and fro"),
        pytest.param([("distributed_hysteresis", "uniform"), ("friction_in_motion", "full")], id="begins at rest"),
        pytest.param([("sensor_lag", "three_poles"), ("additional_lag", "mass_on_spring")], id="five filters"),
    ],
)
def test_two_effects_that_share_a_state_equal_the_simulation_of_the_whole_record(names: list[tuple[str, str]]) -> None:
    """A loose core with a lead is not pushed at each row, a spread of plays with friction in the motion begins at rest,
    and filters of both effects stand one behind the other."""
    plant = Plant(DesignModel(), tuple(inserted(n, effects()[n].form(f)) for n, f in names))
    record, start = jagged_record(), Start(9.0, 0.1, 0.1)
    _, position = live(plant, record, start)
    _, whole = simulate_recording(plant, record, start=start)
    assert np.max(np.abs(position - whole)) < 1e-9


@pytest.mark.parametrize("core", [0.09, 0.097, 0.2])
def test_a_loose_linkage_begins_where_it_was_read(core: float) -> None:
    loose = Inserted("linkage_lost_motion", effects()["linkage_lost_motion"].form("play"), (0.012,))
    plant = Plant(DesignModel(), (loose,))
    record, start = jagged_record(), Start(7.0, 0.1, 0.12, core)
    _, position = live(plant, record, start)
    _, whole = simulate_recording(plant, record, start=start)
    assert np.max(np.abs(position - whole)) < 1e-9
    assert position[0] == pytest.approx(min(max(core, 0.094), 0.106))


def test_equals_the_simulation_with_everything_at_once() -> None:
    names = [
        ("dead_time", "pure_delay"),
        ("ep_deadband", effects()["ep_deadband"].forms[0].name),
        ("distributed_hysteresis", effects()["distributed_hysteresis"].forms[0].name),
        ("additional_lag", "after_play"),
        ("creep", "two_tails"),
        ("lvdt_drift", "warm_up"),
        ("lvdt_drift", "wander"),
        ("sensor_lag", "first_order"),
        ("stale_samples", effects()["stale_samples"].forms[0].name),
    ]
    plant = Plant(DesignModel(), tuple(inserted(n, effects()[n].form(f)) for n, f in names))
    record, start = jagged_record(), Start(6.0, 0.05, 0.05)
    pressure, position = live(plant, record, start)
    whole_p, whole_y = simulate_recording(plant, record, start=start)
    assert np.max(np.abs(pressure - whole_p)) < 1e-9
    assert np.max(np.abs(position - whole_y)) < 1e-9


@pytest.mark.parametrize("effect", ["", "stiction"])
def test_a_tick_costs_less_than_a_millisecond_of_processor_time(effect: str) -> None:
    form = effects()["stiction"].forms[0]
    plant = Plant(DesignModel(), (inserted(effect, form),) if effect else ())
    record = jagged_record()
    live(plant, record, Start(5.0, 0.0, 0.0))  # compiled passes are loaded
    begun = time.process_time()
    live(plant, record, Start(5.0, 0.0, 0.0))
    assert (time.process_time() - begun) / record.n < 1e-3


def test_a_row_that_is_not_later_changes_nothing() -> None:
    twin = LiveTwin(Plant(DesignModel()), 0.0, 4.0, Start(4.0, 0.0, 0.0), 10.0)
    after = twin.step(1.0, 12.0)
    assert twin.step(1.0, 4.0) == after
    assert twin.step(1.1, 12.0) != after


def test_at_rest_begins_where_the_sensor_shows_the_stem() -> None:
    gain = effects()["lvdt_calibration"].forms[0]
    plant = Plant(DesignModel(), (inserted("lvdt_calibration", gain),))
    twin = LiveTwin.at_rest(plant, 0.0, 7.5, 0.2, None, 10.0)
    assert twin.position == pytest.approx(0.2, abs=1e-12)
    assert twin.pressure == 7.5
