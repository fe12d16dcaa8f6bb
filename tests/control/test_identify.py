"""Identification end to end on a valve written from the interface document."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.identify import default_design, identify
from control.identify_result import Identified
from hal.errors import BadInput, JobFailed
from logs.recording import Recording
from tests.control.toy_valve import Toy, random_steps, record, without_pressure

TRUTH = {
    "a1": 8.78,
    "a2": 5.82,
    "deadband": 2.96,
    "compliance": 0.19,
    "k1": 0.19,
    "k2": 0.19,
    "k_eq": 0.19,
    "tau": 2.7,
    "rate_limit": 0.12,
    "travel": 0.5625,
    "ep.tau": 0.3,
}


def sweep(period_s: float = 0.1, duration_s: float = 300.0, toy: Toy | None = None, seed: int = 1) -> Recording:
    time_s = np.arange(0.0, duration_s - 0.5 * period_s, period_s)
    command = random_steps(duration_s, period_s, seed=seed)[: time_s.size]
    return record(toy or Toy(), time_s, command, seed=seed)


def check(found: Identified, names: tuple[str, ...] = tuple(TRUTH), within: float = 0.01) -> None:
    for name in names:
        assert found[name].value == pytest.approx(TRUTH[name], rel=within), name
        assert found[name].interval is not None, name


@pytest.mark.parametrize("period_s", [1.0, 0.2, 0.05])
def test_all_numbers_within_a_percent_at_any_sampling_rate(period_s: float) -> None:
    check(identify([sweep(period_s)]))


def test_most_intervals_hold_the_truth_and_are_narrow() -> None:
    found = [identify([sweep(seed=seed)]) for seed in (1, 2, 3)]
    held = [f[name].interval.holds(value) for f in found for name, value in TRUTH.items()]  # type: ignore[union-attr]
    assert np.mean(held) > 0.75
    for name, value in TRUTH.items():
        interval = found[0][name].interval
        assert interval is not None
        assert interval.half_width < 0.02 * value


def test_several_runs_are_fitted_together() -> None:
    one, both = identify([sweep(seed=1)]), identify([sweep(seed=1), sweep(seed=2)])
    check(both)
    assert both.rows == 2 * one.rows
    assert both.runs == ("toy-1", "toy-2")
    assert both["tau"].interval is not None
    assert one["tau"].interval is not None
    assert both["tau"].interval.half_width < one["tau"].interval.half_width


def test_without_pressure_the_converters_lag_is_kept_and_said() -> None:
    found = identify([without_pressure(sweep())])
    check(found, tuple(name for name in TRUTH if name != "ep.tau"))
    assert found["ep.tau"].interval is None
    assert any("cannot be separated" in note for note in found.notes)


def test_positions_in_percent() -> None:
    plain = sweep()
    found = identify([replace(plain, position=plain.position / 0.5625 * 100.0, position_unit="percent")])
    assert found["compliance"].value == pytest.approx(0.19 / 0.5625 * 100.0, rel=0.01)
    assert found["travel"].value == pytest.approx(100.0, rel=0.01)
    assert found.design.position_unit == "percent"
    assert default_design("psi", "percent").rate_limit == pytest.approx(21.333, rel=1e-3)


def test_a_plain_gain_and_lag_has_no_deadband() -> None:
    toy = Toy(a1=4.0, a2=4.0, k1=0.05, k2=0.05, rate=1e6, travel=1e6)
    found = identify([sweep(toy=toy)])
    assert (found.design.a1, found.design.a2) == pytest.approx((4.0, 4.0), abs=0.01)
    assert 0.0 <= found["deadband"].value < 0.005
    assert found["compliance"].value == pytest.approx(0.05, rel=0.01)
    assert found["tau"].value == pytest.approx(2.7, rel=0.01)
    assert (found["rate_limit"].source, found["travel"].source) == ("kept", "kept")
    assert any("never reached" in note for note in found.notes)
    assert any("never touched" in note for note in found.notes)


def test_what_the_record_does_not_show_keeps_its_default_and_says_so() -> None:
    time_s = np.arange(0.0, 300.0, 0.1)
    found = identify([record(Toy(), time_s, np.linspace(7.0, 11.0, time_s.size))])
    assert found["a1"].value == pytest.approx(8.78, abs=0.03)
    assert found["compliance"].value == pytest.approx(0.19, rel=0.01)
    assert found["a2"].value == pytest.approx(found["a1"].value - 2.96)
    assert {name for name in ("a2", "rate_limit", "travel", "ep.tau", "k2") if found[name].interval is None} == {
        "a2",
        "rate_limit",
        "travel",
        "ep.tau",
        "k2",
    }
    assert any("opening curve is not in the record" in note for note in found.notes)


def test_false_and_missing_readings_are_left_out() -> None:
    plain = sweep()
    position = plain.position.copy()
    position[::37] = np.nan
    position[100::211] = 2.0
    found = identify([replace(plain, position=position)])
    check(found)
    assert any("false readings of the position" in note for note in found.notes)


def test_a_gap_cuts_the_record() -> None:
    plain = sweep()
    gap = np.zeros(plain.n, dtype=bool)
    gap[1500] = True
    time_s = np.where(np.arange(plain.n) >= 1500, plain.time_s + 80.0, plain.time_s)
    check(identify([replace(plain, gap_before=gap, time_s=time_s)]))


def test_commands_of_unknown_timing_are_put_where_they_fit() -> None:
    plain = sweep(0.5)
    shifted = np.concatenate((plain.command[1:], plain.command[-1:]))
    found = identify([replace(plain, command=shifted, command_timing="unknown")])
    check(found, within=0.02)
    assert any("count from their row on" in note for note in found.notes)


def test_separate_slopes() -> None:
    found = identify([sweep(toy=Toy(k1=0.2, k2=0.18))])
    assert found["k1"].value == pytest.approx(0.2, rel=0.01)
    assert found["k2"].value == pytest.approx(0.18, rel=0.01)
    assert found["k_eq"].value == pytest.approx(0.19, rel=0.01)


def test_what_cannot_be_identified_is_refused_in_words() -> None:
    plain = sweep(0.5)
    with pytest.raises(
        BadInput,
        match=r"position falls as the pressure rises.*'position=in\(0..T=T..0 in\)' with the travel, some 0.56",
    ):
        identify([replace(plain, position=0.5625 - plain.position)])
    with pytest.raises(BadInput, match="position falls as the command rises"):
        identify([replace(plain, pressure=None, position=0.5625 - plain.position)])
    with pytest.raises(BadInput, match="command never changes"):
        identify([replace(plain, command=np.full(plain.n, 9.0))])
    with pytest.raises(BadInput, match="never leaves its noise"):
        identify([replace(plain, position=0.001 * np.random.default_rng(0).standard_normal(plain.n))])
    levels = np.random.default_rng(2).uniform(5.0, 12.0, 60)
    far = Recording("far", 12.0 * np.arange(60), levels, 0.19 * (levels - 5.0))
    with pytest.raises(BadInput, match=r"so much from row to row \(every 12 s\)"):
        identify([far])
    with pytest.raises(BadInput, match="bring them to the same units"):
        identify([plain, replace(plain, position_unit="percent")])
    with pytest.raises(BadInput, match="12 rows are too few"):
        identify([plain.slice(0, 12)])
    with pytest.raises(BadInput, match="no recording"):
        identify([])


def test_a_short_record_that_is_the_wrong_way_round_is_told_so() -> None:
    levels = np.concatenate([np.linspace(3.0, 15.0, 10), np.linspace(15.0, 3.0, 10)[1:]])
    short = record(Toy(), np.arange(1500) * 0.1, np.repeat(levels, 120)[:1500])
    with pytest.raises(BadInput, match="position falls as the pressure rises"):
        identify([replace(short, position=0.5625 - short.position)])


def test_times_in_another_unit_are_refused_and_not_divided_by_zero() -> None:
    plain = sweep(0.5)
    with pytest.raises(BadInput, match=r"0.299 s are too short to identify a valve; at least 2 s.*--units time=UNIT"):
        identify([replace(plain, time_s=1e-3 * plain.time_s)])


def test_it_is_said_how_far_the_command_alone_goes_astray() -> None:
    plain = sweep()
    assert plain.pressure is not None
    right = identify([plain]).quality.commanded_percent_of_travel
    assert right == pytest.approx(0.107, abs=0.02)
    off = identify([replace(plain, pressure=plain.pressure + 0.5)])
    assert off.quality.rms_percent_of_travel == pytest.approx(0.107, abs=0.02)
    assert off.quality.commanded_percent_of_travel is not None
    assert off.quality.commanded_percent_of_travel > 5.0
    assert identify([without_pressure(plain)]).quality.commanded_percent_of_travel is None


def test_positions_at_every_other_row_are_enough() -> None:
    plain = sweep()
    position = plain.position.copy()
    position[::2] = np.nan
    check(identify([replace(plain, position=position)]))


def test_one_stroke_says_nothing_of_a_play() -> None:
    # One step up shows one curve; that no play was seen is no proof that there is none.
    time_s = np.arange(0.0, 12.0, 0.1)
    rise = np.where(time_s > 4.0, 0.2 * (1.0 - np.exp(-(time_s - 4.0) / 2.7)), 0.0)
    noise = np.random.default_rng(1).normal(0.0, 1.0, (2, time_s.size))
    command = np.where(time_s > 4.0, 7.5, 7.0)
    stroke = Recording("stroke", time_s, command, 0.1 + rise + 7e-4 * noise[0], command + 0.01 * noise[1])
    with pytest.raises(JobFailed, match="sweep through both"):
        identify([stroke])


def test_the_result_goes_into_json_and_names_what_is_missing() -> None:
    found = identify([sweep(0.5)])
    plain = found.to_plain()
    assert set(TRUTH) <= set(plain["estimates"])  # type: ignore[call-overload]
    assert found.quality.rms_percent_of_travel == pytest.approx(0.107, abs=0.02)
    assert found.quality.fit_percent > 99.0
    with pytest.raises(KeyError):
        found["colour"]


def test_a_model_that_clearly_does_not_fit_says_that_the_intervals_do_not_cover_that() -> None:
    healthy = sweep()
    swung = replace(healthy, position=healthy.position + 0.02 * np.sin(healthy.time_s / 7.0))
    said = [note for note in identify([swung]).notes if "the model misses this record" in note]
    assert len(said) == 1
    assert "by 22 times its noise" in said[0]
    assert "run lostmotion diagnose" in said[0]


@pytest.mark.parametrize("kind", ["plain", "quiet", "loud", "coarse", "slow", "loud pressure", "no pressure"])
def test_a_healthy_record_gets_no_such_warning(kind: str) -> None:
    run = sweep(1.0 if kind == "slow" else 0.1)
    assert run.pressure is not None
    chance = np.random.default_rng(1).standard_normal(run.n)
    quiet = record(Toy(), run.time_s, run.command, noise_x=0.0)
    changed = {
        "quiet": quiet,
        "loud": replace(run, position=run.position + 0.005 * chance),
        "coarse": replace(run, position=np.round(run.position / 0.01) * 0.01),
        "loud pressure": replace(run, pressure=run.pressure + 0.1 * chance),
        "no pressure": without_pressure(run),
    }.get(kind, run)
    assert not any("misses this record" in note for note in identify([changed]).notes)
