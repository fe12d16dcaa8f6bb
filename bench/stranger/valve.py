"""A stranger's valve: the design numbers and, per stage, what the design leaves out; the defaults are the design.

Every field is a plain float, so that a stage can be handed to compiled code. "Far" limits never bind.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

TRAVEL_IN = 0.5625
FAR = 1e9

#: A disturbance over time [s] -> in the unit of its channel, both of shape (rows,).
Course = Callable[[NDArray[np.float64]], NDArray[np.float64]]

#: Channels of what happens to the valve over time: columns of the weather table.
TARGET_PSI, SPRING_PSI, BAND_PSI, LEAK_SHARE, LOCKED, READING_IN, CHANNELS = 0, 1, 2, 3, 4, 5, 6


class Ep(NamedTuple):
    """The converter: command [psi] -> pressure [psi]."""

    tau_fill_s: float = 0.30
    tau_exhaust_s: float = 0.30
    delay_s: float = 0.0
    gain: float = 1.0
    zero_psi: float = 0.0
    hold_psi: float = 0.0  # a command is taken over only when it differs by more than this
    play_psi: float = 0.0  # full width of a play between command and target
    overlap_psi: float = 0.0  # the pilot stays shut while the pressure error is smaller
    rise_limit_psi_s: float = FAR
    fall_limit_psi_s: float = FAR
    target_ceiling_psi: float = FAR  # the regulated target stops here
    pressure_ceiling_psi: float = FAR  # the pressure itself is cut off here
    soft_ceiling_psi: float = FAR  # the target bends towards this (a drooping regulator)


class Stem(NamedTuple):
    """The actuator: pressure [psi] -> stem position [in]."""

    closing_psi: float = 8.78
    opening_psi: float = 5.82
    k_closing: float = 0.19  # in/psi
    k_opening: float = 0.19  # in/psi
    tau_closing_s: float = 2.7
    tau_opening_s: float = 2.7
    rate_limit_in_s: float = 0.12
    low_stop_in: float = 0.0
    high_stop_in: float = TRAVEL_IN
    stick_psi: float = 0.0  # breakaway of the standing stem (Karnopp)
    jump_psi: float = 0.0  # a standing stem's slip jump (Choudhury)
    stair_psi: float = 0.0  # one-parameter stick and jump (Stenman)
    cubic: float = 0.0
    area: float = 0.0
    bow: float = 0.0
    friction_share: float = 0.0  # part of the deadband that is friction inside the force balance
    creep_share: float = 0.0
    creep_tau_s: float = 40.0
    tail_share: float = 0.0
    tail_tau_s: float = 150.0
    diaphragm_share: float = 0.0
    diaphragm_tau_s: float = 60.0
    spread: float = 0.0  # of the play widths, relative to the deadband
    skewed: float = 0.0  # 1: many narrow plays and a few wide ones
    bump_psi: float = 0.0  # half-width added locally
    bump_at_in: float = 0.28
    bump_width_in: float = 0.06
    wave_psi: float = 0.0  # half-width added periodically over position
    wave_length_in: float = 0.3
    tubing_tau_s: float = 0.0
    plug_tau_s: float = 0.0  # between the play and the lag
    stem_tau_s: float = 0.0  # behind the lag
    flow_square_psi: float = 0.0
    flow_seat_psi: float = 0.0
    flow_arch_psi: float = 0.0
    snap_at_in: float = 0.28
    snap_half_in: float = 0.0


class Sensor(NamedTuple):
    """The linkage and LVDT: stem position [in] -> reading [in]."""

    play_in: float = 0.0
    gain: float = 1.0
    zero_in: float = 0.0
    bow_in: float = 0.0  # quadratic, zero at both ends
    square_in: float = 0.0  # quadratic, anchored at the open end
    ess_in: float = 0.0  # cubic, zero at both ends and in the middle
    lag_s: float = 0.0
    second_lag_s: float = 0.0


class Daq(NamedTuple):
    """What the polled acquisition does to a reading [in], row by row."""

    step_in: float = 0.0
    truncates: bool = False
    refresh_s: float = 0.0
    stale_share: float = 0.0  # of the rows, at random
    stale_pressure: bool = False
    false_share: float = 0.0  # of the rows, at random
    false_in: float = 0.0
    false_kind: str = "spike"  # "spike": reading +- false_in; "value": the reading is false_in


class Valve(NamedTuple):
    """The whole chain, and the weather that it stands in: (channel, course over time) pairs."""

    ep: Ep = Ep()
    stem: Stem = Stem()
    sensor: Sensor = Sensor()
    daq: Daq = Daq()
    weather: tuple[tuple[int, Course], ...] = ()


HEALTHY = Valve()
