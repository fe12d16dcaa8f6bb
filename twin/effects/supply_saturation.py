"""Pressure cannot exceed what the air supply gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, sin

import numpy as np

from logs.recording import FloatArray, Recording
from logs.units import atmosphere
from twin.kernels.ep_slots import (
    EP_AMBIENT,
    EP_ATMOSPHERE,
    EP_CLIP,
    EP_CUT,
    EP_DRAW,
    EP_KNEE,
    EP_REFILL_S,
    EP_STARVED,
    EP_SUBSONIC,
    EP_SUPPLY,
    EP_SWING_COS,
    EP_SWING_SIN,
    EP_SWINGS_S,
    EP_TANK,
    EP_TANK_CUTS,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter, Scales

_SUPPLY = Parameter(
    name="supply",
    kind="pressure",
    lower=3.0,
    upper=60.0,
    # Close together: a ceiling a little too low costs more than none, and one too high changes nothing.
    starts=tuple(6.0 * 1.02**n for n in range(60)),
    scale=8.0,
    doc="highest pressure the supply gives",
    neutral=60.0,
)


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_SUPPLY] = values[0]


def _soft(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_SUPPLY, EP_KNEE]] = values


def _sinks(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_TANK, EP_DRAW, EP_REFILL_S]] = values


def _sinks_below(c: Coefficients, values: Sequence[float]) -> None:
    _sinks(c, values)
    c.ep[EP_TANK_CUTS] = 1.0


def _clip(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_CLIP] = values[0]


def _swings(c: Coefficients, values: Sequence[float]) -> None:
    _swings_at(c, EP_SUPPLY, values)


def _swings_and_cuts(c: Coefficients, values: Sequence[float]) -> None:
    _swings_at(c, EP_CUT, values)


def _swings_at(c: Coefficients, slot: int, values: Sequence[float]) -> None:
    supply, cosine, sine, period_s = values
    turned = 2.0 * pi / period_s * c.since_s
    at_first = cosine * cos(turned) + sine * sin(turned)
    later = sine * cos(turned) - cosine * sin(turned)
    c.ep[[slot, EP_SWINGS_S, EP_SWING_COS, EP_SWING_SIN]] = supply, period_s, at_first, later


def _subsonic(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_ATMOSPHERE, EP_AMBIENT]] = atmosphere(c.design.pressure_unit)
    c.ep[[EP_CLIP, EP_SUBSONIC]] = values


def _starved(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_CLIP, EP_STARVED]] = values


_WIDTH = Parameter(
    name="width",
    kind="fraction",
    lower=1.0,
    upper=6.0,
    starts=(1.1, 1.6),
    scale=0.5,
    doc="choked flow through the port over what the lag takes",
    neutral=1.0,
    size=False,
)
_DRAW = Parameter(
    name="draw",
    kind="fraction",
    lower=0.0,
    upper=3.0,
    starts=(0.1, 0.4),
    scale=0.3,
    doc="by how much the supply sinks for each unit that the pressure rises",
    size=False,
)
_REFILL = Parameter(
    name="refill",
    kind="time",
    lower=0.5,
    upper=900.0,
    starts=(5.0, 40.0),
    scale=30.0,
    doc="time constant with which the supply comes back",
    neutral=30.0,
    size=False,
)
_KNEE = Parameter(
    name="knee",
    kind="pressure",
    lower=0.0,
    upper=4.0,
    starts=(0.15, 0.6),
    scale=0.5,
    doc="what is missing of the pressure at which the command is the supply, divided by ln 2",
    size=False,
)
_SPAN = replace(
    _KNEE,
    name="span",
    upper=8.0,
    starts=(0.4, 1.2),
    doc="last pressures below it, over which the flow falls to none",
)
_COSINE = Parameter(
    name="cosine",
    kind="pressure",
    lower=-3.0,
    upper=3.0,
    starts=(-0.5, 0.5),
    scale=0.5,
    doc="by how much the supply is higher than in the mean when the recordings begin",
    size=False,
)
_SINE = replace(_COSINE, name="sine", doc="by how much it is higher than in the mean a quarter of the period later")
_PERIOD = Parameter(
    name="period",
    kind="time",
    lower=10.0,
    upper=900.0,
    starts=(40.0, 100.0, 250.0),
    scale=60.0,
    doc="of the compressor's switching",
    neutral=100.0,
    size=False,
)

_WAVE = (replace(_SUPPLY, starts=(12.0,)), _COSINE, _SINE, _PERIOD)
#: Periods that are tried, and how many of them, best first, a fit starts from.
_PERIODS, _FEW = np.geomspace(12.0, 900.0, 150), 4
#: Pressure [psi] by which a converter has to lag more than its slope explains, and at how many rows at least.
_HELD_BACK, _ROWS = 0.1, 20


def _swung(records: Sequence[Recording], scales: Scales) -> list[tuple[float, ...]]:
    """The swings that the pressure shows where the supply holds it back; as the parameters say where none does.

    By the recording that shows most of them, which may be a window of a longer one: the swing is told from where it
    begins, from where the first one does, and from where their clock does.
    """
    shown = [_shown(record, scales) for record in records]
    k = max(range(len(shown)), key=lambda one: shown[one][0].size, default=0)
    if not shown or shown[k][0].size < _ROWS:
        return []
    found: dict[tuple[float, ...], None] = {}
    for origin_s in dict.fromkeys((records[k].time_s[0], records[0].time_s[0], 0.0)):
        at_s, highest = shown[k][0] - origin_s, shown[k][1]
        tried = [(*_wave(at_s, highest, period_s), float(period_s)) for period_s in _PERIODS * scales.time]
        able = [one for one in tried if max(abs(v) for v in one[2:4]) < _COSINE.upper * scales.pressure]
        valleys = [b for a, b, c in zip(able, able[1:], able[2:], strict=False) if b[0] <= min(a[0], c[0])]
        found |= dict.fromkeys(one[1:] for one in sorted(valleys)[:_FEW])
    return list(found)


def _shown(record: Recording, scales: Scales) -> tuple[FloatArray, FloatArray]:
    """When a recorded pressure is held back, and what it is then."""
    read = np.zeros(record.n, dtype=bool) if record.pressure is None else np.isfinite(record.pressure)
    if record.pressure is None or read.sum() < _ROWS:
        return np.zeros(0), np.zeros(0)
    time_s, pressure = record.time_s[read], record.pressure[read]
    held = _held_back(record.command[read], pressure, time_s, _HELD_BACK * scales.pressure)
    return time_s[held], pressure[held]


def _held_back(command: FloatArray, pressure: FloatArray, time_s: FloatArray, least: float) -> np.ndarray:
    """Rows in which the pressure is below the command by more than mostly, and twice what its slope explains."""
    slope, lag = np.gradient(pressure, time_s), command - pressure
    falls = (lag < -least) & (slope < 0.0)
    tau_s = float(np.median(lag[falls] / slope[falls])) if falls.any() else 0.0
    lag -= np.median(lag - tau_s * slope)
    held: np.ndarray = (lag > least) & (tau_s * np.abs(slope) < 0.5 * lag)
    return held


def _wave(at_s: FloatArray, values: FloatArray, period_s: float) -> tuple[float, float, float, float]:
    """What a wave of this period about a level leaves of the values (mean square); its level, cosine and sine."""
    angle = 2.0 * pi / period_s * at_s
    shapes = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    level, cosine, sine = np.linalg.lstsq(shapes, values, rcond=None)[0]
    left = float(np.mean(np.square(values - shapes @ [level, cosine, sine])))
    return left, float(level), float(cosine), float(sine)


EFFECT = Effect(
    name="supply_saturation",
    stage="ep",
    claim="Pressure cannot exceed what the air supply gives.",
    equations="dp/dt = (min(u, supply) - p) / tau; cut_off: dp/dt = (u - p) / tau and p <= supply, "
    "and through a booster only what ISO 6358 lets flow from that supply; "
    "subsonic: where it rises, dp/dt = (u - p) / tau min(1, width flow(p, supply)), flow over choked flow (ISO 6358); "
    "starved: where it rises, dp/dt = (u - p) / tau min(1, (supply - p) / span); "
    "sinking: likewise with supply - s, ds/dt = draw max(dp/dt, 0) - s / refill (a tank behind a restriction); "
    "sinking_cut_off: the same supply, with dp/dt = (u - p) / tau and p <= supply - s; "
    "soft: dp/dt = (v - p) / tau, v = -knee ln(exp(-u / knee) + exp(-supply / knee)) (a regulator that runs out of "
    "pressure difference little by little); "
    "swinging: dp/dt = (min(u, supply + cosine cos(2 pi t/period) + sine sin(2 pi t/period)) - p) / tau (a compressor "
    "that switches on and off); swinging_cut_off: cut_off with that supply",
    source="Goodwin, Graebe, Salgado, Control System Design (Prentice Hall 2001), ch. 11 (saturating actuators); "
    "ISO 6358-1 (flow from a supply)",
    forms=(
        Form("ceiling", (_SUPPLY,), _apply),
        Form("cut_off", (_SUPPLY,), _clip),
        Form("subsonic", (_SUPPLY, _WIDTH), _subsonic),
        Form("soft", (_SUPPLY, _KNEE), _soft),
        Form("starved", (_SUPPLY, _SPAN), _starved),
        Form("swinging", _WAVE, _swings, _swung),
        Form("swinging_cut_off", _WAVE, _swings_and_cuts, _swung),
        Form("sinking", (_SUPPLY, _DRAW, _REFILL), _sinks),
        Form("sinking_cut_off", (_SUPPLY, _DRAW, _REFILL), _sinks_below),
    ),
    twins=("ep_calibration",),
)
