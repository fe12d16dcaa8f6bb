"""The spring plate as a slider under air, spring and dry friction; its rest positions bound the play."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.jit import compiled
from sim_device.physics.thesis.friction import drift, element, holds, spot, weight
from sim_device.physics.thesis.record import PLAYS
from sim_device.physics.thesis.spring import push, stops, stroke

# With forces that depend on the stroke the balance is implicit; the plate then closes half of its error per step,
# a settling time of some 10 ms, which is also what lets it snap where the balance has several solutions.
_RELAXATION = 0.5


@compiled
def _depends_on_stroke(q: Any) -> bool:
    forces = abs(q.flow_force) + q.snap_region + q.diaphragm_hole + abs(q.position_dependent_friction)
    return bool(forces != 0.0 or (q.nonlinear_spring != 0.0 and q.nonlinear_spring_form == 2))


@compiled
def _widen(q: Any, s: Any, w: float) -> float:
    """Half-width of the friction of this moment and place beyond the design's [psi]."""
    extra = 0.0
    if q.position_dependent_friction != 0.0:
        extra += spot(q, s, w)
    if q.friction_drift != 0.0:
        extra += drift(q, s)
    return extra


@compiled
def _bounds(q: Any, s: Any, p: float, w: float, extra: float) -> tuple[float, float]:
    """Where sliding friction lets the plate rest: from the closing curve to the opening curve [in]."""
    half = 0.5 * (q.a1 - q.a2)
    middle = 0.5 * (q.a1 + q.a2)
    share = 1.0 - q.friction_in_motion
    wide = max((half + extra) * share, 0.0)
    net = p - middle - push(q, s, p, w)
    low_stop, high_stop = stops(q)
    # the part of the friction that acts on the stem lets the plate strain past the stops by that much
    strain = half * q.friction_in_motion * q.compliance
    low_stop, high_stop = low_stop - strain, high_stop + strain
    low = min(max(stroke(q, s, net - wide, True), low_stop), high_stop)
    high = min(max(stroke(q, s, net + wide, False), low_stop), high_stop)
    return low, max(low, high)


@compiled
def _spread(q: Any, s: Any, p: float, extra: float) -> float:
    total = 0.0
    for index in range(PLAYS):
        play = s.plays[index]
        low, high = _bounds(q, s, p, play, extra + element(q, index, PLAYS))
        s.plays[index] = max(low, min(high, play))
        total += weight(q, index, PLAYS) * s.plays[index]
    return total


@compiled
def slide(q: Any, s: Any, p: float, h: float) -> float:
    """Moves the plate for a step of `h` seconds at the end of which the air has `p` psi; returns its place [in]."""
    extra = _widen(q, s, s.slider)
    if q.distributed_hysteresis > 0.0:
        s.slider = _spread(q, s, p, extra)
        return float(s.slider)
    low, high = _bounds(q, s, p, s.slider, extra)
    wish = max(low, min(high, s.slider))
    if q.stiction > 0.0 and holds(q, s, wish, low, high, h):
        return float(s.slider)
    if _depends_on_stroke(q):
        wish = s.slider + _RELAXATION * (wish - s.slider)
    s.slider = wish
    return float(wish)


_CREEP_TAU_S = (2.0, 8.0, 30.0, 120.0)


@compiled
def creep(q: Any, s: Any, w: float, h: float) -> float:
    """The plate's place with part of its motion arriving late [in]; forms: two exponentials, one, logarithmic."""
    form = q.creep_form
    late = 0.0
    for index in range(4):
        s.creep[index] += (w - s.creep[index]) * (1.0 - math.exp(-h / _CREEP_TAU_S[index]))
    if form == 0:
        late = 0.6 * s.creep[1] + 0.4 * s.creep[3]
    elif form == 1:
        late = s.creep[2]
    else:
        late = 0.25 * (s.creep[0] + s.creep[1] + s.creep[2] + s.creep[3])
    return float(w + q.creep * (late - w))
