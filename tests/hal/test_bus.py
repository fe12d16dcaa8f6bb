"""The invariant: whatever happens on the wire, an answer that is handed out is the answer to its own request."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest

from hal.bus import RtuBus
from hal.clock import RealClock, SteppedClock
from hal.device import Device, Resync
from hal.errors import DeviceRefused, PortFault, WireFault
from hal.framing import seal
from hal.line import RtuLine
from hal.pdu import read_registers, write_and_read, write_register, write_registers
from hal.profile import Serial
from hal.transport import SerialTransport

SERIAL = Serial(baud=115200, pacing="none")


def make_bus(port: str, device: Device | None = None, margin_s: float = 0.02) -> RtuBus:
    device = device or Device(id=1, turnaround_ms=0)
    line = RtuLine(SerialTransport(port, SERIAL), SERIAL, RealClock(), name="the port")
    return RtuBus(line, (device,), margin_s=margin_s)


@pytest.fixture
def bus(slave) -> Iterator[RtuBus]:
    bus = make_bus(slave.port)
    bus.open()
    yield bus
    bus.close()


@pytest.fixture
def patient(slave) -> Iterator[RtuBus]:
    """For tests in which nothing times out: a busy machine must not make them fail."""
    bus = make_bus(slave.port, margin_s=2.0)
    bus.open()
    yield bus
    bus.close()


def warm(bus: RtuBus) -> None:
    """One good read: the line's echo is known and the unit is trusted."""
    assert bus.transact(read_registers(1, 3, 7, 1), retries=5).words == (7,)


def outcomes(bus: RtuBus, count: int, rng: random.Random) -> tuple[int, int, int]:
    """(right, raised, silently wrong) of reads at random addresses."""
    right = raised = wrong = 0
    for _ in range(count):
        address, size = rng.randrange(0, 60000), rng.choice((1, 2, 4))
        try:
            words = bus.transact(read_registers(1, 3, address, size)).words
        except (WireFault, DeviceRefused):
            raised += 1
            continue
        if words == tuple(range(address, address + size)):
            right += 1
        else:
            wrong += 1
    return right, raised, wrong


def test_reads_and_writes_on_a_clean_line(slave, patient) -> None:
    bus = patient
    assert bus.transact(read_registers(1, 3, 100, 3)).words == (100, 101, 102)
    assert bus.transact(read_registers(1, 4, 5, 1)).words == (5,)
    assert bus.transact(write_and_read(1, 0, (1, 2), 40, 2)).words == (40, 41)
    assert bus.transact(write_registers(1, 9, (4, 5))).pdu == bytes.fromhex("10 0009 0002")
    assert bus.transact(write_register(1, 9, 4)).pdu == bytes.fromhex("06 0009 0004")
    assert bus.stats.timeouts == bus.stats.noise_bytes == 0


@pytest.mark.parametrize("late_by", [1, 2, 3])
def test_a_late_answer_is_never_the_next_one(slave, bus, late_by) -> None:
    warm(bus)
    first = len(slave.requests)
    slave.script = lambda i, f: ("late", late_by) if i == first else ("ok",)
    with pytest.raises(WireFault, match="no answer within"):
        bus.transact(read_registers(1, 3, 1000, 2))
    assert bus.transact(read_registers(1, 3, 2000, 2), retries=5).words == (2000, 2001)
    assert bus.stats.resyncs == 2


def test_a_device_that_is_always_late_gives_errors_and_nothing_else(slave, bus) -> None:
    warm(bus)
    slave.script = lambda i, f: ("late", 1)
    _, raised, wrong = outcomes(bus, 12, random.Random(1))
    assert wrong == 0
    assert raised >= 11


def test_a_stray_answer_between_two_requests_is_not_believed(slave, bus) -> None:
    warm(bus)
    slave.say(seal(1, bytes.fromhex("03 02 BEEF")))
    assert bus.transact(read_registers(1, 3, 77, 1)).words == (77,)
    assert bus.stats.noise_bytes == 7


def test_two_answers_to_one_request_cost_trust(slave, bus) -> None:
    warm(bus)
    probes = bus.stats.probes
    first = len(slave.requests)
    slave.script = lambda i, f: ("after", seal(1, bytes.fromhex("03 02 BEEF"))) if i == first else ("ok",)
    assert bus.transact(read_registers(1, 3, 77, 1)).words == (77,)
    assert bus.transact(read_registers(1, 3, 78, 1)).words == (78,)
    assert bus.stats.probes == probes + 1


@pytest.mark.parametrize("noise", [b"\x00", b"\xff\xff", b"\x01\x03\x04", bytes(range(40)), b"\x01" * 9])
def test_noise_before_an_answer_costs_nothing(slave, bus, noise) -> None:
    warm(bus)
    slave.script = lambda i, f: ("noise", noise)
    assert bus.transact(read_registers(1, 3, 55, 2)).words == (55, 56)
    assert bus.stats.timeouts == 0
    assert bus.stats.noise_bytes >= len(noise)


@pytest.mark.parametrize(
    ("what", "raw"),
    [
        ("another unit", seal(2, bytes.fromhex("03 04 0037 0038"))),
        ("another function", seal(1, bytes.fromhex("04 04 0037 0038"))),
        ("too few registers", seal(1, bytes.fromhex("03 02 0037"))),
        ("too many registers", seal(1, bytes.fromhex("03 06 0037 0038 0039"))),
        ("a wrong checksum", seal(1, bytes.fromhex("03 04 0037 0038"))[:-1] + b"\x00"),
        ("an exception to another function", seal(1, bytes.fromhex("84 02"))),
        ("an exception that does not exist", seal(1, bytes.fromhex("83 63"))),
    ],
)
def test_an_intact_frame_that_is_no_answer_is_refused(slave, bus, what, raw) -> None:
    warm(bus)
    slave.script = lambda i, f: ("raw", raw)
    with pytest.raises(WireFault) as caught:
        bus.transact(read_registers(1, 3, 0x37, 2))
    assert caught.value.received == raw
    assert "unit 1 on the port" in str(caught.value)


def test_an_exception_is_raised_with_function_and_code(slave, bus) -> None:
    warm(bus)
    slave.reply = lambda f: seal(1, bytes((f[1] | 0x80, 2)))
    with pytest.raises(DeviceRefused, match=r"refused function 3: exception 2 \(illegal data address\)") as caught:
        bus.transact(read_registers(1, 3, 0, 1))
    assert (caught.value.function, caught.value.code) == (3, 2)
    assert bus.stats.exceptions == 1


def test_a_late_exception_is_not_taken_for_the_next_answer(slave, bus) -> None:
    warm(bus)
    first = len(slave.requests)
    refusal = seal(1, bytes.fromhex("83 02"))
    slave.reply = lambda f: refusal if f[2:4] == b"\x03\xe8" else _answer(f)
    slave.script = lambda i, f: ("late", 1) if i == first else ("ok",)
    with pytest.raises(WireFault):
        bus.transact(read_registers(1, 3, 1000, 1))
    assert bus.transact(read_registers(1, 3, 7, 1), retries=5).words == (7,)


def _answer(frame: bytes) -> bytes:
    return seal(1, bytes((3, 2)) + frame[2:4]) if frame[1] == 3 else frame


def test_local_echo_is_found_and_cut_off(slave) -> None:
    slave.script = lambda i, f: ("echo",)
    bus = make_bus(slave.port)
    bus.open()
    assert bus.transact(read_registers(1, 3, 300, 2)).words == (300, 301)
    assert bus.transact(write_register(1, 9, 4)).pdu == bytes.fromhex("06 0009 0004")
    # Only our own voice: a dead device on a line with echo must not confirm a write.
    slave.script = lambda i, f: ("raw", f)
    with pytest.raises(WireFault, match="no answer but the line's own echo"):
        bus.transact(write_register(1, 9, 4))
    bus.close()


def test_a_dead_device_on_an_echoing_line_is_never_trusted(slave) -> None:
    slave.script = lambda i, f: ("raw", f)
    bus = make_bus(slave.port)
    bus.open()
    for _ in range(3):
        with pytest.raises(WireFault):
            bus.transact(write_register(1, 9, 4))
    assert bus.stats.transactions == 0
    bus.close()


def test_a_device_without_echo_test_is_trusted_again_after_its_refusal(slave, bus) -> None:
    slave.reply = lambda f: seal(1, bytes.fromhex("88 01")) if f[1] == 8 else _answer(f)
    warm(bus)
    slave.script = lambda i, f: ("late", 1) if f[2:4] == b"\x10\x00" else ("ok",)
    with pytest.raises(WireFault):
        bus.transact(read_registers(1, 3, 0x1000, 1))
    slave.script = lambda i, f: ("ok",)
    assert bus.transact(read_registers(1, 3, 8, 1), retries=8).words == (8,)


def test_resync_by_a_read_of_unusual_length(slave) -> None:
    device = Device(id=1, turnaround_ms=0, resync=Resync(method="read", address=500, count=20))
    bus = make_bus(slave.port, device)
    bus.open()
    warm(bus)
    first = len(slave.requests)
    slave.script = lambda i, f: ("late", 2) if i == first else ("ok",)
    with pytest.raises(WireFault):
        bus.transact(read_registers(1, 3, 1000, 2))
    assert bus.transact(read_registers(1, 3, 2000, 2), retries=8).words == (2000, 2001)
    lengths = [f[5] for f in slave.requests if f[2:4] == b"\x01\xf4"]
    assert 2 not in lengths, "the probe's length must be one that is not read in earnest"
    assert all(f[1] == 3 for f in slave.requests)
    bus.close()


@pytest.mark.parametrize("method", ["echo", "read"])
def test_a_storm_of_faults_gives_nothing_wrong(slave, method) -> None:
    rng = random.Random(20)

    def storm(index: int, frame: bytes) -> tuple[object, ...]:
        dice = rng.random()
        if dice < 0.05:
            return ("late", rng.choice((1, 1, 2, 3)))
        if dice < 0.10:
            return ("noise", rng.randbytes(rng.randint(1, 12)))
        if dice < 0.13:
            return ("flip", rng.randrange(1000))
        if dice < 0.15:
            return ("drop",)
        if dice < 0.18:
            return ("truncate", rng.randint(1, 6))
        return ("after", rng.randbytes(2)) if dice < 0.20 else ("ok",)

    slave.script = storm
    device = Device(id=1, turnaround_ms=0, resync=Resync(method=method, address=100, count=40))
    bus = make_bus(slave.port, device, margin_s=0.006)
    bus.open()
    right, raised, wrong = outcomes(bus, 700, random.Random(3))
    bus.close()
    assert wrong == 0
    assert right > 400, f"the line must be usable all the same ({right} right, {raised} raised)"


def test_unplugging_is_noticed(slave, bus) -> None:
    warm(bus)
    slave.hang_up()
    with pytest.raises(PortFault, match="is gone"):
        bus.transact(read_registers(1, 3, 0, 1))


def test_stamps_come_from_the_bench_clock(slave) -> None:
    clock = SteppedClock(42.0)
    line = RtuLine(SerialTransport(slave.port, SERIAL), SERIAL, clock)
    bus = RtuBus(line, (Device(id=1, turnaround_ms=0),), margin_s=0.5)
    bus.open()
    reply = bus.transact(read_registers(1, 3, 0, 1))
    assert (reply.midpoint_s, reply.latency_s) == (42.0, 0.0)
    bus.close()


def test_retries_are_counted_and_bounded(slave, bus) -> None:
    warm(bus)
    before = len(slave.requests)
    slave.script = lambda i, f: ("drop",)
    with pytest.raises(WireFault):
        bus.transact(read_registers(1, 3, 0, 1), retries=2)
    assert bus.stats.retries == 2
    assert len(slave.requests) - before == 3  # the request once, then one probe for each retry
