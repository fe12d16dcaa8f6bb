"""Where each coefficient of the E/P converter stands: command to pressure.

As `slots.py` says.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from logs.recording import FloatArray
from twin.kernels.slots import FOREVER

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
EP_SUBSONIC = 36  # choked flow from EP_CLIP over what the lag takes [-]; 0: any
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
EP_STARVED = 51  # last pressures below EP_CLIP over which the flow falls evenly to none [pressure]; 0: it does not
EP_COUNT = 52


def neutral_ep() -> FloatArray:
    """E/P coefficients without any effect; lags are set by the design."""
    return _ep().copy()


@cache  # made for each simulation, of which there are thousands
def _ep() -> FloatArray:
    c = np.zeros(EP_COUNT)
    c[[EP_GAIN, EP_REFILL_S, EP_PORT_UP, EP_PORT_DOWN, EP_DRIFTS_S]] = 1.0
    c[[EP_RATE_UP, EP_RATE_DOWN, EP_SUPPLY, EP_CLIP, EP_CUT, EP_TANK, EP_FULL_UP, EP_FULL_DOWN, EP_SLEW]] = FOREVER
    return c
