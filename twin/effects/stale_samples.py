"""The DAQ refreshes more slowly than it is polled: readings repeat."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import Recording
from twin.events.refresh import refreshes
from twin.kernels.sensor_slots import S_EARLY, S_HOLD_PHASE_S, S_HOLD_S, S_SEEN, S_WAITS
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales

_PERIOD = Parameter(
    name="period",
    kind="time",
    lower=0.0,
    upper=60.0,
    starts=(0.1, 4.0),  # tried densely in between
    scale=1.0,
    doc="time between two refreshes",
    smooth=False,
)
_PHASE = Parameter(
    name="phase",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.0, 0.25, 0.5, 0.75),
    scale=0.3,
    doc="time of the first refresh after the first row, fraction of the period",
    smooth=False,
    size=False,
)

_EARLY = Parameter(
    name="early",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.5,),
    scale=0.3,
    doc="how early the refreshes are, of what the rows leave open about them",
    size=False,
)


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_HOLD_S] = values[0]
    c.sensor[S_HOLD_PHASE_S] = values[0] * values[1]


def _as_seen(c: Coefficients, _values: Sequence[float]) -> None:
    c.sensor[S_SEEN] = 1.0


def _own_clock(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_SEEN, S_EARLY]] = 2.0, values[0]


def _buffered(c: Coefficients, values: Sequence[float]) -> None:
    _own_clock(c, values)
    c.sensor[S_WAITS] = 1.0


def _seen(records: Sequence[Recording], _scales: Scales) -> list[tuple[float, ...]]:
    """The periods and phases that the reading's lateness suggests; between two rows any phase is as good."""
    time_s, reading = records[0].time_s, records[0].position
    starts: list[tuple[float, ...]] = []
    row_s = float(np.median(np.diff(time_s)))
    for one in refreshes(time_s, reading):
        shifts = [k * row_s / one.period_s / 4.0 for k in (-2, -1, 0, 1, 2)]
        starts += [(one.period_s, (one.phase + shift) % 1.0) for shift in shifts]
    return starts


EFFECT = Effect(
    name="stale_samples",
    stage="sensor",
    claim="The DAQ refreshes the reading more slowly than it is polled.",
    equations="y(t) = x(n period + phase) until the next refresh; as_seen: until the recorded reading changes again; "
    "own_clock: by the clock that the changes show, else up to a row before them; buffered: the one before",
    source="Astrom, Wittenmark, Computer-Controlled Systems, 3rd ed. (Prentice Hall 1997; sample and hold)",
    forms=(
        Form("periodic", (_PERIOD, _PHASE), _apply, _seen),
        Form("as_seen", (), _as_seen, seen=True),
        Form("own_clock", (_EARLY,), _own_clock, seen=True),
        Form("buffered", (_EARLY,), _buffered, seen=True),
    ),
    twins=("sensor_lag",),
)
