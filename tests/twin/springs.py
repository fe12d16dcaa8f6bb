"""A valve whose friction turns over a distance, as springs between stem and packing that are stepped in small steps."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.elastic import stretches
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid

TIME_S = np.arange(0.0, 60.0, 0.05)
#: Up and down through the deadband with an inner loop, and a jump.
PRESSURE = np.interp(
    TIME_S, [0, 14, 20, 23, 27, 34, 34.5, 44, 46, 60], [9.5, 15.5, 13.0, 14.2, 12.3, 14.3, 16.0, 10.0, 11.5, 15.0]
)
#: Where the stem is pulled to at first, with all friction turned as after opening.
START = 0.19 * (9.5 - 5.82)
#: So long a travel that no element of the spread comes near a stop.
LONG = replace(DesignModel(), travel=2.0)


def plant(
    presliding: float,
    in_motion: bool = True,
    falling: tuple[float, float] | None = None,
    form: str = "falling_with_speed",
) -> Plant:
    """The thesis's valve with friction in the force balance that turns over `presliding` [in].

    `falling`: by how much more of it there is at no speed [psi], and the speed at which 1/e of that is left [in/s], by
    the law `form`.
    """
    causes = [
        Inserted(
            "distributed_hysteresis", effect("distributed_hysteresis").form("turns_over_a_distance"), (presliding,)
        )
    ]
    if in_motion:
        causes.append(Inserted("friction_in_motion", effect("friction_in_motion").form("full"), ()))
    if falling is not None:
        causes.append(Inserted("stiction", effect("stiction").form(form), falling))
    return Plant(LONG, causes)


def stem(one: Plant, time_s: FloatArray = TIME_S, pressure: FloatArray = PRESSURE, step_s: float = 0.02) -> FloatArray:
    """The stem at the rows."""
    grid = make_grid(time_s, step_s)
    fine = np.interp(np.interp(np.arange(grid.n_fine), grid.offsets, time_s), time_s, pressure)
    return stem_response(one.coefficients(float(time_s[-1])), grid, fine, START, START)[grid.offsets]


def stem_from(one: Plant, pressure: FloatArray, x: float) -> FloatArray:
    """The stem at the rows, under another pressure and from elsewhere."""
    grid = make_grid(TIME_S, 0.02)
    fine = np.interp(np.interp(np.arange(grid.n_fine), grid.offsets, TIME_S), TIME_S, pressure)
    return stem_response(one.coefficients(60.0), grid, fine, x, x)[grid.offsets]


def stepped(
    reach: float,
    falling: tuple[float, float] = (0.0, 1.0),
    h: float = 1e-3,
    share: float = 1.0,
    power: int = 1,
    gives: float = 0.0,
    d: DesignModel = LONG,
) -> FloatArray:
    """The same valve by explicit steps: springs between stem and packing, damping, the highest speed, the stops.

    The speed at which friction has fallen so far (`falling`) is the one that it has then: found by substitution.
    `share`: of the half deadband, what the springs have; the rest is a play before them. `power` of the speed with
    which friction falls; `gives`: of a pull beyond a stop, what is left of it there.
    """
    slips = stretches(reach)
    held, x, speed, rows = -slips, START, 0.0, [START]
    wide = 0.5 * d.deadband * (1.0 - share)
    behind = PRESSURE[0] + wide
    per = round((TIME_S[1] - TIME_S[0]) / h)
    for a, b in pairwise(PRESSURE):
        for k in range(per):
            turned, p = float((held / slips).sum()) / slips.size, a + (b - a) * (k + 0.5) / per
            behind = min(max(behind, p - wide), p + wide)
            for _ in range(4 if falling[0] else 1):
                more = falling[0] * math.exp(-((abs(speed) / falling[1]) ** power))
                pull = d.compliance * (behind - d.offset - (0.5 * d.deadband * share + more) * turned)
                over = pull - max(0.0, min(d.travel, pull))
                speed = max(-d.rate_limit, min(d.rate_limit, (pull - (1.0 - gives) * over - x) / d.tau_s))
            new = min(max(x + h * speed, 0.0), d.travel)
            held, x = np.minimum(np.maximum(held + new - x, -slips), slips), new
        rows.append(x)
    return np.array(rows)
