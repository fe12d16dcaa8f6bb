"""The play of the actuator: pressure [psi] -> where the stem wants to stand [in]; one play, or a spread of them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bench.stranger.kernel import compiled
from bench.stranger.valve import TRAVEL_IN, Stem

PLAYS = 9  # of a spread


@compiled
def curve(stem: Stem, linear_in: float) -> float:
    """The static curve [in] over what a linear spring would give [in]; straight below 0 and above 1.2 travels."""
    if linear_in <= 0.0:
        return linear_in
    inside = min(linear_in, 1.2 * TRAVEL_IN)
    part = inside / TRAVEL_IN
    bent = inside * (1.0 + stem.cubic * part * part + stem.bow * (1.0 - part)) / (1.0 + stem.area * part)
    return bent + linear_in - inside


@compiled
def flow_psi(stem: Stem, stem_in: float) -> float:
    """Force of the fluid as a pressure [psi] that must be overcome to close, over the opening."""
    opening = 1.0 - stem_in / TRAVEL_IN
    return (
        stem.flow_square_psi * opening * opening
        + stem.flow_seat_psi * math.exp(-opening / 0.12)
        + stem.flow_arch_psi * 4.0 * opening * (1.0 - opening)
    )


@compiled
def _local_psi(stem: Stem, at_in: float) -> float:
    """What position adds to half the deadband [psi]."""
    away = (at_in - stem.bump_at_in) / stem.bump_width_in
    added = stem.bump_psi * math.exp(-0.5 * away * away) if stem.bump_psi != 0.0 else 0.0
    if stem.wave_psi != 0.0:
        added += stem.wave_psi * math.sin(2.0 * math.pi * at_in / stem.wave_length_in)
    return added


@compiled
def _width(stem: Stem, number: int) -> float:
    """Width of one play of the spread, relative to the deadband; the mean over the plays is 1."""
    part = (number + 0.5) / PLAYS
    if stem.skewed > 0.5:
        return 1.0 + stem.spread * (-math.log(1.0 - part) - 0.9457)
    return 1.0 + stem.spread * (2.0 * part - 1.0)


@compiled
def play_step(stem: Stem, plays_in: NDArray[np.float64], pressure_psi: float, band_added_psi: float) -> float:
    """Advances the plays [in], shape (PLAYS,), and returns their mean [in].

    A part of the deadband may act as friction behind this stage; the play is narrower by that, and may go on beyond the
    stops by what the friction will hold back.
    """
    middle_psi = 0.5 * (stem.closing_psi + stem.opening_psi)
    whole_psi = 0.5 * (stem.closing_psi - stem.opening_psi + band_added_psi)
    half_psi = whole_psi * (1.0 - stem.friction_share)
    beyond_in = stem.k_closing * whole_psi * stem.friction_share
    count = PLAYS if stem.spread > 0.0 else 1
    total_in = 0.0
    for number in range(count):
        wide_psi = half_psi * (_width(stem, number) if count > 1 else 1.0) + _local_psi(stem, plays_in[number])
        closing_in = curve(stem, stem.k_closing * (pressure_psi - middle_psi - wide_psi))
        opening_in = curve(stem, stem.k_opening * (pressure_psi - middle_psi + wide_psi))
        at_in = max(closing_in, min(opening_in, plays_in[number]))
        plays_in[number] = max(stem.low_stop_in - beyond_in, min(stem.high_stop_in + beyond_in, at_in))
        total_in += plays_in[number]
    return total_in / count
