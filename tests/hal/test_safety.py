"""The safety layer, limit by limit, on both sides of every limit, and every way out."""

from __future__ import annotations

import math
import threading

import pytest

from hal.clock import SteppedClock
from hal.errors import BenchFault, PortFault, SafetyTrip, WireFault
from hal.fake import FakeBench
from hal.latch import Latch
from hal.profile import Limits
from hal.safety import SafeBench, describe_way_out
from hal.sample import Quality
from hal.signals import Stopped

LIMITS = Limits(
    command_min=1.0,
    command_max=15.0,
    slew_per_s=None,
    position_min_in=-0.05,
    position_max_in=0.6,
    pressure_max_psi=18.0,
    max_missing=3,
    max_age_s=1.0,
)


class Rig:
    """A fake bench whose readings the test chooses, inside the safety layer."""

    def __init__(self, limits: Limits = LIMITS, latch: Latch | None = None, **fake) -> None:
        self.clock = SteppedClock(100.0)
        self.pressure, self.position = 5.0, 0.1
        self.fake = FakeBench(self.clock, response=lambda time_s, command: (self.pressure, self.position), **fake)
        self.safe = SafeBench(self.fake, limits, self.clock, latch=latch)

    def tick(self, command: float = 5.0, dt_s: float = 0.1):
        sample = self.safe.exchange(command)
        self.clock.sleep_until(self.clock.now_s() + dt_s)
        return sample


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


@pytest.mark.parametrize("quality", [Quality.MISSING, Quality.SENTINEL, Quality.IMPLAUSIBLE])
def test_the_limit_of_untrusted_readings(quality) -> None:
    rig = Rig(LIMITS.model_copy(update={"max_age_s": 99.0}), script=dict.fromkeys((1, 2, 3, 5, 6, 7, 8), quality))
    with pytest.raises(SafetyTrip, match="no trusted reading in 4 ticks in a row \\(limit 3\\)"), rig.safe:
        for _ in range(8):  # three bad ones, a good one, three bad ones
            rig.tick()
        assert rig.fake.reasons == []
        rig.tick()
    assert len(rig.fake.commands) == 9


def test_saturated_readings_are_readings() -> None:
    rig = Rig(script=dict.fromkeys(range(20), Quality.SATURATED))
    with rig.safe:
        for _ in range(20):
            rig.tick()


def test_stale_readings_trip_by_age_and_not_by_number() -> None:
    rig = Rig(LIMITS.model_copy(update={"max_missing": 2}), script=dict.fromkeys(range(1, 99), Quality.STALE))
    with pytest.raises(SafetyTrip, match=r"the last fresh reading is 1\.1 s old \(limit 1 s\)"), rig.safe:
        for _ in range(11):
            rig.tick(dt_s=0.1)
        assert rig.fake.reasons == [], "1.0 s old is not too old"
        rig.tick()


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
        rig.tick()
        assert rig.fake.reasons == []
        rig.tick()


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


WAYS_OUT = [
    (None, "success", "normal end"),
    (KeyboardInterrupt(), "abort", "Ctrl-C"),
    (Stopped("SIGINT"), "abort", "Ctrl-C"),
    (Stopped("SIGTERM"), "abort", "terminated (SIGTERM)"),
    (Stopped("SIGHUP"), "abort", "terminal closed (SIGHUP)"),
    (SafetyTrip("too far"), "fail", "safety trip: too far"),
    (PortFault("gone"), "fail", "PortFault: gone"),
    (ValueError("a defect"), "fail", "ValueError: a defect"),
    (SystemExit(3), "fail", "SystemExit: 3"),
]


@pytest.mark.parametrize(("error", "status", "reason"), WAYS_OUT)
def test_every_way_out_leads_to_the_safe_command_and_is_remembered(error, status, reason) -> None:
    rig = Rig()

    def job() -> None:
        with rig.safe:
            rig.tick(7.0)
            if error is not None:
                raise error

    if error is None:
        job()
    else:
        with pytest.raises(type(error)):
            job()
    assert rig.fake.reasons[0] == reason
    assert (rig.fake.held, rig.fake.open) == (0.0, False)
    way = rig.safe.way_out
    assert way is not None
    assert (way.status, way.reason, way.safe) == (status, reason, True)
    assert describe_way_out(error) == (status, reason)


def test_a_bench_fault_in_the_middle_of_an_exchange_leads_to_the_safe_command() -> None:
    rig = Rig(script={1: WireFault("broken")})
    with pytest.raises(WireFault), rig.safe:
        rig.tick()
        rig.tick()
    assert rig.fake.reasons[0] == "WireFault: broken"
    assert not rig.fake.open


@pytest.mark.parametrize("error", [None, KeyboardInterrupt(), ValueError("x")])
def test_an_unconfirmed_safe_command_is_said_loudly(error, tmp_path) -> None:
    rig = Rig(confirms_safe=False, latch=Latch(tmp_path / "stop.json"))

    def job() -> None:
        with rig.safe:
            if error is not None:
                raise error

    with pytest.raises(BenchFault, match="did NOT confirm its safe command") as caught:
        job()
    assert caught.value.__cause__ is error
    assert not rig.fake.open
    assert rig.safe.way_out is not None
    assert not rig.safe.way_out.safe
    again = Rig(latch=Latch(tmp_path / "stop.json"))
    with pytest.raises(SafetyTrip, match="not acknowledged"):
        again.safe.__enter__()
    assert again.fake.entered == 0, "nothing may be opened before somebody has looked"


def test_an_emergency_stop_holds_until_it_is_acknowledged(tmp_path) -> None:
    latch = Latch(tmp_path / "state" / "stop.json")
    rig = Rig(latch=latch)
    with pytest.raises(SafetyTrip, match="emergency stop: smoke"), rig.safe:
        assert rig.safe.emergency_stop("smoke")
        rig.tick()
    with pytest.raises(SafetyTrip, match="emergency stop: smoke"):
        Rig(latch=latch).safe.__enter__()
    latch.acknowledge()
    with Rig(latch=latch).safe as safe:
        assert safe.exchange(5.0).commanded_psi == 5.0


def test_an_emergency_stop_by_another_program_stops_the_next_tick(tmp_path) -> None:
    latch = Latch(tmp_path / "stop.json")
    rig = Rig(latch=latch)
    with pytest.raises(SafetyTrip, match="the other terminal"), rig.safe:
        rig.tick()
        latch.engage("the other terminal")
        rig.tick()
    assert len(rig.fake.commands) == 1


def test_the_dead_mans_thread_acts_when_the_loop_stalls() -> None:
    rig = Rig()
    stalled = threading.Event()
    make_safe = rig.fake.make_safe

    def watched(reason: str) -> bool:
        stalled.set()
        return make_safe(reason)

    rig.fake.make_safe = watched  # type: ignore[method-assign]
    rig.safe = SafeBench(rig.fake, LIMITS, rig.clock, deadman_s=0.02)
    with pytest.raises(SafetyTrip, match="the loop stalled"), rig.safe:
        rig.tick(9.0)
        assert stalled.wait(5.0)
        rig.tick(9.0)
    assert rig.fake.commands == [9.0]


def test_a_failure_right_after_entering_leaves_the_bench_again() -> None:
    rig = Rig()

    class Broken(FakeBench):
        @property
        def held_command(self) -> float:
            raise KeyboardInterrupt

    bench = Broken(rig.clock)
    with pytest.raises(KeyboardInterrupt):
        SafeBench(bench, LIMITS, rig.clock).__enter__()
    assert not bench.open
    assert bench.reasons
