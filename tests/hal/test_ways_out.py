"""Every way out of a bench leads to the safe command, and the record can say which one it was."""

from __future__ import annotations

import threading

import pytest

from hal.deadman import Deadman
from hal.errors import BenchFault, PortFault, SafetyTrip, WireFault
from hal.fake import FakeBench
from hal.latch import Latch
from hal.safety import SafeBench, describe_way_out
from hal.signals import Stopped
from tests.hal.safety_rig import LIMITS, Rig

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


def test_the_dead_mans_thread_ends_with_the_bench() -> None:
    rig = Rig()

    def watching() -> bool:
        return any(thread.name == "deadman" for thread in threading.enumerate())

    with SafeBench(rig.fake, LIMITS, rig.clock, deadman_s=60.0) as safe:
        assert not watching(), "nothing moves before the first command"
        safe.exchange(9.0)
        assert watching()
        safe.make_safe("between two runs")
        assert not watching()
        safe.arm(0.1)
        assert watching()
    assert not watching()
    assert rig.fake.reasons[-2] == "normal end"


def test_every_exchange_feeds_the_dead_mans_thread() -> None:
    class Counted(Deadman):
        fed = 0

        def feed(self) -> None:
            self.fed += 1

    rig = Rig()
    counted = Counted(60.0, lambda: None)
    rig.safe._deadman = counted
    with rig.safe:
        before = counted.fed
        rig.tick()
        rig.tick()
        assert counted.fed == before + 2


def test_a_stall_inside_an_exchange_ends_that_exchange() -> None:
    rig = Rig()
    acted = threading.Event()

    def slow(time_s: float, command: float) -> tuple[float, float]:
        assert acted.wait(5.0)  # the bench hangs until the dead man's thread has acted
        return 5.0, 0.1

    make_safe = rig.fake.make_safe
    rig.fake.response = slow
    rig.fake.make_safe = lambda reason: (make_safe(reason), acted.set())[0]  # type: ignore[method-assign]
    with (
        pytest.raises(SafetyTrip, match="the loop stalled"),
        SafeBench(rig.fake, LIMITS, rig.clock, deadman_s=0.02) as safe,
    ):
        safe.exchange(9.0)


def test_a_state_folder_that_cannot_be_written_does_not_come_between(tmp_path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    rig = Rig(latch=Latch(tmp_path / "elsewhere" / "stop.json"))
    with pytest.raises(SafetyTrip, match="emergency stop: smoke"), rig.safe:
        rig.safe._latch = Latch(tmp_path / "file" / "stop.json")
        assert rig.safe.emergency_stop("smoke")
        rig.safe._latch = None
        rig.tick()
    assert rig.fake.held == 0.0


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
