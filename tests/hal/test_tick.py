"""Which transactions a tick needs, and how long the wire takes for them."""

from __future__ import annotations

import pytest

from hal.profile import Profile, load_profile
from hal.tick import min_period_s, plan_tick

VIRTUAL = load_profile("virtual")


def with_bench(**more) -> Profile:
    device = VIRTUAL.devices["bench"].model_copy(update=more)
    return VIRTUAL.model_copy(update={"devices": {"bench": device}})


def test_one_transaction_where_the_device_can() -> None:
    plan = plan_tick(VIRTUAL)
    assert plan.joint is not None
    assert (plan.joint.address, plan.joint.count, plan.blocks) == (16, 9, ())
    assert plan.write_request((1, 2)).function == 23
    assert {c.name for c in plan.joint.channels} >= {"position", "pressure", "readback", "sequence", "watchdog_status"}


def test_two_where_it_cannot() -> None:
    plan = plan_tick(with_bench(fc23=False))
    assert plan.joint is None
    assert [block.request().pdu.hex(" ") for block in plan.blocks] == ["03 00 10 00 09"]
    assert plan.write_request((1, 2)).function == 16


def test_holes_are_not_read_over_unless_the_device_allows_it() -> None:
    blind = with_bench(watchdog=None)  # leaves a hole at register 19
    assert [(b.address, b.count) for b in plan_tick(blind).every_block()] == [(16, 3), (20, 5)]
    lenient = with_bench(watchdog=None, read_gap=1)
    assert [(b.address, b.count) for b in plan_tick(lenient).every_block()] == [(16, 9)]


def test_a_block_is_no_longer_than_the_device_reads() -> None:
    plan = plan_tick(with_bench(max_read=4))
    assert all(block.count <= 4 for block in plan.every_block())
    assert {c.name for b in plan.every_block() for c in b.channels} >= {"position", "temperature_c", "readback"}


def test_two_devices_on_one_line_are_asked_one_after_the_other() -> None:
    plan = plan_tick(load_profile("icpdas"))
    assert [(b.device.id, b.function, b.address, b.count) for b in plan.blocks] == [(1, 4, 64, 1), (2, 4, 0, 2)]
    assert plan.write_request((5,)).function == 6
    assert plan.command_address == 32


def test_the_bus_budget_is_the_wire_the_silences_and_the_turnaround_and_a_tenth() -> None:
    # Function 23, 2 words out, 9 in: 17 + 23 characters of 86.8 us, two silences of 1.75 ms, 0.5 ms turnaround.
    ideal_s = 40 * 10 / 115200 + 2 * 0.00175 + 0.0005
    assert min_period_s(plan_tick(VIRTUAL), VIRTUAL) == pytest.approx(ideal_s / 0.9)
    assert min_period_s(plan_tick(VIRTUAL), VIRTUAL) < 0.01, "100 Hz must fit"


def test_without_pacing_only_the_turnaround_counts() -> None:
    profile = VIRTUAL.model_copy(update={"serial": VIRTUAL.serial.model_copy(update={"pacing": "none"})})
    assert min_period_s(plan_tick(profile), profile) == pytest.approx(0.0005 / 0.9)


def test_every_transaction_of_a_tick_counts() -> None:
    split = with_bench(fc23=False)
    ideal_s = (13 + 8 + 8 + 23) * 10 / 115200 + 4 * 0.00175 + 2 * 0.0005
    assert min_period_s(plan_tick(split), split) == pytest.approx(ideal_s / 0.9)
