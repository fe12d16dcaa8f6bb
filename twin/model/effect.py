"""What an effect is: one claim about the valve that the design model leaves out.

An effect is a file in `twin/effects/` that defines `EFFECT`. It has one or several *forms*, because physics often knows
several (a creep with one or with two time constants); a wrong form must not lose to a wrong cause, so the diagnosis
tries them all and the best one speaks for the effect. A form writes coefficients (`twin/kernels/ep_slots.py` and its
kin), bends the curves, or spreads the play; it never integrates anything itself, so no combination of effects is ever
compiled again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from logs.recording import Recording
from logs.spoken import HOUSE, Spoken
from twin.model.coefficients import Coefficients

Stage = Literal["ep", "actuator", "sensor"]
Kind = Literal[
    "pressure",
    "position",
    "time",
    "fraction",
    "position_rate",
    "pressure_rate",
    "pressure_per_position",
    "time_per_pressure",
]
Evidence = Literal["trajectory", "events"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """One number of a form. Bounds, starts and prior are in psi, in and s of the thesis's valve, and scale with others.

    `starts` are the values that the fit tries first; `scale` is the size of a large effect and the spread of the prior;
    the neutral value (no effect) is `neutral`. `smooth` is False where the response jumps with the parameter; its range
    of starts is then looked at in `looks` places. `usual`: median of the size on other machines, and the factor about
    it that two thirds of them keep to; it weighs between effects of the same signature only.
    """

    name: str
    kind: Kind
    lower: float
    upper: float
    starts: tuple[float, ...]
    scale: float
    doc: str
    neutral: float = 0.0
    smooth: bool = True
    size: bool = True  # False for shape parameters (a time constant of a creep) that say nothing about the magnitude
    looks: int = 28
    usual: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Scales:
    """What turns the thesis's psi, in into a record's units: a percent bench has other magnitudes, the same physics.

    `doubt`: relative standard deviation of a design number that nobody accuses. `spoken`: units of what is said.
    """

    pressure: float = 1.0
    position: float = 1.0
    time: float = 1.0
    pressure_unit: str = "psi"
    position_unit: str = "in"
    doubt: float = 0.01
    spoken: Spoken = HOUSE

    def factor(self, kind: Kind) -> float:
        """Multiplier from reference units to record units."""
        return {
            "pressure": self.pressure,
            "position": self.position,
            "time": self.time,
            "fraction": 1.0,
            "position_rate": self.position / self.time,
            "pressure_rate": self.pressure / self.time,
            "pressure_per_position": self.pressure / self.position,
            "time_per_pressure": self.time / self.pressure,
        }[kind]

    def unit(self, kind: Kind) -> str:
        """Unit as printed."""
        return {
            "pressure": self.pressure_unit,
            "position": self.position_unit,
            "time": "s",
            "fraction": "1",
            "position_rate": f"{self.position_unit}/s",
            "pressure_rate": f"{self.pressure_unit}/s",
            "pressure_per_position": f"{self.pressure_unit}/{self.position_unit}",
            "time_per_pressure": f"s/{self.pressure_unit}",
        }[kind]


Apply = Callable[[Coefficients, Sequence[float]], None]
StartsFor = Callable[[Sequence[Recording], Scales], Sequence[tuple[float, ...]]]


@dataclass(frozen=True, slots=True)
class Form:
    """One way in which an effect may act. `apply(coefficients, values)` writes it; values are in record units.

    `starts_for(records, scales)`: values that a fit to these recordings tries first, where the parameters' own are too
    many or too coarse. What happens `once` is no candidate for several recordings, in which it would have had to happen
    alike; what each recording has `apart` is one for two of them up to so many, and what begins `anew` in each where
    they share a clock with breaks. What is `seen` goes by the refresh of the recorded readings, a candidate only where
    that is beyond doubt. What is told by the pressure alone (`by_pressure`) is one only where that was measured. What
    is `described` is for design models of real machines only. What lies `outside` of the vocabulary, in these words, is
    a rival only: where it explains best, nothing known does. What goes through points of its own is `free`, and no law.
    `odds`: how common the form is, beside a usual one; `share`: of the effect's machines, for twins.
    """

    name: str
    parameters: tuple[Parameter, ...]
    apply: Apply
    starts_for: StartsFor | None = None
    once: bool = False
    apart: int = 0
    anew: bool = False
    seen: bool = False
    described: bool = False
    by_pressure: bool = False
    outside: str = ""
    free: bool = False
    odds: float = 1.0
    share: float = 1.0


@dataclass(frozen=True, slots=True)
class Effect:
    """One claim about the valve.

    `evidence` says how the diagnosis recognises it: by the trajectory, or by events in the reading (drop-outs). `odds`
    is how common it is on a bench, relative to others. `absorbs` are design numbers that have no sharp meaning beside
    it (an asymmetry has no canonical middle). `same_as` gives, per form, the effects that no record of these signals
    can tell from it. `twins` are effects with a similar signature; `equations` and `source` are printed. What `drifts`
    makes repeats differ, and so hides in a noise that was measured between them. What is `erratic` moves in jumps whose
    order hangs on the least difference: no model follows it for long. A form of it that is free, or that each recording
    has apart, also takes what it `hides`, which the laws of the other forms leave to be named.
    """

    name: str
    stage: Stage
    claim: str
    equations: str
    source: str
    forms: tuple[Form, ...]
    evidence: Evidence = "trajectory"
    twins: tuple[str, ...] = ()
    odds: float = 1.0
    absorbs: tuple[str, ...] = ()
    same_as: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    drifts: bool = False
    erratic: bool = False
    hides: tuple[str, ...] = ()

    def form(self, name: str) -> Form:
        """The form called `name`; raises KeyError naming the forms there are."""
        for form in self.forms:
            if form.name == name:
                return form
        raise KeyError(f"effect {self.name} has no form {name!r}; it has {', '.join(f.name for f in self.forms)}")
