"""Every loop that moves a stem, given one history of the pressure: at once, row by row, and in small steps of a law."""

from __future__ import annotations

import math

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray
from twin.model.catalog import effect
from twin.model.coefficients import Coefficients
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid
from twin.replay.valve import Valve

D = DesignModel()
TIME_S = np.arange(0.0, 90.0, 0.1)
#: Steps within the travel, against both stops and away from them again.
PRESSURE = np.interp(
    TIME_S, [0, 5, 5.2, 20, 20.2, 35, 35.2, 50, 50.2, 65, 65.5, 80], [8, 8, 10.5, 10.5, 14, 14, 6, 6, 3.5, 3.5, 9.5, 7]
)
SMALL_S = 0.002

#: One friction for each loop, all with the same law but for where the friction turns.
FRICTIONS: dict[str, tuple[tuple[str, str, tuple[float, ...]], ...]] = {
    "before the lag": (),
    "in the force balance": (("friction_in_motion", "full", ()),),
    "elastic": (("friction_in_motion", "elastic", (1e-5, 0.0, 0.0)),),
    "turning with the speed": (("friction_in_motion", "rounded", (1.0, 1e-5)),),
}


def plant(friction: str, name: str, form: str, values: tuple[float, ...]) -> Plant:
    """The design with one of the frictions and one effect."""
    those = (*FRICTIONS[friction], (name, form, values))
    return Plant(D, tuple(Inserted(name, effect(name).form(form), values) for name, form, values in those))


def at_once(one: Plant, step_s: float = 0.02) -> FloatArray:
    """The stem on the rows."""
    grid = make_grid(TIME_S, step_s)
    fine = np.interp(grid.fine_time_s, TIME_S, PRESSURE)
    return stem_response(one.coefficients(TIME_S[-1]), grid, fine, 0.0, 0.0)[grid.offsets]


def row_by_row(one: Plant) -> FloatArray:
    """The same as the live twin has it."""
    return advanced(one.coefficients(TIME_S[-1]), TIME_S, PRESSURE, 0.0)


def advanced(c: Coefficients, time_s: FloatArray, pressure: FloatArray, start: float) -> FloatArray:
    """The stem of the live twin on the rows, which it is given one by one."""
    grid = make_grid(time_s, 0.02)
    fine, valve, got = np.interp(grid.fine_time_s, time_s, pressure), Valve(c, 0.0, start, start), [start]
    for i in range(1, time_s.size):
        block = slice(int(grid.offsets[i - 1]), int(grid.offsets[i]) + 1)
        ends = np.array([0, block.stop - 1 - block.start], dtype=np.int64)
        got.append(float(valve.advance(time_s[i - 1 : i + 1], ends, fine[block])[-1]))
    return np.array(got)


def uneven_in_small_steps(asymmetry: float) -> FloatArray:
    """A play between curves of k / (1 - asymmetry) closing and k / (1 + asymmetry) opening before a lag of the same."""
    time_s = np.arange(0.0, TIME_S[-1] + SMALL_S, SMALL_S)
    x, w, found = 0.0, 0.0, np.empty(time_s.size)
    soft = (1.0 / (1.0 - asymmetry), 1.0 / (1.0 + asymmetry))
    for k, p in enumerate(np.interp(time_s, TIME_S, PRESSURE)):
        found[k] = x
        bottom, top = soft[0] * D.compliance * (p - D.a1), soft[1] * D.compliance * (p - D.a2)
        w = min(D.travel, max(0.0, bottom, min(top, w)))
        speed = (w - x) / (D.tau_s * (soft[0] if w > x else soft[1]))
        x += SMALL_S * max(-D.rate_limit, min(D.rate_limit, speed))
    return np.interp(TIME_S, time_s, found)


def in_small_steps(
    friction: str,
    drag: tuple[float, float] = (0.0, 0.0),
    relax: tuple[float, float] = (0.0, 1.0),
    asymmetry: float = 0.0,
    throttled: tuple[float, float] = (0.0, 0.0),
    within: bool = False,
) -> FloatArray:
    """dx/dt = (clip(w - tau drag dx/dt) - x) / tau, solved for dx/dt, behind a spring that takes `relax[0]` more at
    first and lets go of it with the time constant `relax[1]`, and that is less stiff closing by a share `asymmetry`.

    `throttled`: drag of the square of the speed, as a share of tau at the highest speed, closing and opening;
    `within`: the stops have no pull to spare for it.
    """
    time_s = np.arange(0.0, TIME_S[-1] + SMALL_S, SMALL_S)
    x, w, late, found = 0.0, 0.0, 0.0, np.empty(time_s.size)
    for k, p in enumerate(np.interp(time_s, TIME_S, PRESSURE)):
        found[k] = x
        taken = relax[0] / D.compliance * (x - late)
        bottom, top = D.compliance * (p - taken - D.a1), D.compliance * (p - taken - D.a2)
        bottom, top = bottom + asymmetry * x, top - asymmetry * x
        w = max(bottom, min(top, w if friction == "before the lag" else x))
        w = min(D.travel, max(0.0, w)) if within else w
        closes = w > x
        stop, share, square = (D.travel, drag[0], throttled[0]) if closes else (0.0, drag[1], throttled[1])
        linear, quadratic = (1.0 + share) * D.tau_s, square * D.tau_s / D.rate_limit
        free = 2.0 * abs(w - x) / (linear + math.sqrt(linear**2 + 4.0 * quadratic * abs(w - x)))
        speed = min(free, abs(stop - x) / D.tau_s)
        x += SMALL_S * min(speed, D.rate_limit) * (1.0 if closes else -1.0)
        late += SMALL_S / relax[1] * (x - late)
        w = min(D.travel, max(0.0, w))
    return np.interp(TIME_S, time_s, found)
