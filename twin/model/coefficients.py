"""What one simulation is made of: the kernels' coefficients, filled from the design and then changed by effects."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import exp

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.ep_slots import neutral_ep
from twin.kernels.sensor_slots import neutral_sensor
from twin.kernels.slots import GRID
from twin.kernels.valve_slots import V_HARD_HIGH, V_HARD_LOW, V_HIGH, V_LOW, neutral_valve
from twin.model.place import Place

_XI = np.linspace(0.0, 1.0, GRID)
_XI.setflags(write=False)


def _no_bends() -> tuple[FloatArray, FloatArray, FloatArray]:
    return np.zeros(1), np.zeros(1), np.ones(1)


@dataclass(slots=True)
class Coefficients:
    """Everything the kernels need, filled from the design and then changed by effects. Made anew for each simulation.

    `close_shift` and `open_shift` (shape (GRID,), pressure) bend the closing and the opening curve over the position
    grid 0..travel: positive means that more pressure is needed at that position. The position is that of the play
    output, where the stem is pulled to; `stem_bends` (closing shift, opening shift, compliance relative to the
    design's) go by where the stem is by then (shape (1,): nothing does). `spreads`/`weights` describe the play.
    """

    design: DesignModel
    duration_s: float
    place: Place | None = None  # None: none of the recordings that were diagnosed together
    ep: FloatArray = field(default_factory=neutral_ep)
    valve: FloatArray = field(default_factory=neutral_valve)
    sensor: FloatArray = field(default_factory=neutral_sensor)
    close_shift: FloatArray = field(default_factory=lambda: np.zeros(GRID))
    open_shift: FloatArray = field(default_factory=lambda: np.zeros(GRID))
    stem_bends: tuple[FloatArray, FloatArray, FloatArray] = field(default_factory=_no_bends)
    spreads: FloatArray = field(default_factory=lambda: np.zeros(1))
    weights: FloatArray = field(default_factory=lambda: np.ones(1))
    close_gain: float = 1.0  # compliance of the closing curve relative to the design's
    open_gain: float = 1.0

    @property
    def since_s(self) -> float:
        """Time between the beginning of the first recording and that of this one, as far as a clock tells [s]."""
        return self.place.since_s if self.place is not None else 0.0

    @property
    def course_s(self) -> tuple[float, float]:
        """How much of all recordings lies before this one, and how long they last together [s].

        By the clock that they share, or one after the other as they are given; this one alone, where it is alone.
        """
        place = self.place
        if place is None:
            return 0.0, self.duration_s
        before_s = place.since_s if place.span_s else place.before_s
        return before_s, place.span_s or place.all_s or self.duration_s

    @property
    def xi(self) -> FloatArray:
        """Position grid as a fraction of travel, 0 = open."""
        return _XI

    def shift(self, both: FloatArray) -> None:
        """Bends both curves by so much pressure over the position grid, shape (GRID,)."""
        self.close_shift += both
        self.open_shift += both

    def to_come(self, change: float, settling_s: float) -> float:
        """What is left, when this recording begins, of a change that settles exponentially from the first one on."""
        return change * exp(-self.since_s / settling_s)

    def widen(self, half: float) -> None:
        """Adds to the half deadband [pressure] for good."""
        self.close_shift += half
        self.open_shift -= half

    def press_beyond_stops(self, below: float, above: float) -> None:
        """Lets forces balance so far beyond the stops [position], which go on holding the stem."""
        self.valve[V_HARD_LOW] = max(self.valve[V_HARD_LOW], self.valve[V_LOW])
        self.valve[V_HARD_HIGH] = min(self.valve[V_HARD_HIGH], self.valve[V_HIGH])
        self.valve[V_LOW] -= below
        self.valve[V_HIGH] += above

    def bend_at_stem(self, closing: FloatArray, opening: FloatArray, compliance: FloatArray | None = None) -> None:
        """Adds to the pressure needed where the stem is, and multiplies the compliance there; shapes (GRID,)."""
        close, open_, gain = self.stem_bends
        self.stem_bends = (
            close + closing,
            open_ + opening,
            gain * (np.ones(GRID) if compliance is None else compliance),
        )
