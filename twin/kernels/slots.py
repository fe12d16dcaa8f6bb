"""Where each coefficient stands in the kernels' flat vectors. An effect writes here; a kernel reads here.

Plain integers and no enum: compiled kernels use them as constants. Every slot has a neutral value in the vectors that
the functions below make; a vector of these is the design model of interfaces.md. Only ever append: the numbers are in
cached kernels.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from logs.recording import FloatArray

# --- E/P converter: command to pressure -------------------------------------------------------------------------
EP_DEAD_S = 0  # pure delay [s]
EP_GAIN = 1  # static gain [-]
EP_ZERO = 2  # zero error [pressure]
EP_BAND = 3  # half width of the ignored band [pressure]
EP_BAND_MODE = 4  # 0 none, 1 hold, 2 play, 3 overlap (flow from the edge), 4 (full flow outside), 5 open until EP_SHUT
EP_TAU_RISE_S = 5
EP_TAU_FALL_S = 6
EP_RATE_UP = 7  # [pressure/s]
EP_RATE_DOWN = 8
EP_SUPPLY = 9  # highest pressure [pressure]
EP_CLIP = 10  # pressure that is cut off rather than aimed at [pressure]
EP_TANK = 11  # pressure of a supply that sinks as air is drawn from it [pressure]
EP_DRAW = 12  # by how much it sinks for each unit that the pressure rises [-]
EP_REFILL_S = 13  # time constant with which it comes back [s]
EP_FULL_UP = 14  # slope through a booster that is fully open, stem at EP_MIDDLE [pressure/s]; FOREVER: no booster
EP_FULL_DOWN = 15  # the same falling, at EP_REFERENCE
EP_REFERENCE = 16  # [pressure]
EP_OPEN = 17  # error at which the booster is fully open [pressure]
EP_AIR = 18  # by how much a unit of the stem enlarges the chamber [1/position]
EP_ATMOSPHERE = 19  # the atmosphere's absolute pressure [pressure]
EP_AMBIENT = 20  # what a reading is at the atmosphere's [pressure]
EP_SLEW = 21  # highest slope of what the converter aims at [pressure/s]; FOREVER: it follows the command
EP_RINGS_S = 22  # of a converter that swings to its goal: 1 / its natural frequency [s]; 0: it does not
EP_DAMPING = 23  # and its damping ratio, below 1
EP_NOMINAL = 24  # supply with which EP_FULL_UP is the slope [pressure]
EP_PORT_UP = 25  # by how much the flow that fills is less, of a booster or of the converter itself [-]
EP_PORT_DOWN = 26  # and that which exhausts
EP_KNEE = 27  # how far below and above the supply the knee of a goal that nears it softly reaches [pressure]; 0: sharp
EP_LEAK = 28  # flow per error inside an overlap band, as a share of that outside [-]
EP_QUICK = 29  # further flow of a quick exhaust per error beyond EP_CRACK, as a multiple of that of the port [-]
EP_CRACK = 30  # error from which a falling pressure has it [pressure]
EP_MIXED_S = 31  # lag of what comes out of a dead time [s]
EP_CHAMBER = 32  # what the stem sweeps over EP_AIR, where a narrow port or a shut pilot shows it [-]; 0: nobody asks
EP_DRIFTS = 33  # by how much the zero moves in the end [pressure]
EP_DRIFTS_S = 34  # and with which time constant, from the beginning of each recording [s]
EP_STROKE = 35  # what a stroke of the stem takes from the pressure until air has come after it [pressure/position]
EP_SUBSONIC = 36  # choked flow from EP_CLIP over what the lag takes [-]; 0: any; below 0: see `bounded`
EP_CLOG_UP = 37  # what a clogged passage adds to the lag of a rising pressure, for each unit of its slope [s2/pressure]
EP_CLOG_DOWN = 38  # and of a falling one
EP_SHUT = 39  # error at which a pilot that has opened shuts again, as a share of EP_BAND (EP_BAND_MODE 5) [-]
EP_TANK_CUTS = 40  # 1: the sunk supply cuts the pressure off, as EP_CLIP does; 0: it is what the lag aims at
EP_SWINGS_S = 41  # period with which the supply swings [s]; 0: it does not
EP_SWING_COS = 42  # by how much it is higher at the beginning of a recording [pressure]
EP_SWING_SIN = 43  # and a quarter of the period later
EP_CUT = 44  # supply that swings so and cuts the pressure off, as EP_CLIP does one that does not [pressure]
EP_MIDDLE = 45  # where the stem is as EP_FULL_UP and EP_FULL_DOWN are the slopes [position]
EP_DEAD_FALLS = 46  # by how much longer a falling command is delayed than EP_DEAD_S, or, < 0, shorter [s]
EP_WANES = 47  # by what share the lag of a falling pressure is longer for each unit that it is below [1/pressure]
EP_WANES_BELOW = 48  # this [pressure]
EP_CYCLE_S = 49  # in which the converter looks at its command [s]; 0: all the time
EP_SEEN_S = 50  # when it does so, after the first row [s]
EP_COUNT = 51

# --- valve: pressure to stem ------------------------------------------------------------------------------------
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

# --- sensor: stem to reading ------------------------------------------------------------------------------------
S_GAIN = 0
S_ZERO = 1
S_BOW = 2  # curvature: bow at mid travel [fraction of travel]
S_SWING = 3  # S-shaped part [fraction of travel]
S_DRIFT_RATE = 4  # [position/s]
S_DRIFT_AMP = 5
S_DRIFT_TAU_S = 6
S_PLAY = 7  # lost motion, full width [position]
S_LAG_S = 8
S_HOLD_S = 9  # refresh period of the reading [s]
S_HOLD_PHASE_S = 10
S_STEP = 11  # resolution of the reading [position]
S_TRAVEL = 12  # travel that bow and swing refer to [position]
S_WANDER_S = 13  # time between the knots of a wandering zero [s]; 0: it does not wander
S_KNOTS = 14  # the zero at each of the knots after the start [position]
KNOTS = 10
S_SEEN = S_KNOTS + KNOTS  # 1: the reading is new when the recorded one is; 2: by the converter's clock that shows in it
S_CORE = S_SEEN + 1  # where the core of a loose linkage stands at the start [position]; not a number: at the stem
S_CYCLE_S = S_CORE + 1  # period of a zero that comes and goes [s]; 0: none
S_CYCLE_COS = S_CORE + 2  # 1 - cos, and sin, of it [position]
S_CYCLE_SIN = S_CORE + 3
S_LAG2_S = S_CYCLE_SIN + 1  # a further lag, of the sensor or of the stem it sits on
S_LEAVES = S_LAG2_S + 1  # excess at the end of travel where the core leaves the linear range [fraction of travel]
S_FROM = S_LEAVES + 1  # where that begins [fraction of travel]
S_AT_OPEN = S_LEAVES + 2  # 1: at the open end
S_EARLY = S_AT_OPEN + 1  # how early that clock ticks, of what it leaves open [1]
S_BAND = S_EARLY + 1  # by how much the reading has to change to be reported [position]
S_WAITS = S_BAND + 1  # 1: what is shown is the reading before, which waited in a buffer until this one was taken
S_OTHER = S_WAITS + 1  # excess at the open end of a core that leaves its range at both [fraction of travel]
S_JUMP = S_OTHER + 1  # by how much the zero jumps [position], and when [s]
S_JUMP_S = S_JUMP + 1
S_WINDOW_S = S_JUMP_S + 1  # over how long the reading is averaged [s]; 0: it is not
S_WINDOWS = S_WINDOW_S + 1  # how often, one after the other
S_TABLE = S_WINDOWS + 1  # errors of a table, evenly spaced between the ends of travel [fraction of travel]
TABLE = 11
S_ROOT = S_TABLE + TABLE  # drift of the zero with the root of time [position/s^0.5]
S_ROOT_SINCE_S = S_ROOT + 1  # and how much of that time has been [s]
S_PICKS = S_ROOT_SINCE_S + 1  # what the reading picks up of the pressure [position/pressure]
S_PICKS_FROM = S_PICKS + 1  # and the pressure at which that is nothing [pressure]
S_LEADS_S = S_PICKS_FROM + 1  # what the reading picks up of the speed of the stem [s]
S_LAG3_S = S_LEADS_S + 1  # a third lag of the sensor [s]
S_THRICE_S = S_LAG3_S + 1  # a lag of the stem that the sensor sits on, three times over [s]
S_NATURAL_S = S_THRICE_S + 1  # of a filter of second order: 1 / natural frequency [s]; 0: none
S_DAMPING = S_NATURAL_S + 1  # and its damping ratio, below 1
S_MASS_NATURAL_S = S_DAMPING + 1  # the same of a mass on a spring between the stem and the sensor
S_MASS_DAMPING = S_MASS_NATURAL_S + 1
S_KINK = S_MASS_DAMPING + 1  # excess where two straight halves of the reading meet [fraction of travel]
S_KINK_AT = S_KINK + 1  # and where that is [fraction of travel]
S_WAVE = S_KINK_AT + 1  # one wave of a sine between the ends of travel [fraction of travel]
S_SINKS_S = S_WAVE + 1  # in which a loose core goes to the far end of its play [s], or, < 0, the near; 0: it stays
S_SLIPS = S_SINKS_S + 1  # share of the way of a quick stem that a slipping coupling loses when closing [-]
S_SLIPS_OPEN = S_SLIPS + 1  # and opening
S_SLIPS_ABOVE = S_SLIPS_OPEN + 1  # and the speed from which it slips [position/s]
S_LESS = S_SLIPS_ABOVE + 1  # by how much narrower than S_PLAY a worn linkage is at places from end to end [position]
LESS = 4
S_SOONER = S_LESS + LESS  # share of S_PLAY behind which half the pull of a soft linkage is there; 0: all at once
S_SHARE = S_SOONER + 1  # and what of its pull is there then, beyond that half [-]
S_COUNT = S_SHARE + 1

FOREVER = 1e30

#: Points of the position grid on which effects may bend the two curves.
GRID = 65
PLAYS = 12  # elements of a distributed play


def stem_stops(valve: FloatArray) -> tuple[float, float]:
    """Lowest and highest position of the stem: its own stops and those of the play, whichever are nearer."""
    return float(max(valve[V_LOW], valve[V_HARD_LOW])), float(min(valve[V_HIGH], valve[V_HARD_HIGH]))


def neutral_ep() -> FloatArray:
    """E/P coefficients without any effect; lags are set by the design."""
    return _ep().copy()


@cache  # made for each simulation, of which there are thousands
def _ep() -> FloatArray:
    c = np.zeros(EP_COUNT)
    c[[EP_GAIN, EP_REFILL_S, EP_PORT_UP, EP_PORT_DOWN, EP_DRIFTS_S]] = 1.0
    c[[EP_RATE_UP, EP_RATE_DOWN, EP_SUPPLY, EP_CLIP, EP_CUT, EP_TANK, EP_FULL_UP, EP_FULL_DOWN, EP_SLEW]] = FOREVER
    return c


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


def neutral_sensor() -> FloatArray:
    """Sensor coefficients of a perfect reading."""
    return _sensor().copy()


@cache
def _sensor() -> FloatArray:
    c = np.zeros(S_COUNT)
    c[[S_GAIN, S_DRIFT_TAU_S, S_TRAVEL]] = 1.0
    c[S_CORE] = np.nan
    return c
