"""Is this the device that the profile describes? Asked before anything is written."""

from __future__ import annotations

from hal.device import OBJECT_NAMES, Device
from hal.errors import BenchFault, DeviceRefused
from hal.pdu import identify, objects_of, read_registers
from hal.reply import Bus

_NAMES = {number: name for name, number in OBJECT_NAMES.items()}


def read_objects(bus: Bus, unit: int, access: int = 2) -> dict[str, str]:
    """The identification objects of function 43/14 by name. Raises: `DeviceRefused`, `WireFault`."""
    found: dict[int, str] = {}
    following: int | None = 0
    while following is not None:
        part, after = objects_of(bus.transact(identify(unit, access, following), retries=1).pdu)
        found |= part
        following = after if after is not None and after > following else None
    return {_NAMES.get(number, f"object_{number}"): text for number, text in sorted(found.items())}


def check_identity(bus: Bus, device: Device, port: str) -> dict[str, str]:
    """What the device says of itself, after comparing it with the profile.

    Raises: `BenchFault` when it is another device, or does not say.
    """
    expected = device.identity
    if expected is None:
        return {}
    unit = f"unit {device.id} on {port}"
    said: dict[str, str] = {}
    if expected.objects:
        try:
            said = read_objects(bus, device.id)
        except DeviceRefused as error:
            raise BenchFault(f"{unit} does not tell who it is (function 43), but its profile says it does") from error
    for name, text in expected.objects.items():
        if said.get(name) != text:
            raise BenchFault(f"{unit} is not the device of the profile: {name} is '{said.get(name)}', not '{text}'")
    if expected.address is not None:
        address = expected.address - device.address_base
        request = read_registers(device.id, device.read_fc, address, len(expected.expect))
        words = bus.transact(request, retries=1).words
        said[f"register_{expected.address}"] = " ".join(f"{word:#06x}" for word in words)
        if words != expected.expect:
            raise BenchFault(
                f"{unit} is not the device of the profile: register {expected.address} holds {list(words)}, "
                f"not {list(expected.expect)}"
            )
    return said
