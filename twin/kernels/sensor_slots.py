"""Where each coefficient of the sensor stands: stem to reading.

As `slots.py` says.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from logs.recording import FloatArray

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


def neutral_sensor() -> FloatArray:
    """Sensor coefficients of a perfect reading."""
    return _sensor().copy()


@cache
def _sensor() -> FloatArray:
    c = np.zeros(S_COUNT)
    c[[S_GAIN, S_DRIFT_TAU_S, S_TRAVEL]] = 1.0
    c[S_CORE] = np.nan
    return c
