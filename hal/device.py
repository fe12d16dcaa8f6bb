"""One Modbus unit on the line: its number, its manners, who it is, and what it does when nobody talks to it."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from hal.register import AS_LIST, NO_BOOL, Part, Register, Verified
from hal.words import WordOrder

OBJECT_NAMES = {
    "vendor_name": 0,
    "product_code": 1,
    "revision": 2,
    "url": 3,
    "product_name": 4,
    "model_name": 5,
    "application_name": 6,
}


class Identity(Part):
    """How to make sure that the device is the right one: objects of function 43/14, or constant registers, or both."""

    objects: dict[str, str] = Field(default_factory=dict)
    address: Annotated[int, Field(ge=0)] | None = None  # as the manual prints it
    expect: Annotated[tuple[Annotated[int, Field(ge=0, le=65535)], ...], AS_LIST] = ()
    source: str = ""
    verified: Verified = "unverified"

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in self.objects:
            if name not in OBJECT_NAMES:
                raise ValueError(f"unknown identification object '{name}'; there are {', '.join(OBJECT_NAMES)}")
        if (self.address is None) != (not self.expect):
            raise ValueError("address and expect belong together: give both or neither")
        return self


class Resync(Part):
    """A question that nothing else on the line is answered like, to find out whether late answers are still about.

    `echo` is function 8 with a nonce. `read` reads `count` registers at `address`, a length no cyclic request uses.
    """

    method: Literal["echo", "read"] = "echo"
    address: Annotated[int, Field(ge=0)] = 0
    count: Annotated[int, Field(ge=1, le=125)] = 1


class Watchdog(Part):
    """The device's own dead man's handle: without traffic for `timeout_s` it puts out its safe value.

    From then on it ignores commands until `status` has been cleared by writing `clear` to it. Writing 1 to `emergency`
    does the same at once. Registers that a device does not have are left out.
    Source of the semantics: ICP DAS I-7021/22/24 manual, host watchdog.
    """

    timeout_s: Annotated[float, Field(gt=0)] = 2.0
    timeout: Register | None = None  # in seconds, through raw and eng; 0 switches the watchdog off
    enable: Register | None = None  # 1 on, 0 off, where that is a register or coil of its own
    status: Register | None = None  # not 0: timed out
    clear: Annotated[int, Field(ge=0, le=65535)] = 1
    safe_value: Register | None = None  # in the unit of the command
    emergency: Register | None = None


class Device(Part):
    """A unit id and how that unit wants to be spoken to. `turnaround_ms` is its own thinking time, measured."""

    id: Annotated[int, Field(ge=1, le=247)]
    title: str = ""
    fc23: bool = False
    read_fc: Literal[3, 4] = 3
    write_fc: Literal[6, 16] = 16
    address_base: Annotated[Literal[0, 1], NO_BOOL] = 0
    word_order: WordOrder = "ABCD"
    turnaround_ms: Annotated[float, Field(ge=0, le=1000)] = 5.0
    max_read: Annotated[int, Field(ge=1, le=125)] = 125
    read_gap: Annotated[int, Field(ge=0, le=100)] = 0  # unused registers a read may run over; most devices refuse any
    identity: Identity | None = None
    resync: Resync = Resync()
    watchdog: Watchdog | None = None
    source: str = ""
    verified: Verified = "unverified"
