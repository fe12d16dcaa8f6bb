"""The bench over real frames on a real pseudo-terminal: the virtual device, and a slave that misbehaves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from hal.bench import Bench
from hal.clock import SteppedClock
from hal.errors import BadInput, BenchFault, DeviceRefused, PortFault, SafetyTrip, WireFault
from hal.fake import FirstOrder
from hal.framing import seal
from hal.modbus_bench import ModbusBench
from hal.profile import Profile, load_profile, profile_names
from hal.safety import SafeBench
from hal.sample import Quality
from hal.tick import TickPlan
from sim_device.device import Options
from sim_device.server import VirtualDevice
from sim_device.valve import Outputs

VIRTUAL = load_profile("virtual")


class Lag:
    """A first-order valve behind the virtual device."""

    def __init__(self) -> None:
        self.valve = FirstOrder()

    def advance(self, to_time_s: float, command: float) -> Outputs:
        pressure, position = self.valve(to_time_s, command)
        return Outputs(pressure, position, 60.0, 21.5)


@contextmanager
def virtual(profile: Profile = VIRTUAL, **options) -> Iterator[tuple[VirtualDevice, SteppedClock]]:
    clock = SteppedClock()
    with VirtualDevice(profile, Lag(), clock, options=Options(**options)) as device:
        yield device, clock


def bench_at(device, clock, profile: Profile = VIRTUAL, **more) -> ModbusBench:
    return ModbusBench(profile, device.port, clock, pacing="none", **{"margin_s": 1.0} | more)


def tick(bench: Bench, clock: SteppedClock, command: float, dt_s: float = 0.1):
    sample = bench.exchange(command)
    clock.sleep_until(clock.now_s() + dt_s)
    return sample


@pytest.mark.parametrize("backend", ["native", "pymodbus"])
def test_one_transaction_a_tick_brings_everything(backend) -> None:
    profile = VIRTUAL.model_copy(update={"serial": VIRTUAL.serial.model_copy(update={"backend": backend})})
    with virtual() as (device, clock), bench_at(device, clock, profile) as bench:
        bench.arm()
        before = bench.bus.stats.transactions
        for _ in range(30):
            sample = tick(bench, clock, 8.0)
        looks = 3  # one a second: does somebody else command it?
        assert bench.bus.stats.transactions - before == 30 + looks
        assert sample.commanded_psi == sample.readback_psi == 8.0
        assert sample.pressure is not None
        assert sample.pressure.value == pytest.approx(8.0, abs=1e-3)
        assert sample.position.value == pytest.approx(0.225, abs=2e-4)
        assert sample.aux["supply_psi"].value == pytest.approx(60.0, abs=2e-3)
        assert sample.aux["temperature_c"].value == pytest.approx(21.5, abs=6e-3)
        assert sample.position.quality is Quality.GOOD
        assert sample.time_s == pytest.approx(2.9)
        assert bench.info.identity["product_code"] == "LM-VALVE"


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_works_with_the_device_that_is_emulated_from_it(name) -> None:
    profile = load_profile(name)
    with virtual(profile) as (device, clock), bench_at(device, clock, profile) as bench:
        command = min(9.0, profile.limits.command_max)
        for _ in range(30):
            sample = tick(bench, clock, command)
        step = profile.signals.command.resolution()
        assert sample.commanded_psi == pytest.approx(command, abs=step + 1e-6)
        assert sample.position.value == pytest.approx(0.5625 * sample.commanded_psi / 20.0, abs=1e-3)
        assert bench.bus.stats.timeouts == bench.bus.stats.exceptions == 0
    assert device.rig.command == pytest.approx(profile.safe_command, abs=1e-6)


def test_leaving_sends_the_safe_command_and_lets_the_watchdog_go() -> None:
    with virtual() as (device, clock):
        with bench_at(device, clock) as bench:
            tick(bench, clock, 12.0)
            assert device.rig.command == 12.0
        assert device.rig.command == 0.0
        clock.sleep_until(1000.0)
        with bench_at(device, clock) as bench:  # would be refused if the watchdog had run out
            tick(bench, clock, 3.0)


def test_the_devices_watchdog_vents_and_a_person_has_to_acknowledge() -> None:
    with virtual() as (device, clock):
        with pytest.raises(SafetyTrip, match="put its output to the safe value"), bench_at(device, clock) as bench:
            tick(bench, clock, 12.0, dt_s=2.5)  # longer than the watchdog's 2 s
            tick(bench, clock, 12.0)
        assert device.rig.command == 0.0
        with pytest.raises(SafetyTrip, match="lostmotion set --acknowledge"):
            bench_at(device, clock).__enter__()
        with bench_at(device, clock, acknowledge=True) as bench:
            assert tick(bench, clock, 5.0).readback_psi == 5.0


def test_the_device_waits_for_nobody_before_the_first_command_and_after_the_last() -> None:
    with virtual() as (device, clock), SafeBench(bench_at(device, clock), VIRTUAL.limits, clock) as bench:
        clock.sleep_until(clock.now_s() + 60.0)  # opening a record and a view may take long
        bench.arm(0.1)
        assert device.rig.watchdog.timeout_s == 2.0
        tick(bench, clock, 12.0)
        assert bench.make_safe("normal end")
        clock.sleep_until(clock.now_s() + 60.0)  # so may closing them
        assert tick(bench, clock, 5.0).readback_psi == 5.0
        assert device.rig.watchdog.timeout_s == 2.0, "the next command has armed it again"


def test_acknowledging_ends_the_watch_that_somebody_else_has_left_on() -> None:
    with virtual() as (device, clock):
        with pytest.raises(SafetyTrip), bench_at(device, clock) as bench:
            tick(bench, clock, 12.0, dt_s=2.5)
            tick(bench, clock, 12.0)
        device.rig.watchdog.timeout_s = 2.0
        with bench_at(device, clock, acknowledge=True) as bench:
            clock.sleep_until(clock.now_s() + 60.0)
            assert tick(bench, clock, 5.0).readback_psi == 5.0


def test_an_emergency_stop_makes_the_device_deaf_to_commands() -> None:
    with virtual() as (device, clock), pytest.raises(SafetyTrip), bench_at(device, clock) as bench:
        tick(bench, clock, 12.0)
        assert bench.emergency_stop()
        assert device.rig.command == 0.0
        tick(bench, clock, 12.0)


def test_reading_only_never_writes() -> None:
    with virtual() as (device, clock):
        device.rig.request_command(6.0)
        with bench_at(device, clock, read_only=True) as bench:
            assert bench.observe().commanded_psi == 6.0
            with pytest.raises(BadInput, match="reading only"):
                bench.exchange(1.0)
        assert device.rig.command == 6.0, "not even on leaving"
        assert device.rig.watchdog.timeout_s == 0.0


def test_holding_is_a_safe_direction_too_and_venting_is_still_possible() -> None:
    profile = VIRTUAL.model_copy(update={"safe_direction": "hold"})
    with virtual() as (device, clock):
        with bench_at(device, clock, profile) as bench:
            tick(bench, clock, 9.0)
            assert bench.make_safe("test")
        assert device.rig.command == 9.0
        with bench_at(device, clock, profile, read_only=True) as bench:
            assert bench.vent()
        assert device.rig.command == 0.0


def test_a_slow_converter_gives_stale_readings() -> None:
    with virtual(refresh_s=0.25) as (device, clock), bench_at(device, clock) as bench:
        qualities = [tick(bench, clock, 5.0).position.quality for _ in range(10)]
    stale = [bool(q & Quality.STALE) for q in qualities]
    assert sum(stale) == 6  # every 0.25 s a fresh one, ticks every 0.1 s
    assert not stale[0]


def test_no_number_and_no_range_reach_the_wire() -> None:
    with virtual() as (device, clock), bench_at(device, clock) as bench:
        for bad in (math.nan, math.inf):
            with pytest.raises(BadInput, match="is not a number"):
                bench.exchange(bad)
        with pytest.raises(DeviceRefused, match="exception 3"):
            bench.exchange(25.0)


def test_an_unanswered_tick_is_a_sample_with_missing_readings() -> None:
    with virtual() as (device, clock), bench_at(device, clock, margin_s=0.05) as bench:
        tick(bench, clock, 5.0)
        device._line._units.clear()  # the device goes deaf
        sample = tick(bench, clock, 5.0)
        assert sample.position.quality is Quality.MISSING
        assert math.isnan(sample.position.value)
        assert sample.readback_psi is None
        assert not bench.make_safe("test")


def test_the_wrong_device_is_refused_before_anything_is_written() -> None:
    with virtual() as (device, clock):
        identity = VIRTUAL.devices["bench"].identity
        assert identity is not None
        other = identity.model_copy(update={"objects": {"product_code": "OTHER"}})
        bench_device = VIRTUAL.devices["bench"].model_copy(update={"identity": other})
        profile = VIRTUAL.model_copy(update={"devices": {"bench": bench_device}})
        with pytest.raises(BenchFault, match="product_code is 'LM-VALVE', not 'OTHER'"):
            bench_at(device, clock, profile).__enter__()
        assert device.rig.watchdog.timeout_s == 0.0


def test_the_wrong_unit_id_the_wrong_port_and_a_busy_port_are_told_apart(tmp_path) -> None:
    with virtual() as (device, clock):
        unit9 = VIRTUAL.devices["bench"].model_copy(update={"id": 9})
        profile = VIRTUAL.model_copy(update={"devices": {"bench": unit9}})
        with pytest.raises(WireFault, match=r"unit 9 on .* \(115200 8N1\): no answer within .*lostmotion probe"):
            bench_at(device, clock, profile, margin_s=0.02).__enter__()
        with bench_at(device, clock), pytest.raises(PortFault, match="is busy: another program has it open"):
            bench_at(device, clock).__enter__()
    with pytest.raises(PortFault, match="there is no port /dev/ttyNOPE; `lostmotion ports`"):
        ModbusBench(VIRTUAL, "/dev/ttyNOPE", clock).__enter__()
    plain = tmp_path / "file"
    plain.write_text("x", encoding="utf-8")
    with pytest.raises(PortFault, match="is not a serial port"):
        ModbusBench(VIRTUAL, str(plain), clock).__enter__()


def test_a_device_that_answers_garbage_is_named_as_such(slave) -> None:
    slave.script = lambda i, f: ("raw", b"\xf0\x0f\xaa\x55\x00\x12")
    with pytest.raises(WireFault, match=r"6 bytes of garbage \(f0 0f aa 55 00 12\).*check baud, parity"):
        ModbusBench(VIRTUAL, slave.port, SteppedClock(), pacing="none", margin_s=0.02).__enter__()


def test_somebody_else_who_commands_the_valve_is_noticed(monkeypatch) -> None:
    with virtual() as (device, clock), bench_at(device, clock) as bench:
        tick(bench, clock, 5.0)
        written = TickPlan.write_request
        other = bench._plan.command.to_words(6.0, "ABCD")  # what the device holds is not what we sent
        monkeypatch.setattr(TickPlan, "write_request", lambda plan, words: written(plan, other))
        for _ in range(2):
            assert tick(bench, clock, 5.0).readback_psi == 6.0
        with pytest.raises(SafetyTrip, match="was sent 5 psi and holds 6 psi, 3 ticks in a row: does somebody else"):
            tick(bench, clock, 5.0)
        monkeypatch.undo()


def test_a_restarted_device_is_flagged_and_its_watchdog_armed_again() -> None:
    with virtual() as (device, clock), bench_at(device, clock) as bench:
        for _ in range(10):
            tick(bench, clock, 5.0)
        device.rig.sequence = 0
        device.rig.watchdog.timeout_s = 0.0
        sample = tick(bench, clock, 5.0)
        assert sample.position.quality & Quality.RESTARTED
        assert device.rig.watchdog.timeout_s == 2.0


def test_sentinels_saturation_and_implausible_readings_are_marked(slave) -> None:
    """The slave's registers hold their addresses, so a profile can ask for any raw value by its address."""
    content = VIRTUAL.model_dump(exclude_none=True)
    content["devices"]["bench"] |= {"identity": None, "watchdog": None}
    content["signals"]["readback"] = content["signals"]["sequence"] = None
    content["signals"]["aux"] = {
        "sentinel": {"address": 999, "sentinels": (999,)},
        "saturated": {"address": 32767, "type": "i16"},
        "implausible": {"address": 1000, "plausible": (0.0, 999.0), "unit": "psi"},
        "plausible": {"address": 1001, "plausible": (0.0, 1001.0)},
    }
    profile = Profile.model_validate(content)
    with ModbusBench(profile, slave.port, SteppedClock(), pacing="none", margin_s=1.0, read_only=True) as bench:
        aux = bench.observe().aux
    assert math.isnan(aux["sentinel"].value)
    assert aux["sentinel"].quality is Quality.SENTINEL
    assert aux["saturated"].quality is Quality.SATURATED
    assert (aux["implausible"].value, aux["implausible"].quality) == (1000.0, Quality.IMPLAUSIBLE)
    assert aux["plausible"].quality is Quality.GOOD


def test_a_busy_device_is_asked_again_in_the_next_tick(slave) -> None:
    content = VIRTUAL.model_dump(exclude_none=True)
    content["devices"]["bench"] |= {"identity": None, "watchdog": None}
    content["signals"]["readback"] = content["signals"]["sequence"] = None
    profile = Profile.model_validate(content)
    bench = ModbusBench(profile, slave.port, SteppedClock(), pacing="none", margin_s=1.0)
    with bench:
        good = slave.reply
        slave.reply = lambda f: seal(1, bytes((f[1] | 0x80, 6)))
        assert bench.exchange(5.0).position.quality is Quality.MISSING
        slave.reply = lambda f: seal(1, bytes((f[1] | 0x80, 4)))
        with pytest.raises(DeviceRefused, match="device failure"):
            bench.exchange(5.0)
        slave.reply = good
        assert bench.exchange(5.0).position.quality is Quality.GOOD
