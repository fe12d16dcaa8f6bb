"""A bench in a TOML file: line, devices, registers, limits, calibration; checked when read, fixed afterwards."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from hal.calibration import Calibration
from hal.device import Device
from hal.errors import BadInput
from hal.profile_checks import (
    check_channels,
    check_command,
    check_pressure,
    check_registers,
    check_travel,
    check_watchdogs,
)
from hal.profile_words import not_finite, sentence
from hal.register import NO_BOOL, Part, Register, Verified
from hal.toml_file import read_toml

FOLDER = Path(__file__).parent / "profiles"


class Serial(Part):
    """The line. `pacing = "none"` leaves out the silence before each frame, for lines that have no bits (pty, TCP)."""

    baud: Annotated[int, Field(ge=300, le=4_000_000)] = 19200
    parity: Literal["N", "E", "O"] = "N"
    stop_bits: Annotated[Literal[1, 2], NO_BOOL] = 1
    pacing: Literal["spec", "none"] = "spec"
    backend: Literal["native", "pymodbus"] = "native"

    @property
    def char_s(self) -> float:
        """The time of one character [s]: start, 8 data, parity and stop bits."""
        return (9 + (self.parity != "N") + self.stop_bits) / self.baud

    @property
    def silence_s(self) -> float:
        """t3.5 [s]. Source: Modbus over serial line V1.02, section 2.5.1.1: fixed at 1.75 ms above 19200 baud."""
        return 3.5 * self.char_s if self.baud <= 19200 else 0.00175


class Limits(Part):
    """What the safety layer holds the bench to. `slew_per_s` in command units; None: as fast as it is commanded."""

    command_min: float
    command_max: float
    slew_per_s: Annotated[float, Field(gt=0)] | None = None
    position_min_in: float | None = None
    position_max_in: float | None = None
    pressure_max_psi: float | None = None
    max_missing: Annotated[int, Field(ge=1)] = 5  # consecutive ticks without a trusted reading
    max_age_s: Annotated[float, Field(gt=0)] = 1.0  # age of the last good reading

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.command_min >= self.command_max:
            raise ValueError(f"command_min {self.command_min:g} must be below command_max {self.command_max:g}")
        low, high = self.position_min_in, self.position_max_in
        if low is not None and high is not None and low >= high:
            raise ValueError(f"position_min_in {low:g} must be below position_max_in {high:g}")
        return self


class Signals(Part):
    """The registers of a tick. `sequence` counts the device's samples; `aux` holds further channels by name."""

    command: Register
    position: Register
    pressure: Register | None = None
    readback: Register | None = None
    sequence: Register | None = None
    aux: dict[str, Register] = Field(default_factory=dict)

    def named(self) -> dict[str, Register]:
        """Every signal of the profile by name, the command included."""
        fixed = {
            "command": self.command,
            "readback": self.readback,
            "sequence": self.sequence,
            "pressure": self.pressure,
            "position": self.position,
        }
        return {name: register for name, register in fixed.items() if register is not None} | self.aux


class Profile(Part):
    """Everything the HAL knows of one bench. `safe_direction`: at the end the valve is vented, or held where it is."""

    name: Annotated[str, Field(pattern=r"\S")]
    title: str = ""
    verified: Verified = "unverified"
    source: str = ""
    travel_in: Annotated[float, Field(gt=0)]
    safe_direction: Literal["vent", "hold"] = "vent"
    safe_command: float = 0.0
    readback_tolerance: Annotated[float, Field(ge=0)] | None = None  # None: two counts of the command register
    serial: Serial = Serial()
    limits: Limits
    devices: Annotated[dict[str, Device], Field(min_length=1, max_length=2)]
    signals: Signals
    calibration: Calibration | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_registers(self)
        ids = [device.id for device in self.devices.values()]
        if len(set(ids)) != len(ids):
            raise ValueError(f"devices: unit id {ids[0]} is given twice on one line")
        if not self.limits.command_min <= self.safe_command <= self.limits.command_max:
            raise ValueError(f"safe_command {self.safe_command:g} is outside limits.command_min to command_max")
        if self.calibration is None and self.signals.position.unit != "in":
            raise ValueError(f"signals.position is in '{self.signals.position.unit}': a [calibration] to in is needed")
        if self.signals.pressure is not None and self.signals.pressure.unit != "psi":
            raise ValueError(f"signals.pressure.unit is '{self.signals.pressure.unit}': it must come out in psi")
        check_command(self)
        check_pressure(self)
        check_travel(self)
        check_watchdogs(self)
        check_channels(self)
        return self

    @property
    def in_the_end(self) -> str:
        """What becomes of the valve when a job is over, for an operator: it will ..., then `in_the_end`."""
        return "be left at its last command" if self.safe_direction == "hold" else "go to its safe command"

    def every_register(self) -> dict[str, Register]:
        """Every register by its place in the file, those of the watchdogs included."""
        aux = self.signals.aux
        found = {f"signals.{'aux.' * (name in aux)}{name}": each for name, each in self.signals.named().items()}
        for name, device in self.devices.items():
            for key in ("timeout", "enable", "status", "safe_value", "emergency"):
                register = getattr(device.watchdog, key, None) if device.watchdog else None
                if register is not None:
                    found[f"devices.{name}.watchdog.{key}"] = self._placed(register, name)
        return found

    def placed(self, register: Register, beside: Register) -> Register:
        """`register` on the device of `beside`, where it does not say so itself."""
        return self._placed(register, self.device_name(beside))

    @staticmethod
    def _placed(register: Register, device: str) -> Register:
        return register if register.device else register.model_copy(update={"device": device})

    def device_name(self, register: Register) -> str:
        """The name of the device that has this register."""
        return register.device or next(iter(self.devices))

    def device_of(self, register: Register) -> Device:
        return self.devices[self.device_name(register)]

    def wire_address(self, register: Register) -> int:
        """The address as it goes over the wire, counted from 0."""
        return register.address - self.device_of(register).address_base

    def table_of(self, register: Register) -> Literal["holding", "input", "coil"]:
        """Which of the device's tables holds this register."""
        if register.table is not None:
            return register.table
        return "holding" if self.device_of(register).read_fc == 3 else "input"

    def paced(self, pacing: str) -> Self:
        """The same bench with another pacing of its line."""
        return self.model_copy(update={"serial": self.serial.model_copy(update={"pacing": pacing})})

    @property
    def command_unit(self) -> str:
        return self.signals.command.unit or "psi"

    def position_in(self, signal: float) -> float:
        """Inches from the scaled position register: through the calibration where there is one."""
        return signal if self.calibration is None else self.calibration.to_in(signal)

    def position_signal(self, position_in: float) -> float:
        """The scaled position register that means `position_in`; the inverse of `position_in`."""
        return position_in if self.calibration is None else self.calibration.to_signal(position_in)


def profile_names() -> list[str]:
    """The profiles that come with the program."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_profile(path_or_name: str | Path) -> Profile:
    """Reads a profile: a name from `hal/profiles`, or the path of a TOML file.

    Raises: `BadInput` naming the file and the key.
    """
    text = str(path_or_name)
    path = Path(text)
    if not text.endswith(".toml") and path.name == text:
        path = FOLDER / f"{text}.toml"
        if not path.is_file():
            raise BadInput(
                f"there is no profile '{text}'; there are {', '.join(profile_names())}, or give a .toml file"
            )
    try:
        content = read_toml(path)
    except OSError as error:
        raise BadInput(f"profile {path} cannot be read: {error.strerror}; give a name or a .toml file") from error
    except tomllib.TOMLDecodeError as error:
        raise BadInput(f"profile {path} is not valid TOML: {error}") from error
    return parse_profile(content, str(path))


def parse_profile(content: dict[str, Any], origin: str) -> Profile:
    """Checks a profile that is already in memory. Raises: `BadInput` naming `origin` and the key."""
    said = not_finite(content)
    if said is not None:
        raise BadInput(f"profile {origin}: {said}")
    try:
        return Profile.model_validate(content)
    except ValidationError as error:
        raise BadInput(f"profile {origin}: {sentence(error.errors(include_url=False))}") from error
