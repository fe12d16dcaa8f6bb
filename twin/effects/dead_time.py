"""Pressure answers a command only after a pure delay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from logs.recording import Recording
from twin.events.onsets import clocks, onsets
from twin.kernels.ep_slots import EP_CYCLE_S, EP_DAMPING, EP_DEAD_FALLS, EP_DEAD_S, EP_MIXED_S, EP_RINGS_S, EP_SEEN_S
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales

#: Recordings that may each have a clock of their own.
_CLOCKS = 4


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_DEAD_S] = values[0]


def _spreads(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_DEAD_S] = values[0]
    c.ep[EP_MIXED_S] = values[0] * values[1]


def _each_way(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_DEAD_S] = values[0]
    c.ep[EP_DEAD_FALLS] = values[1] - values[0]


def _polled(c: Coefficients, values: Sequence[float]) -> None:
    """Each recording begins at a place in the cycle of its own; of another one nobody knows it, and half is as good."""
    cycle_s, delay_s, *phases = values
    c.ep[[EP_CYCLE_S, EP_DEAD_S]] = cycle_s, delay_s
    known = phases if c.place is not None or len(phases) == 1 else [0.5]
    number, within_s = (c.place.number, c.place.within_s) if c.place is not None else (0, 0.0)
    c.ep[EP_SEEN_S] = known[number % len(known)] * cycle_s - within_s


def _clocked(records: Sequence[Recording], _scales: Scales) -> list[tuple[float, ...]]:
    """Where the answers to clear steps keep step with a clock."""
    found = [onsets(one) for one in records]
    least_s = min((float(one.delays_s.min()) for one in found if one.delays_s.size), default=0.0)
    delays_s = (0.0, max(least_s, 0.0))
    phases = [(cycle_s, (*each, *[0.5] * _CLOCKS)[: _phases(records)]) for cycle_s, each in clocks(found, 3)]
    return [(cycle_s, delay_s, *each) for cycle_s, each in phases for delay_s in delays_s]


def _phases(records: Sequence[Recording]) -> int:
    return 1 if len(records) == 1 else _CLOCKS


def _rings(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_RINGS_S, EP_DAMPING]] = values


_DELAY = Parameter(
    name="delay",
    kind="time",
    lower=0.0,
    upper=10.0,
    starts=(0.05, 0.15, 0.4, 1.0),
    scale=0.4,
    doc="pure delay between command and pressure",
)
_RISING = replace(_DELAY, name="rising", doc="pure delay between a rising command and the pressure")
_FALLING = replace(_DELAY, name="falling", doc="the same of a falling one")
_SPREAD = Parameter(
    name="spread",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.1, 0.4),
    scale=0.3,
    doc="time constant with which what comes out of the delay is mixed, as a share of it",
    size=False,
)
_CYCLE = Parameter(
    name="cycle",
    kind="time",
    lower=0.0,
    upper=20.0,
    starts=(0.3, 1.0),
    scale=0.5,
    doc="in which the converter looks at its command",
)
_THEN = replace(_DELAY, starts=(0.0,), doc="pure delay of what it has seen", size=False)


def _phase(name: str, where: str) -> Parameter:
    doc = f"when it first does so{where}, as a share of the cycle"
    return Parameter(
        name=name, kind="fraction", lower=-1.0, upper=2.0, starts=(0.5,), scale=0.3, doc=doc, neutral=0.5, size=False
    )


_PHASES = tuple(_phase(f"phase_{k + 1}", f" in recording {k + 1}") for k in range(_CLOCKS))
_SWING = Parameter(
    name="swing",
    kind="time",
    lower=0.0,
    upper=5.0,
    starts=(0.1, 0.3, 0.8),
    scale=0.4,
    doc="period of its swing over 2 pi",
)
_DAMPING = Parameter(
    name="damping",
    kind="fraction",
    lower=0.02,
    upper=0.6,
    starts=(0.15, 0.4),
    scale=0.3,
    doc="damping ratio of the swing",
    neutral=0.3,
    size=False,
)

EFFECT = Effect(
    name="dead_time",
    stage="ep",
    claim="Pressure answers a command only after a pure delay.",
    equations="dp/dt = (u(t - d) - p) / tau; dispersed: u(t - d) through a lag of spread d first; each_way: the larger "
    "of u(t - rising) and u(t - falling) where falls take longer, else the smaller; polled: u(t - d) as it was at "
    "the last instant (phase + n) cycle of a clock; only told from it: a pilot v before the lag that swings, "
    "swing^2 v'' + 2 damping swing v' + v = u",
    source="Ljung, System Identification, 2nd ed. (1999), section 4.2; Levenspiel, Chemical Reaction Engineering, "
    "3rd ed. (1999), ch. 12 (plug flow and mixed flow in series)",
    forms=(
        Form("pure_delay", (_DELAY,), _apply),
        Form("dispersed", (_DELAY, _SPREAD), _spreads),
        Form("each_way", (_RISING, _FALLING), _each_way),
        Form("polled", (_CYCLE, _THEN, _phase("phase", "")), _polled, _clocked, once=True, by_pressure=True),
        Form("polled_each", (_CYCLE, _THEN, *_PHASES), _polled, _clocked, apart=_CLOCKS, by_pressure=True),
        Form("rings", (_SWING, _DAMPING), _rings, by_pressure=True, outside="the converter swings to its goal"),
    ),
)
