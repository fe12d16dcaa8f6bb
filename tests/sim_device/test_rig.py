"""Time on the bench: when the sensors are sampled, and who vents when nobody speaks."""

from __future__ import annotations

import pytest

from hal.clock import SteppedClock
from sim_device.rig import EMERGENCY, HEALTHY, TIMED_OUT, Rig


@pytest.fixture
def rig(valve, clock) -> Rig:  # type: ignore[no-untyped-def]
    return Rig(valve, clock, safe_command=0.0)


def ask(rig: Rig, clock: SteppedClock, after_s: float, *, feeds: bool = True) -> None:
    clock.sleep_until(clock.now_s() + after_s)
    rig.heard(feeds_watchdog=feeds)


def test_the_valve_lives_with_the_old_command_until_the_new_one_comes(rig: Rig, valve, clock) -> None:  # type: ignore[no-untyped-def]
    ask(rig, clock, 1.0)
    rig.request_command(9.0)
    ask(rig, clock, 1.0)
    assert valve.told[0] == (100.0, 0.0)
    assert valve.told[-1] == (102.0, 9.0)
    assert (101.0, 0.0) in valve.told
    assert all(command == 0.0 for time_s, command in valve.told if time_s <= 101.0)


def test_without_a_refresh_period_every_request_is_one_conversion(rig: Rig, clock) -> None:  # type: ignore[no-untyped-def]
    rig.request_command(9.0)
    ask(rig, clock, 0.1)
    assert rig.sample() is rig.sample()
    assert rig.sequence == 1
    assert rig.sample().pressure_psi == 9.0
    ask(rig, clock, 0.1)
    rig.sample()
    assert rig.sequence == 2


def test_with_a_refresh_period_a_quick_master_sees_the_same_sample_again(valve, clock) -> None:  # type: ignore[no-untyped-def]
    rig = Rig(valve, clock, safe_command=0.0, refresh_s=0.5)
    rig.request_command(9.0)
    ask(rig, clock, 0.4)
    assert (rig.sequence, rig.sample().pressure_psi) == (0, 0.0)
    ask(rig, clock, 0.1)
    assert (rig.sequence, rig.sample().pressure_psi) == (1, 9.0)
    rig.request_command(3.0)
    ask(rig, clock, 1.1)
    assert (rig.sequence, rig.sample().pressure_psi) == (3, 3.0)
    assert (101.5, 3.0) in valve.told  # sampled when it was due, not when it was asked for


def test_a_silent_master_vents_the_valve_at_the_moment_of_the_timeout(rig: Rig, valve, clock) -> None:  # type: ignore[no-untyped-def]
    rig.watchdog.timeout_s = 2.0
    ask(rig, clock, 0.5)
    rig.request_command(9.0)
    ask(rig, clock, 10.0)
    assert rig.watchdog.status == TIMED_OUT
    assert rig.command == 0.0
    assert valve.told[-2:] == [(102.5, 9.0), (110.5, 0.0)]


@pytest.mark.parametrize(("pause_s", "status"), [(1.999, HEALTHY), (2.0, HEALTHY), (2.001, TIMED_OUT)])
def test_the_watchdog_waits_exactly_its_timeout(rig: Rig, clock, pause_s: float, status: int) -> None:  # type: ignore[no-untyped-def]
    rig.watchdog.timeout_s = 2.0
    ask(rig, clock, 1.0)
    ask(rig, clock, pause_s)
    assert rig.watchdog.status == status


def test_only_traffic_for_the_transducer_feeds_its_watchdog(rig: Rig, clock) -> None:  # type: ignore[no-untyped-def]
    rig.watchdog.timeout_s = 2.0
    for _ in range(3):
        ask(rig, clock, 0.9, feeds=False)
    assert rig.watchdog.status == TIMED_OUT


def test_commands_are_ignored_until_the_status_is_cleared(rig: Rig, clock) -> None:  # type: ignore[no-untyped-def]
    rig.watchdog.timeout_s = 2.0
    ask(rig, clock, 5.0)
    rig.request_command(9.0)
    assert rig.command == 0.0
    rig.clear()
    assert (rig.watchdog.status, rig.command) == (HEALTHY, 0.0)
    rig.request_command(9.0)
    assert rig.command == 9.0
    ask(rig, clock, 1.9)
    assert rig.watchdog.status == HEALTHY


def test_an_emergency_vents_at_once_and_needs_the_same_clearing(rig: Rig, clock) -> None:  # type: ignore[no-untyped-def]
    rig.request_command(9.0)
    rig.emergency()
    rig.request_command(5.0)
    assert (rig.watchdog.status, rig.command) == (EMERGENCY, 0.0)
    ask(rig, clock, 100.0)
    assert rig.watchdog.status == EMERGENCY
    rig.clear()
    rig.request_command(5.0)
    assert rig.command == 5.0


def test_a_watchdog_that_is_off_never_vents(rig: Rig, clock) -> None:  # type: ignore[no-untyped-def]
    rig.request_command(9.0)
    ask(rig, clock, 1e6)
    assert rig.command == 9.0
    rig.watchdog.timeout_s, rig.watchdog.enabled = 2.0, False
    ask(rig, clock, 1e6)
    assert rig.command == 9.0
