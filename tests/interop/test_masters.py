"""Masters that nobody here wrote read and write the virtual device."""

from __future__ import annotations

from collections.abc import Iterator

import minimalmodbus
import pytest
from pymodbus import FramerType
from pymodbus.client import ModbusSerialClient, ModbusTcpClient

from hal.clock import SteppedClock
from hal.profile import load_profile
from sim_device.server import VirtualDevice
from sim_device.valve import Outputs


class Follower:
    """A valve whose pressure is its command."""

    def advance(self, to_time_s: float, command: float) -> Outputs:
        return Outputs(command, 0.25, 80.0, 21.5)


@pytest.fixture(params=[None, "tcp://127.0.0.1:0", "rtu+tcp://127.0.0.1:0"], ids=["pty", "tcp", "rtu+tcp"])
def device(request: pytest.FixtureRequest) -> Iterator[VirtualDevice]:
    with VirtualDevice(load_profile("virtual"), Follower(), SteppedClock(), tcp=request.param) as device:
        yield device


@pytest.fixture
def pymodbus(device: VirtualDevice) -> Iterator[ModbusSerialClient | ModbusTcpClient]:
    client: ModbusSerialClient | ModbusTcpClient
    if device.port.startswith("/"):
        client = ModbusSerialClient(device.port, baudrate=115200, timeout=2, retries=0)
    else:
        scheme, _, place = device.port.partition("://")
        framer = FramerType.RTU if scheme == "rtu+tcp" else FramerType.SOCKET
        host, _, port = place.partition(":")
        client = ModbusTcpClient(host, port=int(port), framer=framer, timeout=2, retries=0)
    assert client.connect()
    yield client
    client.close()


def as_float(client: ModbusSerialClient | ModbusTcpClient, registers: list[int]) -> object:
    return client.convert_from_registers(registers, client.DATATYPE.FLOAT32)


def test_pymodbus_writes_reads_and_does_both_at_once(pymodbus) -> None:  # type: ignore[no-untyped-def]
    words = pymodbus.convert_to_registers(7.25, pymodbus.DATATYPE.FLOAT32)
    assert not pymodbus.write_registers(0, words, device_id=1).isError()
    assert as_float(pymodbus, pymodbus.read_holding_registers(16, count=2, device_id=1).registers) == 7.25
    assert as_float(pymodbus, pymodbus.read_input_registers(20, count=2, device_id=1).registers) == 7.25
    words = pymodbus.convert_to_registers(3.5, pymodbus.DATATYPE.FLOAT32)
    both = pymodbus.readwrite_registers(read_address=16, read_count=9, write_address=0, values=words, device_id=1)
    assert as_float(pymodbus, both.registers[4:6]) == 3.5


def test_pymodbus_understands_refusals_identity_and_diagnosis(pymodbus) -> None:  # type: ignore[no-untyped-def]
    assert pymodbus.read_holding_registers(500, count=1, device_id=1).exception_code == 2
    assert pymodbus.write_register(16, 1, device_id=1).exception_code == 2
    assert pymodbus.read_coils(0, count=1, device_id=1).exception_code == 1
    assert pymodbus.read_device_information(device_id=1).information[1] == b"LM-VALVE"
    assert pymodbus.diag_query_data(b"\xa5\x37", device_id=1).message == b"\xa5\x37"
    assert pymodbus.mask_write_register(address=32, and_mask=0xFF00, or_mask=0x0014, device_id=1).registers == []
    assert pymodbus.read_holding_registers(32, count=1, device_id=1).registers == [0x0014]


@pytest.fixture
def instrument() -> Iterator[minimalmodbus.Instrument]:
    with VirtualDevice(load_profile("virtual"), Follower(), SteppedClock()) as device:
        instrument = minimalmodbus.Instrument(device.port, 1)
        instrument.serial.baudrate, instrument.serial.timeout = 115200, 0.3
        yield instrument
        instrument.serial.close()


def test_minimalmodbus_writes_and_reads(instrument) -> None:  # type: ignore[no-untyped-def]
    instrument.write_float(0, 7.25)
    assert instrument.read_float(16) == 7.25
    assert instrument.read_float(20, functioncode=4) == 7.25
    instrument.write_register(32, 20, functioncode=6)
    assert instrument.read_register(32) == 20


def test_minimalmodbus_understands_refusals(instrument) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(minimalmodbus.IllegalRequestError, match="data address"):
        instrument.read_register(500)
    with pytest.raises(minimalmodbus.IllegalRequestError, match="data value"):
        instrument.write_float(0, 100.0)
