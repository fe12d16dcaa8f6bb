"""Compressible flow through an orifice. Source: ISO 6358-1:2013; laminar zone near equal pressures as is customary."""

from __future__ import annotations

import math

from sim_device.physics.jit import compiled

REFERENCE_DENSITY = 1.185  # kg/m3, the standard's reference atmosphere


@compiled
def shape(ratio: float, critical: float, laminar: float) -> float:
    """Flow as a share of choked flow at pressure ratio `ratio` (downstream over upstream, absolute), 0 to 1."""
    if ratio <= critical:
        return 1.0
    if ratio >= 1.0:
        return 0.0
    at = min(ratio, laminar)
    share = math.sqrt(1.0 - ((at - critical) / (1.0 - critical)) ** 2)
    return share if ratio < laminar else share * (1.0 - ratio) / (1.0 - laminar)


@compiled
def flow(conductance: float, critical: float, laminar: float, upstream: float, downstream: float) -> float:
    """Mass flow [kg/s] from `upstream` to `downstream` [Pa absolute], negative when it runs the other way.

    `conductance` is the sonic conductance [m3/(s Pa)], `critical` the critical pressure ratio; the gas is at room
    temperature.
    """
    if upstream >= downstream:
        share = shape(downstream / upstream, critical, laminar)
        return conductance * REFERENCE_DENSITY * upstream * share
    return -conductance * REFERENCE_DENSITY * downstream * shape(upstream / downstream, critical, laminar)
