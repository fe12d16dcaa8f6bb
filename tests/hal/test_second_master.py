"""Another master between our ticks: over real Modbus TCP and a real pseudo-terminal, with stepped time."""

from __future__ import annotations

import pytest

from control.drive import OpenLoopDrive
from control.loop import Hooks, Loop, Progress
from control.plan import Plan
from control.step import Step
from hal.clock import SteppedClock
from hal.errors import SafetyTrip
from hal.modbus_bench import ModbusBench
from hal.profile import Profile, load_profile
from hal.safety import SafeBench
from sim_device.server import VirtualDevice
from tests.control.fakes import Memory
from tests.hal.test_modbus_bench import VIRTUAL, Lag, bench_at, tick, virtual


def test_of_two_programs_at_one_tcp_port_neither_ends_well() -> None:
    """The second comes in the middle of the first one's second between two looks."""
    clock, ended = SteppedClock(), {}
    with VirtualDevice(VIRTUAL, Lag(), clock, tcp="127.0.0.1:0") as device:
        first, second = (ModbusBench(VIRTUAL, device.port, clock, margin_s=1.0) for _ in range(2))
        with first, second:
            for number in range(100):
                clock.sleep_until(0.05 * number)
                bench, command = (second, 4.0) if number % 2 else (first, 9.0)
                if bench in ended or (bench is second and number < 31):
                    continue
                try:
                    bench.exchange(command)
                except SafetyTrip as trip:
                    ended[bench] = (clock.now_s(), str(trip))
                    bench.vent()
        assert device.rig.command == 0.0
    assert set(ended) == {first, second}
    assert all(time_s < 4.2 and "does somebody else command it" in said for time_s, said in ended.values())


def test_a_rarer_command_of_somebody_else_is_recorded_and_ends_the_run_too() -> None:
    """One command of somebody else every 2 s, against ten a second of ours."""
    memory = Memory()
    with virtual() as (device, clock):
        done: set[int] = set()

        def interfere(_: Progress) -> None:
            second = int(clock.now_s())
            if second % 2 == 0 and second not in done:
                done.add(second)
                device.rig.request_command(4.0)

        with SafeBench(bench_at(device, clock), VIRTUAL.limits, clock) as bench:
            loop = Loop(bench, clock, (memory,), Hooks(progress=interfere))
            with pytest.raises(SafetyTrip, match="does somebody else command it"):
                loop.run(Plan(0.1, (Step(9.0, 9.0, 60.0),)), OpenLoopDrive())
    assert str(memory.events).count("the device held 4 psi, not what it was sent") == 2


def test_a_look_a_second_is_one_read_and_a_single_command_of_somebody_else_stops_nothing() -> None:
    with virtual() as (device, clock), bench_at(device, clock) as bench:
        bench.arm()
        before = bench.bus.stats.transactions
        for _ in range(100):
            assert tick(bench, clock, 5.0).foreign_psi is None
        assert bench.bus.stats.transactions - before == pytest.approx(110, abs=1)
        clock.sleep_until(clock.now_s() + 1.0)  # a look is due
        device.rig.request_command(7.0)
        assert tick(bench, clock, 5.0).foreign_psi == 7.0
        assert all(tick(bench, clock, 5.0).foreign_psi is None for _ in range(150))


@pytest.mark.parametrize("emergency", [False, True])
@pytest.mark.parametrize("name", ["virtual", "icpdas"])
def test_a_device_that_has_taken_over_is_not_taken_for_another_master(name, emergency) -> None:
    """The status of the second one is a coil that no tick reads."""
    profile: Profile = load_profile(name)
    with virtual(profile) as (device, clock), bench_at(device, clock, profile) as bench:
        tick(bench, clock, 9.0, dt_s=1.5)
        if emergency:
            device.rig.emergency()
        else:
            clock.sleep_until(clock.now_s() + 10.0)
        with pytest.raises(SafetyTrip, match="has put its output to the safe value"):
            tick(bench, clock, 9.0)
        bench._watchdog.clear()


def test_our_own_safe_command_is_not_somebody_elses() -> None:
    with virtual() as (device, clock), bench_at(device, clock) as bench:
        for _ in range(30):
            assert tick(bench, clock, 9.0).foreign_psi is None
        assert bench.vent()
        for _ in range(30):
            assert tick(bench, clock, 9.0, dt_s=1.1).foreign_psi is None
        device.rig.request_command(4.0)
        assert tick(bench, clock, 9.0).foreign_psi == pytest.approx(4.0)


@pytest.mark.parametrize(("period_s", "looks"), [(0.1, 5), (0.02, 5), (0.01, 0)])
def test_ticks_that_leave_no_room_are_not_made_late_by_a_look(period_s: float, looks: int) -> None:
    """At 115200 baud a tick and a look take 9.9 ms."""
    fast = VIRTUAL.model_copy(update={"serial": VIRTUAL.serial.model_copy(update={"baud": 115200})})
    with virtual(fast) as (device, clock), ModbusBench(fast, device.port, clock, pacing="spec", margin_s=1.0) as bench:
        bench.arm()
        before, ticks = bench.bus.stats.transactions, round(5.0 / period_s)
        for _ in range(ticks):
            tick(bench, clock, 5.0, dt_s=period_s)
        assert bench.bus.stats.transactions - before == pytest.approx(ticks + looks, abs=1)
