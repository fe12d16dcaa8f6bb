"""The safety layer, limit by limit, on both sides of every limit."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from hal.errors import SafetyTrip
from hal.profile import Limits
from hal.sample import Quality
from tests.hal.safety_rig import LIMITS, Rig


@pytest.mark.parametrize(
    ("command", "sent"),
    [(0.99, 1.0), (1.0, 1.0), (1.01, 1.01), (14.99, 14.99), (15.0, 15.0), (15.01, 15.0), (-1e9, 1.0)],
)
def test_commands_stay_in_their_range(command, sent) -> None:
    rig = Rig()
    with rig.safe:
        assert rig.tick(command).commanded_psi == sent
        assert rig.safe.clamped == (command != sent)
    assert rig.fake.commands == [sent]


@pytest.mark.parametrize("command", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_no_number_trips_and_is_never_sent(command) -> None:
    rig = Rig()
    with pytest.raises(SafetyTrip, match="is not a number"), rig.safe:
        rig.tick(command)
    assert rig.fake.commands == []
    assert "is not a number" in rig.fake.reasons[0]


def test_slew_is_measured_over_the_time_between_commands() -> None:
    rig = Rig(LIMITS.model_copy(update={"slew_per_s": 10.0, "command_min": 0.0}))
    with rig.safe:
        assert rig.tick(5.0, dt_s=0.1).commanded_psi == pytest.approx(0.1)  # 10 psi/s over the first 10 ms
        assert rig.tick(5.0, dt_s=0.2).commanded_psi == pytest.approx(1.1)
        assert rig.tick(5.0, dt_s=0.1).commanded_psi == pytest.approx(3.1)
        assert rig.tick(3.6, dt_s=0.1).commanded_psi == pytest.approx(3.6)  # a step within the limit passes unchanged
        assert rig.tick(0.0).commanded_psi == pytest.approx(2.6)
    assert rig.safe.clamped == 4


def test_slew_starts_from_what_the_device_holds() -> None:
    rig = Rig(LIMITS.model_copy(update={"slew_per_s": 10.0}))
    rig.fake.held_command = 8.0  # type: ignore[attr-defined]
    with rig.safe:
        assert rig.tick(8.05).commanded_psi == pytest.approx(8.05)


@pytest.mark.parametrize(("held", "first"), [(19.0, 14.9), (-1000.0, 1.1), (math.nan, 1.1)])
def test_a_bench_that_was_left_out_of_range_comes_into_it_at_once(held: float, first: float) -> None:
    """Its slew counts from the end of the range: with a wrong read-back no command is out of it either."""
    rig = Rig(LIMITS.model_copy(update={"slew_per_s": 10.0}))
    rig.fake.held_command = held  # type: ignore[attr-defined]
    with rig.safe:
        assert rig.tick(8.0).commanded_psi == pytest.approx(first)
        assert rig.safe.clamped == 1


@pytest.mark.parametrize("quality", [Quality.MISSING, Quality.SENTINEL, Quality.IMPLAUSIBLE])
def test_the_limit_of_untrusted_readings(quality) -> None:
    rig = Rig(LIMITS.model_copy(update={"max_age_s": 99.0}), script=dict.fromkeys((1, 2, 3, 5, 6, 7, 8), quality))
    with pytest.raises(SafetyTrip, match="no trusted reading in 4 ticks in a row \\(limit 3\\)"), rig.safe:
        for _ in range(20):  # a good one, three bad ones, a good one, four bad ones
            rig.tick()
    assert len(rig.fake.commands) == 9


def test_saturated_readings_are_readings() -> None:
    rig = Rig(script=dict.fromkeys(range(20), Quality.SATURATED))
    with rig.safe:
        for _ in range(20):
            rig.tick()


def test_stale_readings_trip_by_age_and_not_by_number() -> None:
    rig = Rig(LIMITS.model_copy(update={"max_missing": 2}), script=dict.fromkeys(range(1, 99), Quality.STALE))
    with pytest.raises(SafetyTrip, match=r"the last fresh reading is 1\.12 s old \(limit 1 s\)"), rig.safe:
        for _ in range(20):
            rig.tick(dt_s=0.125)
    assert len(rig.fake.commands) == 10, "1.0 s old is not too old"


@pytest.mark.parametrize(
    ("name", "limit", "step", "sentence"),
    [
        ("position", -0.05, -0.001, "position -0.0510 in is below its limit of -0.05 in"),
        ("position", 0.6, 0.001, "position 0.6010 in is above its limit of 0.6 in"),
        ("pressure", 18.0, 0.01, "pressure 18.010 psi is above its limit of 18 psi"),
    ],
)
def test_limits_of_readings_trip_on_the_second_tick_beyond(name, limit, step, sentence) -> None:
    rig = Rig()
    with pytest.raises(SafetyTrip, match=sentence), rig.safe:
        setattr(rig, name, limit)
        for _ in range(5):
            rig.tick()  # at the limit is within it
        for _ in range(3):  # spikes of one tick
            setattr(rig, name, limit + step)
            rig.tick()
            setattr(rig, name, limit)
            rig.tick()
        setattr(rig, name, limit + step)
        for _ in range(5):
            rig.tick()
    assert len(rig.fake.commands) == 13, "the second tick beyond the limit, and not a spike"


def test_limits_that_are_not_given_do_not_act() -> None:
    rig = Rig(Limits(command_min=0, command_max=20))
    rig.pressure, rig.position = 1e6, -1e6
    with rig.safe:
        for _ in range(5):
            rig.tick()


def test_an_untrusted_reading_is_not_held_against_the_travel_limits() -> None:
    rig = Rig(script={0: Quality.IMPLAUSIBLE, 1: Quality.IMPLAUSIBLE, 2: Quality.IMPLAUSIBLE})
    rig.position = 99.0
    with rig.safe:
        for _ in range(3):
            rig.tick()
        rig.position = 0.1
        rig.tick()


def test_after_a_trip_nothing_is_sent_any_more() -> None:
    rig = Rig()
    with pytest.raises(SafetyTrip, match="is not a number"), rig.safe:
        with pytest.raises(SafetyTrip, match="the valve is at its safe command"):
            rig.tick(math.nan)
        sent = list(rig.fake.commands)
        with pytest.raises(SafetyTrip):
            rig.tick(5.0)
        assert rig.fake.commands == sent
        rig.tick(5.0)


def test_one_untrusted_signal_is_enough() -> None:
    rig = Rig()
    exchange = rig.fake.exchange

    def blind(command: float):
        sample = exchange(command)
        assert sample.pressure is not None
        return replace(sample, pressure=replace(sample.pressure, quality=Quality.SENTINEL))

    rig.fake.exchange = blind  # type: ignore[method-assign]
    with pytest.raises(SafetyTrip, match="no trusted reading in 4 ticks"), rig.safe:
        for _ in range(20):
            rig.tick()


@pytest.mark.parametrize(("direction", "first"), [("vent", 0.1), ("hold", 6.2)])
def test_slew_counts_from_where_the_bench_is_after_make_safe(
    direction: str, first: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And not over the time that it stood there."""
    rig = Rig(LIMITS.model_copy(update={"slew_per_s": 10.0, "command_min": 0.0}))
    info = replace(rig.fake.info, profile={"safe_direction": direction})
    monkeypatch.setattr(type(rig.fake), "info", property(lambda _: info))
    with rig.safe:
        rig.tick(0.1)
        for _ in range(6):
            rig.tick(8.0, dt_s=0.1)
        assert rig.safe.make_safe("test")
        rig.clock.sleep_until(rig.clock.now_s() + 60.0)
        assert rig.tick(8.0).commanded_psi == pytest.approx(first)
