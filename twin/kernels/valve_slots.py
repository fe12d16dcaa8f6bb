"""Where each coefficient of the valve stands: pressure to stem.

As `slots.py` says.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from logs.recording import FloatArray
from twin.kernels.slots import FOREVER

V_LOW = 0  # lower stop [position]
V_HIGH = 1  # upper stop
V_TAU_CLOSE_S = 2
V_TAU_OPEN_S = 3
V_RATE_CLOSE = 4  # [position/s]
V_RATE_OPEN = 5
V_IN_MOTION = 6  # 1: friction inside the force balance, the stem stops when the pressure reverses
V_BREAKAWAY = 7  # pressure above sliding friction needed to start [pressure]
V_STICK_SPEED = 8  # below this speed the stem sticks again [position/s]
V_DRIFT_RATE = 9  # growth of the half deadband [pressure/s]
V_DRIFT_AMP = 10  # exponential part of that growth [pressure]
V_DRIFT_TAU_S = 11
V_WEAR = 12  # growth of the half deadband with travelled distance [pressure/position]
V_TAU_BEFORE_S = 13  # lag between pressure and play
V_TAU_AFTER_S = 14  # lag between play and stem
V_CREEP1 = 15  # share of the motion that creeps [-]
V_CREEP1_TAU_S = 16
V_CREEP2 = 17
V_CREEP2_TAU_S = 18
V_STEP_TIME_S = 19  # when the half deadband changes by V_STEP [s]
V_STEP = 20
V_OUTER = 21  # half width of a play in pressure before the friction [pressure]
V_OUTER_CENTRE = 22  # pressure in the middle of that play at position 0 [pressure]
V_OUTER_SLOPE = 23  # and how it grows with position [pressure/position]
V_FORCE_CREEP = 24  # share of the force that creeps, before the play [-]
V_FORCE_CREEP_TAU_S = 25
V_HARD_LOW = 26  # stops that hold the stem only, not the play output [position]
V_HARD_HIGH = 27
V_STRIBECK = 28  # friction at rest above friction in motion, falling with speed [pressure]
V_STRIBECK_SPEED = 29  # speed at which 1/e of it is left [position/s]
V_HELD = 30  # distance between target and stem up to which a stem at rest stays [position]
V_TARGET_STICKS = 31  # 1: what sticks is the target, when it slows down; the stem follows its lag; 2: pressed on stops
V_AGING_S = 32  # time at rest after which 1 - 1/e of the breakaway is there; 0: at once [s]
V_TRAVEL = 33  # travel over which forces are given that depend on where the stem is [position]
V_TARGET_CREEPS = 34  # 1: what creeps is the target of the stem, before lag, rate limit and stops; 2: pressed on there
V_SHORT = 35  # how far friction holds the stem from its target at no speed; falls as V_STRIBECK_SPEED says [position]
V_REMEMBERS = 36  # 1: what the slow tails have of what was before holds the stem off its target at the start
V_PRESLIDING = 37  # distance after which all of the friction in the force balance has turned [position]
V_INERTIA_S = 38  # time constant with which the speed of the stem follows what pulls it [s]
V_ROUNDED = 39  # speed at which friction in the force balance has turned, as tanh(v / it) [position/s]; 0: at once
V_DAHL = 40  # distance over which friction before the lag of the stem turns, after Dahl [position]; 0: a play
V_DAHL_HALF = 41  # the half deadband of which that is so [pressure]
V_DRAG_CLOSE_S = 42  # what drag adds to the lag of a stem that closes, as long as no stop limits its pull [s]
V_DRAG_OPEN_S = 43  # and of one that opens
V_RELAX = 44  # pressure for each distance of the stem that a spring at first takes and then lets go [pressure/position]
V_RELAX_TAU_S = 45
V_ON_STEM = 46  # compliance, if what friction grows by holds the stem off its target [position/pressure]; 0: play grows
V_STRETCHES = 47  # 1: what creeps is added to the stem, up to its stops, and is no part of its motion that comes late
V_STRETCHED = 48  # what there is of that at the start [-]
V_SQUARED_S = 49  # drag: what a unit of speed adds to the lag of a stem that closes, and (50) opens [s2/position]
V_KEPT = 51  # how far friction that is the same at any speed keeps the stem from its target [position]
V_GIVE_LOW = 52  # of what the stem is pulled beyond its lower stop, the share that still pulls it there [-]; 1: all
V_GIVE_HIGH = 53
V_FADES_SQUARED = 54  # 1: the extra friction falls with the square of the speed, as a Gaussian curve
V_EASES = 55  # by how much more a stem that closes, and (56) opens, gains speed with what pulls it above a speed [-]
V_EASES_AT = 57  # and that speed [position/s]
V_BREAKS = 58  # by how much more pressure it takes from then on [pressure]
V_BREAKS_S = 59  # and when a spring breaks [s]; FOREVER: it does not
V_STIFFENS = 60  # excess of its rate then, as a share
V_MIDDLE = 61  # pressures from which that holds: of the spring at position 0, and what friction adds to it
V_HALF = 62
V_STEP_EASES = 63  # share of V_STEP that is gone in the end, and with which time constant it goes [s]
V_STEP_EASES_S = 64
V_RINGS = 65  # 1: the plays are those of elastic rings, which stay stretched at a stop
V_RELAX_TARGET = 66  # as V_RELAX, of a spring by which the target of the stem is held
V_STEP_TAKES_S = 67  # with which time constant V_STEP comes about its time, as a logistic curve [s]; 0: at once
V_WITHIN = 68  # 1: drag slows what pulls the stem within the stops; 0: the stops may have pressure to spare for it
V_COUNT = 69


def stem_stops(valve: FloatArray) -> tuple[float, float]:
    """Lowest and highest position of the stem: its own stops and those of the play, whichever are nearer."""
    return float(max(valve[V_LOW], valve[V_HARD_LOW])), float(min(valve[V_HIGH], valve[V_HARD_HIGH]))


def neutral_valve() -> FloatArray:
    """Valve coefficients without any effect; curves, lags, rates and stops are set by the design."""
    return _valve().copy()


@cache
def _valve() -> FloatArray:
    c = np.zeros(V_COUNT)
    c[[V_RATE_CLOSE, V_RATE_OPEN, V_STEP_TIME_S, V_BREAKS_S]] = FOREVER
    c[[V_DRIFT_TAU_S, V_CREEP1_TAU_S, V_CREEP2_TAU_S, V_FORCE_CREEP_TAU_S, V_RELAX_TAU_S, V_STRIBECK_SPEED]] = 1.0
    c[V_HARD_LOW], c[V_HARD_HIGH] = -FOREVER, FOREVER
    c[[V_STEP_EASES_S, V_GIVE_LOW, V_GIVE_HIGH, V_TRAVEL]] = 1.0
    return c
