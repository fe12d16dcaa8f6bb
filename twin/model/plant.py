"""The chain: E/P converter, valve, sensor, with effects inserted by name. Arrays in, arrays out; no state is kept.

The design model is interfaces.md's, exactly; effects change coefficients, curves and spreads (`twin/model/effect.py`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray
from twin.events.refresh import Freshness
from twin.kernels.active import same
from twin.kernels.ep import ep_kernel
from twin.kernels.ep_slots import EP_TAU_FALL_S, EP_TAU_RISE_S
from twin.kernels.play import play_target
from twin.kernels.sensor import curvature, curved, report_on_change, sensor_kernel, static_reading
from twin.kernels.sensor_slots import S_BAND, S_EARLY, S_GAIN, S_PICKS, S_PICKS_FROM, S_SEEN, S_TRAVEL, S_WAITS, S_ZERO
from twin.kernels.sinking import soft_reach, sunk_by
from twin.kernels.slots import GRID
from twin.kernels.valve import valve_kernel
from twin.kernels.valve_slots import (
    V_HIGH,
    V_LOW,
    V_OUTER,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_TRAVEL,
    stem_stops,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Form
from twin.model.place import Place
from twin.model.timegrid import TimeGrid

_TABLE = 1025
#: As shares of the travel: no curve holds far beyond it.
_BEYOND = np.linspace(-0.5, 1.5, 2 * GRID - 1)
_Pressure = TypeVar("_Pressure", float, FloatArray)


@dataclass(frozen=True, slots=True)
class Inserted:
    """An effect at work: one form with its values, in the order of its parameters and in record units."""

    effect: str
    form: Form
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Plant:
    """A design model with effects; prints like a sentence."""

    design: DesignModel
    inserted: Sequence[Inserted] = field(default_factory=tuple)

    def coefficients(self, duration_s: float, place: Place | None = None) -> Coefficients:
        """What the kernels need, with all effects written in; `place`: see `Coefficients`."""
        c = Coefficients(self.design, duration_s, place)
        d = self.design
        c.ep[EP_TAU_RISE_S] = c.ep[EP_TAU_FALL_S] = d.ep_tau_s
        c.valve[V_HIGH] = c.valve[V_TRAVEL] = d.travel
        c.valve[V_TAU_CLOSE_S] = c.valve[V_TAU_OPEN_S] = d.tau_s
        c.valve[V_RATE_CLOSE] = c.valve[V_RATE_OPEN] = d.rate_limit
        c.sensor[S_TRAVEL] = d.travel
        for one in self.inserted:
            one.form.apply(c, one.values)
        return c

    def having(self, inserted: Sequence[Inserted]) -> Plant:
        """This plant with `inserted` besides, each in the place of an effect of the same name that it already has."""
        names = {one.effect for one in inserted}
        return Plant(self.design, (*(one for one in self.inserted if one.effect not in names), *inserted))

    def __str__(self) -> str:
        d = self.design
        words = [
            f"a valve that closes from {d.a1:.4g} and opens at {d.a2:.4g} {d.pressure_unit}, "
            f"{d.compliance:.4g} {d.position_unit}/{d.pressure_unit}, lag {d.tau_s:.3g} s"
        ]
        for one in self.inserted:
            values = ", ".join(f"{p.name} {v:.4g}" for p, v in zip(one.form.parameters, one.values, strict=True))
            words.append(f"{one.effect} ({values})")
        return " with ".join([words[0], " and ".join(words[1:])] if len(words) > 1 else words)


def pressure_response(
    c: Coefficients, grid: TimeGrid, command: FloatArray, p0: float, stem: FloatArray | None = None
) -> FloatArray:
    """Pressure on the fine grid, shape (n_fine,), from pressure `p0` at the first row.

    `stem` on the fine grid, as read, for a converter that it takes air from; None: as if it stood still.
    """
    out = np.empty(grid.n_fine)
    ep_kernel(grid.time_s, command, grid.offsets, c.ep, p0, stem, out)
    return out


def stem_response(c: Coefficients, grid: TimeGrid, pressure: FloatArray, x0: float, w0: float) -> FloatArray:
    """True stem position on the fine grid from the pressure there; `x0` stem and `w0` play output at the first row."""
    first, step, closing, opening = curve_tables(c)
    out = np.empty(grid.n_fine)
    tables, bends = (first, step, closing, opening), c.stem_bends
    valve_kernel(grid.time_s, pressure, grid.offsets, c.valve, tables, (c.spreads, c.weights), bends, (x0, w0), out)
    return out


def reading_response(
    c: Coefficients, grid: TimeGrid, stem: FloatArray, pressure: FloatArray, fresh: Freshness | None = None
) -> FloatArray:
    """Reading at the rows, shape (n,), from the stem and the pressure on the fine grid.

    `fresh`: how fresh each row's recorded reading is, for effects that go by it; without, one that is reported on
    change goes by its band.
    """
    out, taken_s = np.empty(grid.time_s.size), None
    if fresh is not None and c.sensor[S_SEEN] == 2.0:
        latest_s = fresh.before_s if c.sensor[S_WAITS] else fresh.taken_s
        taken_s = np.maximum(latest_s - c.sensor[S_EARLY] * fresh.slack_s, 0.0)
    if c.sensor[S_PICKS] != 0.0:
        stem = stem + picked_up(c, pressure)
    sensor_kernel(grid.time_s, stem, grid.offsets, c.sensor, out, taken_s)
    if fresh is None and c.sensor[S_BAND] > 0.0:
        report_on_change(out, c.sensor[S_BAND])
    return out[fresh.rows] if fresh is not None and c.sensor[S_SEEN] == 1.0 else out


def picked_up(c: Coefficients, pressure: _Pressure) -> _Pressure:
    """What the reading picks up of the pressure [position], before its static curve."""
    return float(c.sensor[S_PICKS]) * (pressure - float(c.sensor[S_PICKS_FROM]))


def curve_tables(c: Coefficients) -> tuple[float, float, FloatArray, FloatArray]:
    """The two curves as tables over a uniform pressure grid: (first pressure, step, closing, opening)."""
    d = c.design
    k1, k2 = d.compliance * c.close_gain, d.compliance * c.open_gain
    if same(c.close_shift) and same(c.open_shift):
        a1, a2 = d.a1 + c.close_shift[0], d.a2 + c.open_shift[0]
        return 0.0, 1.0, k1 * (np.arange(2.0) - a1), k2 * (np.arange(2.0) - a2)
    w = _BEYOND
    close_shift = np.interp(w, c.xi, c.close_shift)
    open_shift = np.interp(w, c.xi, c.open_shift)
    # A curve that folds is a snap: the stem jumps to the next position that needs the same pressure, which closing is
    # at the greatest pressure on the way up and opening at the least one on the way down.
    close_p = np.maximum.accumulate(w * d.travel / k1 + d.a1 + close_shift)
    open_p = np.minimum.accumulate((w * d.travel / k2 + d.a2 + open_shift)[::-1])[::-1]
    grid = np.linspace(min(close_p[0], open_p[0]), max(close_p[-1], open_p[-1]), _TABLE)
    return grid[0], grid[1] - grid[0], np.interp(grid, close_p, w * d.travel), np.interp(grid, open_p, w * d.travel)


def effect_tables(inserted: Sequence[Inserted]) -> Mapping[str, Mapping[str, float | str]]:
    """The effects as `[effects.NAME]` tables of a design model file."""
    return {
        one.effect: {
            "form": one.form.name,
            **{p.name: v for p, v in zip(one.form.parameters, one.values, strict=True)},
        }
        for one in inserted
    }


def reading_at(c: Coefficients, stem: float) -> float:
    """What the static sensor reads of a stem position at the start: the inverse of `stem_at`."""
    return float(static_reading(np.array([stem + sunk_by(c.sensor)]), np.zeros(1), c.sensor)[0])


def core_at(c: Coefficients, reading: float) -> float:
    """Where the core stands when the static sensor reads `reading` at the start."""
    s = c.sensor
    x = (reading - s[S_ZERO]) / s[S_GAIN]
    if curved(s):
        before = np.inf
        for _ in range(100):  # the curve is a few percent: a fixed-point iteration settles, soon unless it is steep
            if abs(x - before) < 1e-7 * s[S_TRAVEL]:
                break
            before = x
            near = min(max(x, -0.5 * s[S_TRAVEL]), 1.5 * s[S_TRAVEL])  # no curve holds far beyond the travel
            x = (reading - s[S_ZERO]) / s[S_GAIN] - float(curvature(np.asarray(near), s))
    return float(x)


def stem_at(c: Coefficients, reading: float) -> float:
    """The stem position, within the stops, at which the static sensor reads `reading` at the start."""
    return stem_of(c, core_at(c, reading))


def pulled_stem(c: Coefficients, core: float, pressure: float) -> float:
    """The stem at rest with the core at `core` at the start: that of a soft linkage lags behind where pressure has it.

    Any other play says nothing of where in it the stem is, nor does the reading show it.
    """
    stem, reach = stem_of(c, core), soft_reach(c.sensor)
    if reach <= 0.0:
        return stem
    play = (c.valve[V_LOW], c.valve[V_HIGH]), curve_tables(c), c.spreads, c.weights, stem
    (pulled,) = play_target(np.array([pressure]), np.array([-c.valve[V_OUTER]]), *play)
    return stem_of(c, min(max(float(pulled), core - reach), core + reach))


def stem_of(c: Coefficients, core: float) -> float:
    """The stem position, within the stops, with the core at `core` at the start."""
    low, high = stem_stops(c.valve)
    return min(max(core - sunk_by(c.sensor), low), high)
