"""Where the pressure of a valve at rest should go: off the edges inside the stroke, well beyond one at an end stop."""

from __future__ import annotations

from control.play_filter import Belief

BEYOND_STOP_PSI = 0.3  # more than that beyond the edge, a pressure on a stop is left alone


def parked_psi(soon: Belief, aim_psi: float, retreat_psi: float) -> float:
    """Off the edge where the pressure rests, by `retreat_psi`, at most into the middle of the gap; else as it is."""
    low_psi, high_psi = (soon.edge_psi(soon.inside.w, side) for side in (-1, 1))
    room_psi = min(retreat_psi, 0.5 * (high_psi - low_psi))
    if soon.inside.p > high_psi - 0.5 * room_psi:
        return high_psi - room_psi
    return low_psi + room_psi if soon.inside.p < low_psi + 0.5 * room_psi else aim_psi


def stop_psi(soon: Belief, stop_in: float, aim_psi: float, near_in: float, ahead_in: float) -> float:
    """Beyond the edge by `ahead_in`, because an end stop forgives; left alone once the stem is `near_in` to it."""
    side = 1 if stop_in > 0.0 else -1
    if abs(soon.inside.x - stop_in) < near_in and side * (aim_psi - soon.edge_psi(stop_in, side)) > BEYOND_STOP_PSI:
        return aim_psi
    return soon.edge_psi(stop_in + side * ahead_in, side)
