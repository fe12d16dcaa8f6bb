"""What turns the planned value of a tick into a command: nothing in an open loop, a controller in a closed one."""

from __future__ import annotations

import math
from typing import Any, Protocol

from control.controller import Controller
from hal.sample import Sample


class Drive(Protocol):
    """`command` is asked at the start of a tick, `saw` is told its sample at the end of it."""

    def command(self, planned: float) -> float: ...

    def saw(self, sample: Sample, planned: float) -> None: ...

    def target_in(self, planned: float) -> float:
        """What goes into the record's target column; NaN in an open loop."""


class OpenLoopDrive:
    """The planned value is the command."""

    def command(self, planned: float) -> float:
        return planned

    def saw(self, sample: Sample, planned: float) -> None:
        pass

    def target_in(self, planned: float) -> float:
        return math.nan


class ControllerDrive:
    """The planned value is a position; the command is what the controller made of the sample before.

    `dt_s` is the nominal tick. The first tick sends `in_force`, the command that the valve has anyway, so that the
    controller has a sample to start from.
    """

    def __init__(self, controller: Controller[Any], dt_s: float, in_force: float) -> None:
        self._controller = controller
        self._dt_s = dt_s
        self._next = in_force
        self._state: Any = None
        self._started = False

    def command(self, planned: float) -> float:
        return self._next

    def saw(self, sample: Sample, planned: float) -> None:
        if not self._started:
            self._state = self._controller.initial(sample, planned)
            self._started = True
        self._state, self._next = self._controller.step(self._state, sample, planned, self._dt_s)

    def target_in(self, planned: float) -> float:
        return planned
