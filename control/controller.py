"""What a controller is, and where they come from: one file in `control/controllers` is one controller, found by name.

A controller is a frozen value. Everything it remembers is in its state, everything it knows of the valve is in the
sample; it reads no clock and no time stamp, so replaying the readings of a record reproduces every command bit by bit.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from importlib import import_module
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from control.design import DesignModel
from hal.errors import BadInput
from hal.sample import Quality, Reading, Sample

S = TypeVar("S")

SLEW = "slew_psi_per_s"  # the setting of controllers that reckon with how fast a bench lets commands change
FOLDER = Path(__file__).parent / "controllers"
UNUSABLE = Quality.MISSING | Quality.SENTINEL | Quality.IMPLAUSIBLE


class Controller(Protocol[S]):
    """Positions in inches, pressures in psi, times in seconds."""

    def initial(self, sample: Sample, target_in: float) -> S:
        """The state for taking over the valve as `sample` shows it, without a bump: with the valve at rest on its
        target, the first command is the command in force."""

    def step(self, state: S, sample: Sample, target_in: float, dt_s: float) -> tuple[S, float]:
        """The new state and the next command [psi], which goes out `dt_s` after `sample` was taken.

        `dt_s` is the nominal tick. A sample without a usable reading keeps the state and holds the command in force.
        """

    @property
    def settings(self) -> Mapping[str, float | str]:
        """What `make_controller` needs, besides the design, to make this controller again."""


@dataclass(frozen=True, slots=True)
class Seen:
    """The usable numbers of one sample. Without a pressure transmitter `pressure_psi` is the command in force."""

    position_in: float
    pressure_psi: float
    commanded_psi: float


@dataclass(frozen=True)
class Law(ABC, Generic[S]):
    """A controller without its manners: bad samples and command limits are dealt with here, once, for all of them."""

    design: DesignModel
    min_psi: float = 0.0
    max_psi: float = 20.0

    @abstractmethod
    def start(self, seen: Seen, target_in: float) -> S: ...

    @abstractmethod
    def law(self, state: S, seen: Seen, target_in: float, dt_s: float) -> tuple[S, float]: ...

    def initial(self, sample: Sample, target_in: float) -> S:
        seen = _see(sample)
        return self.start(seen or Seen(target_in, sample.commanded_psi, sample.commanded_psi), target_in)

    def step(self, state: S, sample: Sample, target_in: float, dt_s: float) -> tuple[S, float]:
        seen = _see(sample)
        if seen is None or not math.isfinite(target_in):
            return state, self.clamp(sample.commanded_psi)
        state, command_psi = self.law(state, seen, min(max(target_in, 0.0), self.design.travel), dt_s)
        return state, self.clamp(command_psi)

    def clamp(self, command_psi: float) -> float:
        """The command held inside the controller's own range [psi]."""
        return min(max(command_psi, self.min_psi), self.max_psi)

    @property
    def settings(self) -> Mapping[str, float | str]:
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, (int, float, str))}


def _see(sample: Sample) -> Seen | None:
    position_in = _value(sample.position)
    pressure_psi = sample.commanded_psi if sample.pressure is None else _value(sample.pressure)
    if position_in is None or pressure_psi is None:
        return None
    return Seen(position_in, pressure_psi, sample.commanded_psi)


def _value(reading: Reading) -> float | None:
    # A good one first: `&` of flags takes longer than most laws, and trials are made of millions of readings.
    unusable = reading.quality and reading.quality & UNUSABLE
    return None if unusable or not math.isfinite(reading.value) else reading.value


def controller_names() -> tuple[str, ...]:
    """Every controller, by the name of its file."""
    return tuple(sorted(path.stem for path in FOLDER.glob("[a-z]*.py")))


def controller_class(name: str) -> type[Law[Any]]:
    """The class that the file `control/controllers/NAME.py` offers as `CONTROLLER`.

    Raises: `BadInput` with the names that exist.
    """
    if name not in controller_names():
        raise BadInput(f"controller {name!r} does not exist; choose one of {', '.join(controller_names())}")
    found = import_module(f"control.controllers.{name}").CONTROLLER
    assert isinstance(found, type) and issubclass(found, Law)
    return found


def setting_defaults(name: str) -> Mapping[str, float | str]:
    """The settings of a controller and their defaults."""
    return {f.name: f.default for f in fields(controller_class(name)) if isinstance(f.default, (int, float, str))}


def make_controller(name: str, design: DesignModel, **settings: float | str) -> Controller[Any]:
    """A controller for a valve with these design numbers.

    Raises: `BadInput` for an unknown name or setting, a value that is not a finite number, or a design that is not in
    psi and inches.
    """
    kind = controller_class(name)
    if (design.pressure_unit, design.position_unit) != ("psi", "in"):
        raise BadInput(
            f"controllers work in [psi, in], this design has [{design.pressure_unit}, {design.position_unit}]; "
            "convert the design model first"
        )
    known = setting_defaults(name)
    for key, value in settings.items():
        if key not in known:
            raise BadInput(f"controller {name} has no setting {key!r}; it has {', '.join(known)}")
        if isinstance(known[key], str) != isinstance(value, str):
            wanted = "a word" if isinstance(known[key], str) else "a number"
            raise BadInput(f"controller {name}: {key} = {value!r} should be {wanted}")
        if not isinstance(value, str) and not math.isfinite(value):
            raise BadInput(f"controller {name}: {key} = {value} is not a finite number")
    controller = kind(design, **settings)  # type: ignore[arg-type]
    if controller.min_psi >= controller.max_psi:
        raise BadInput(f"controller {name}: min_psi = {controller.min_psi} is not below max_psi = {controller.max_psi}")
    return controller


def parse_settings(words: Iterable[str]) -> dict[str, float | str]:
    """Settings from `key=value` words of a command line; what reads as a number is one.

    Raises: `BadInput` for a word without `=`.
    """
    settings: dict[str, float | str] = {}
    for word in words:
        key, equals, text = word.partition("=")
        if not (key and equals and text):
            raise BadInput(f"setting {word!r} is not of the form key=value")
        try:
            settings[key.strip()] = float(text)
        except ValueError:
            settings[key.strip()] = text.strip()
    return settings
